"""What the hull of the boat does without its motor."""

import math


class Hull:
    """Predicts the way of a boat that coasts: its speed falls by its drag, and the current carries it."""

    def __init__(self, coast_time=2.6, slowest=0.08):
        self.coast_time = coast_time  # s until the speed has fallen to 37 %
        self.slowest = slowest  # m/s, counts as standing

    def coast(self, speed):
        """Return the way in m that the boat coasts from a speed in m/s until it stands."""
        if speed <= self.slowest:
            return 0.0
        return self.coast_time * (speed - self.slowest)

    def coasts_for(self, speed):
        """Return how long the boat coasts in s."""
        if speed <= self.slowest:
            return 0.0
        return self.coast_time * math.log(speed / self.slowest)


def wrap(angle):
    """Return an angle between -pi and pi."""
    return math.atan2(math.sin(angle), math.cos(angle))
