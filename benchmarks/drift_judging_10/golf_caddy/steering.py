"""Geometry of pure pursuit."""

import math


def heading_of(q):
    """Return the heading of a quaternion."""
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


def point_ahead(path, index, pose, distance):
    """Return the first point of the path that is a distance away, and its index; search from an index."""
    x, y, _ = pose
    while index < len(path) - 1 and math.hypot(path[index][0] - x, path[index][1] - y) < distance:
        index += 1
    return index, path[index]


def curvature_to(aim, pose):
    """Return the curvature of the arc to a point, positive to the left."""
    x, y, heading = pose
    dx, dy = aim[0] - x, aim[1] - y
    left = -math.sin(heading) * dx + math.cos(heading) * dy
    return 2.0 * left / max(0.01, dx * dx + dy * dy)
