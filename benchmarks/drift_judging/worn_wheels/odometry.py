"""Dead reckoning from the ticks of two wheels."""

WHEELS = {"ticks_per_metre": 1200.0, "track": 0.42}


def travelled(left, right):
    """Return the distance travelled by the middle of the axle, m."""
    return 0.5 * (left + right) / WHEELS["ticks_per_metre"]


def turned(left, right):
    """Return the angle by which the robot has turned, left positive, rad."""
    return (right - left) / WHEELS["ticks_per_metre"] / WHEELS["track"]
