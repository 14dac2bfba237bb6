"""Energy model of the patrol robot."""

from dataclasses import dataclass


@dataclass(frozen=True)
class EnergyModel:
    """An energy model in percent of a full battery."""

    per_metre: float = 1.6
    per_check: float = 0.5
    reserve: float = 8.0

    def needed(self, metres: float) -> float:
        """Return the charge that a drive takes."""
        return self.per_metre * metres

    def must_return(self, charge: float, home: float) -> bool:
        """Return whether the charge is just enough for the way home."""
        return charge - self.needed(home) < self.reserve


def smoothed(old: float, new: float, weight: float = 0.5) -> float:
    """Return an exponential average."""
    return (1.0 - weight) * old + weight * new
