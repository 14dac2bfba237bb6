"""Install the faults of an episode, and check that they had something to act on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from pytest_tarl import seeds
from pytest_tarl.spaces import Fault


@dataclass(frozen=True)
class Faults:
    """All declared faults by direction, with their sizes in one episode and the episode's `seed`."""

    declared: Mapping[str, Fault] = field(default_factory=dict)
    active: Mapping[str, tuple[Fault, float]] = field(default_factory=dict)
    seed: int = 0

    def install(self, ros: Any) -> None:
        """Install the faults in an episode's ROS, in the order of the directions."""
        for name, (fault, size) in self.active.items():
            fault.install(ros, name, size, seeds.generator(self.seed, f"fault {name}"))

    def check(self, ros: Any) -> None:
        """Raise SettingsError for a fault whose topic or node did not occur, unless another fault was active."""
        if not self.active:
            for name, fault in self.declared.items():
                fault.check(ros, name)


NO_FAULTS = Faults()
