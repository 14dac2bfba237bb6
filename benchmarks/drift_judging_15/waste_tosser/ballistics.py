"""Flight of a thrown item, without drag."""

import math

G = 9.81


def launch_speed(distance, drop, angle):
    """Speed in m/s to land `distance` m away and `drop` m lower."""
    c = math.cos(angle)
    below = distance * math.tan(angle) + drop
    return math.sqrt(G * distance * distance / (2.0 * c * c * below))
