"""Weld schedule of the gun: times, force, and the current, which rises as the caps of the electrodes wear."""

from dataclasses import dataclass


@dataclass
class Schedule:
    squeeze: float = 0.18  # s
    upslope: float = 0.04
    weld: float = 0.2
    hold: float = 0.12
    force: float = 2.6  # kN
    current: float = 9.4  # kA, new caps
    step_per_weld: float = 0.0011  # share of the current
    dress_after: int = 150

    def kiloamps(self, welds):
        return self.current * (1.0 + self.step_per_weld * min(welds, self.dress_after))
