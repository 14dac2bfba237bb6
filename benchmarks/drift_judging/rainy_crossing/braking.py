"""The braking distance, and the pedal for acceleration."""

DECELERATION = 3.0  # deceleration with full brakes (m/s²)
REACTION = 0.4  # s
RESERVE = 1.2  # m


def brake_distance(speed):
    """Return the distance at which the shuttle has to start braking, m."""
    return RESERVE + REACTION * speed + speed * speed / (2.0 * DECELERATION)


def eased(missing, gain=0.6, most=0.8):
    """Return the pedal position for a missing speed."""
    return max(-most, min(most, gain * missing))
