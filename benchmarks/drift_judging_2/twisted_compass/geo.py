"""Headings and bearings. All angles are radians, counter-clockwise from east."""

import math

DECLINATION_DEG = 3.5
MOUNTING_DEG = 90.0  # the compass board sits crosswise in its box


def wrap(angle):
    """Return the same angle between -pi and pi."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def heading_from_compass(degrees):
    """Return the rover's heading for a reading of the compass."""
    return wrap(math.radians(degrees + MOUNTING_DEG + DECLINATION_DEG))


def bearing(here, there):
    """Return the direction from one place to another."""
    return math.atan2(there[1] - here[1], there[0] - here[0])


def distance(here, there):
    """Return how far apart two places are."""
    return math.hypot(there[0] - here[0], there[1] - here[1])
