"""A node that crashes and is restarted, as by a launch file with `respawn`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.faults.topic import LONGEST, moment, up_to
from pytest_tarl.spaces import Span

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True)
class NodeRestart:
    """End a node's process at the moment `at` (s), and restart it after the fault's size (s)."""

    node: str
    at: float
    extent: Span

    def install(self, ros: Any, name: str, size: float, draws: np.random.Generator) -> None:  # noqa: ARG002
        """Schedule the end and the restart of the node."""
        ros.interrupt(self.node, self.at, size)

    def check(self, ros: Any, name: str) -> None:
        """Raise SettingsError if no node of this name was started."""
        started = sorted({process.name for process in ros.processes})
        if self.node not in started:
            raise SettingsError(
                f"faults.restart of {name!r}: no node was started as {self.node!r}; the nodes are "
                f"{', '.join(started) or 'none'}. Correct the name in the marker: it is the script's, without .py, or "
                "the name given to tarl.start."
            )


def restart(node: str, most: float, *, at: float) -> NodeRestart:
    """Return a fault that ends a node at the moment `at` and restarts it after up to `most` seconds.

    The new process starts without the old one's state. Raise SettingsError if the name or the moment is invalid.
    """
    if not isinstance(node, str) or not node:
        raise SettingsError(f"faults.restart: name the node that tarl.start starts, got {node!r}.")
    begins = moment(at)
    if not begins:
        raise SettingsError(
            f"faults.restart: at must be a moment after 0 and up to {LONGEST:g} s, got {at!r}."
        )
    return NodeRestart(node, begins, up_to("restart", most, LONGEST))
