"""Arithmetic of the winch drum behind the fly bar."""

CIRCUMFERENCE = 0.80  # rope per turn (m)


def depth(turns):
    """Return the metres of rope that have left the drum."""
    return turns * CIRCUMFERENCE


def approach(left, fastest, braking):
    """Return the speed in m/s from which the bar stops within `left` metres."""
    sign = 1.0 if left > 0 else -1.0
    return sign * min(fastest, (2.0 * braking * abs(left)) ** 0.5)
