"""Planar arm of two links with a finger that stays level."""

import math

UPPER = 0.34  # m
FOREARM = 0.30  # m
FINGER = 0.09  # distance from the wrist to the tip (m)


def inverse(x, z):
    """Return shoulder, elbow and wrist in rad for a fingertip at (x, z) with the elbow up; None if out of reach."""
    wrist_x = x - FINGER
    reach = math.hypot(wrist_x, z)
    if reach > UPPER + FOREARM or reach < abs(UPPER - FOREARM):
        return None
    bend = math.acos((reach**2 - UPPER**2 - FOREARM**2) / (2 * UPPER * FOREARM))
    elbow = -bend
    lift = math.atan2(z, wrist_x)
    shoulder = lift + math.atan2(FOREARM * math.sin(bend), UPPER + FOREARM * math.cos(bend))
    return [shoulder, elbow, -(shoulder + elbow)]
