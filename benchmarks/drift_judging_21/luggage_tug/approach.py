"""Speed of the tug on its way to a belt loader."""

import math
from dataclasses import dataclass


@dataclass
class Approach:
    """Brakes evenly and creeps over the last bit."""

    cruise: float = 3.4  # m/s
    decel: float = 0.85  # m/s^2
    creep: float = 0.3  # m/s
    standoff: float = 0.8  # m from the bumper to the reflector of the loader
    tolerance: float = 0.1  # m

    def left(self, gap: float) -> float:
        return gap - self.standoff

    def arrived(self, gap: float) -> bool:
        return self.left(gap) < self.tolerance

    def speed(self, gap: float) -> float:
        """Return the speed from which the tug still comes to a stop in front of the loader, in m/s."""
        left = max(0.0, self.left(gap))
        braking = math.sqrt(2.0 * self.decel * left)
        return min(self.cruise, max(self.creep, braking))
