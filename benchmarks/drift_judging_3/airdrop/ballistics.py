"""The fall of a parcel under its parachute."""

import numpy as np

CHUTE = dict(sink=6.0, opening=1.2, throw=0.9)  # sink rate (m/s), time to open (s), flight at drone speed (s)
FREE_FALL = 4.0  # mean speed until the chute is open (m/s)


def fall_time(height):
    """Return the seconds from the release to the landing."""
    return CHUTE["opening"] + (height - FREE_FALL * CHUTE["opening"]) / CHUTE["sink"]


def drift(height, wind):
    """Return how far the wind carries a parcel (m, east and north)."""
    return np.asarray(wind) * fall_time(height)


def throw(velocity):
    """Return the distance that a parcel travels before drag has stopped it, m."""
    return CHUTE["throw"] * float(np.linalg.norm(velocity))
