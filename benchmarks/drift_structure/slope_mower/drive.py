"""How the mower drives."""

STEADY = 0.5  # throttle per m/s


def throttle(speed):
    """Return the throttle for a speed: m/s."""
    return STEADY * speed


def bounded(value, most=1.0):
    """Return a value within the throttle's range."""
    return max(0.0, min(most, value))
