"""How fast the basket of a honey extractor turns over time."""

from dataclasses import dataclass


@dataclass
class SpinProfile:
    """First gently, since full combs are heavy; then up to the full speed."""

    gentle: float = 110.0  # rpm
    gentle_for: float = 6.0  # s
    ramp: float = 25.0  # rpm per s
    full: float = 280.0  # rpm

    def target(self, elapsed: float) -> float:
        """Return the speed in rpm for the time since the start in s."""
        if elapsed < self.gentle_for:
            return self.gentle
        return min(self.full, self.gentle + self.ramp * (elapsed - self.gentle_for))
