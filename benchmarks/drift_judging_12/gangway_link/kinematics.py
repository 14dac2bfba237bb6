"""Geometry of the gangway: heights of its tip to angles of the luffing cylinder and back."""

import math

LENGTH = 18.0  # m
PIVOT = 6.0  # height above the water (m)
LUFF_MIN, LUFF_MAX = -0.30, 0.30  # rad


def luff(height):
    """Return the angle at which the tip is at a height above the pivot."""
    angle = math.asin(max(-0.9, min(0.9, height / LENGTH)))
    return max(LUFF_MIN, min(LUFF_MAX, angle))


def tip(angle):
    """Return the height of the tip above the pivot."""
    return LENGTH * math.sin(angle)
