"""Brake of the trolley: distances in m, speeds in m/s, slopes in rad."""

import math

GRAVITY = 9.81
PAD_DECELERATION = 2.4  # on the level, new pads on the steel rope
REACTION = 0.15  # s, relay and pads


def deceleration(slope):
    """What is left of the pads' deceleration on a rope that falls."""
    return max(0.2, PAD_DECELERATION - GRAVITY * math.sin(slope))


def stopping_distance(speed, slope):
    """Way from the brake command to standstill."""
    return REACTION * speed + speed * speed / (2.0 * deceleration(slope))
