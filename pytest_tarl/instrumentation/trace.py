"""The recorded columns of an episode."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.sensors import Cell

Ints = NDArray[np.int32]
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Trace:
    """Events and simulation steps of one episode.

    `cells` has the distinct cells in order of first use; `event_cell` and `step_cell` are indices into it, or -1 before
    the first message. Columns of events have shape (events,), columns of steps (steps,). Events are sorted by step and
    then by thread, so the order of events in different threads is lost. Events after the last reward belong to the last
    step. `thread` is None if one thread recorded everything.
    """

    cells: tuple[Cell, ...]
    site: Ints
    flow: Floats  # finite; never negative unless the episode was planned with `signed`
    event_cell: Ints
    event_step: Ints
    step_cell: Ints  # each step's cell at the time of its reward
    reward: Floats
    parts: Mapping[str, Floats]
    thread: Ints | None = None

    @property
    def steps(self) -> int:
        """Return the number of steps with a reward."""
        return len(self.reward)
