"""Throttle and hitch: pull and depth of the implement."""

FORWARD = 0.4  # throttle per m/s of wanted speed
CATCH_UP = 0.2  # throttle per m/s of missing speed
DEPTH = 0.2  # m
LIFT_GAIN = 2.0


def throttle(pace, speed, steering):
    """Return the throttle, 0 to 1, which is smaller in bends."""
    wanted = pace
    if abs(steering) > 0.4:
        wanted = 0.8 * pace
    missing = max(0.0, wanted - speed)
    power = FORWARD * wanted + CATCH_UP * missing
    return min(1.0, power)


def hitch_height(depth, speed, base=0.5):
    """Return the setting of the hitch, 0 to 1."""
    error = DEPTH - depth
    height = base + LIFT_GAIN * error
    if speed < 0.1:
        height = base
    return max(0.0, min(1.0, height))
