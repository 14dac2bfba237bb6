"""Arithmetic of the winch drum behind the fly bar."""

CIRCUMFERENCE = 0.80  # m of rope per turn


def depth(turns):
    """Metres of rope that are off the drum."""
    return turns * CIRCUMFERENCE


def approach(left, fastest, braking):
    """Speed in m/s that still stops within `left` metres."""
    sign = 1.0 if left > 0 else -1.0
    return sign * min(fastest, (2.0 * braking * abs(left)) ** 0.5)
