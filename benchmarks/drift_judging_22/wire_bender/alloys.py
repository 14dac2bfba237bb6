"""How far wire must be bent so that it keeps an angle after it springs back."""

ALLOYS = {  # factor, and degrees that the wire gives elastically
    "annealed": (1.01, 0.8),
    "galvanised": (1.05, 1.5),
    "inox": (1.09, 2.2),
}
LIMIT = 175.0  # degrees that the bending pin reaches


def overbend(angle, alloy):
    """Return the angle of the pin for an angle of the wire, both in degrees."""
    factor, give = ALLOYS[alloy]
    return min(LIMIT, angle * factor + give)
