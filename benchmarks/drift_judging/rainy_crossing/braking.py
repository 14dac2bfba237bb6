"""When to brake, and how to pull away."""

DECELERATION = 3.0  # on full brake: m/s²
REACTION = 0.4  # s
RESERVE = 1.2  # m


def brake_distance(speed):
    """Return from which distance on the shuttle has to brake: m."""
    return RESERVE + REACTION * speed + speed * speed / (2.0 * DECELERATION)


def eased(missing, gain=0.6, most=0.8):
    """Return the pedal for a speed that is missing."""
    return max(-most, min(most, gain * missing))
