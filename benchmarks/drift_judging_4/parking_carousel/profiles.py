"""Speed profiles for the carousel's motor drive. Drive values are shares of the full voltage, errors are bays."""

from math import copysign


class Approach:
    """Full drive far away and proportional drive near the goal, but always enough to keep the motor turning."""

    def __init__(self, gain=0.45, top=0.9, least=0.12, rise=0.08):
        self.gain = gain
        self.top = top
        self.least = least
        self.rise = rise
        self.last = 0.0

    def reset(self):
        """Begin from standstill."""
        self.last = 0.0

    def drive(self, error, tolerance):
        """Return the drive that brings the error towards zero."""
        if abs(error) < tolerance:
            self.last = 0.0
            return 0.0
        size = min(self.top, max(self.least, self.gain * abs(error)))
        size = min(size, abs(self.last) + self.rise)
        self.last = copysign(size, error)
        return self.last
