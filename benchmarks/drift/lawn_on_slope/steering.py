"""Functions that compute steering and blade speed of a mower from its sensors."""


def limited(value, most):
    """Limit a value to a range symmetric about 0."""
    return max(-most, min(most, value))


def turn_rate(offset, heading, pull=0.8, most=0.5, firmness=2.0):
    """Return the turn rate towards the strip, proportional to the distance from it."""
    wanted = limited(-pull * offset, most)
    return firmness * (wanted - heading)


def blade_speed(grass, idle=0.6, per_cm=0.03):
    """Return the share of full blade speed."""
    speed = idle + per_cm * grass
    return min(1.0, speed)
