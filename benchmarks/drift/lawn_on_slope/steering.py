"""How a mower steers and cuts: functions of what it sees."""


def limited(value, most):
    """Keep a value within bounds on both sides."""
    return max(-most, min(most, value))


def turn_rate(offset, heading, pull=0.8, most=0.5, firmness=2.0):
    """Return how fast to turn: towards the strip, the more the further beside it."""
    wanted = limited(-pull * offset, most)
    return firmness * (wanted - heading)


def blade_speed(grass, idle=0.6, per_cm=0.03):
    """Return the share of full blade speed."""
    speed = idle + per_cm * grass
    return min(1.0, speed)
