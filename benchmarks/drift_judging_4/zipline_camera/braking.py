"""Brake of the trolley: distances in m, speeds in m/s, slopes in rad."""

import math

GRAVITY = 9.81
PAD_DECELERATION = 2.4  # with new pads on the level steel rope (m/s²)
REACTION = 0.15  # reaction time of relay and pads (s)


def deceleration(slope):
    """Return the deceleration by the pads that remains on a falling rope."""
    return max(0.2, PAD_DECELERATION - GRAVITY * math.sin(slope))


def stopping_distance(speed, slope):
    """Return the distance from the brake command to standstill."""
    return REACTION * speed + speed * speed / (2.0 * deceleration(slope))
