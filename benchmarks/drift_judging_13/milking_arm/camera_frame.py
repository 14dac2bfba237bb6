"""Frame of the 3D camera on the post of the milking box, and the frame of the arm."""

import math

CAMERA_X = 0.06  # distance from the base of the arm towards the cow (m)
CAMERA_Z = 0.24  # height above the base of the arm (m)
MOUNT_PITCH = 0.35  # rad, upwards


def rotate(along, up, pitch):
    """Turn a vector in the vertical plane."""
    c, s = math.cos(pitch), math.sin(pitch)
    return along * c - up * s, along * s + up * c


def to_arm(point):
    """Point of the camera (x to the right, y down, z along its axis) in the frame of the arm."""
    x, z = rotate(point.z, -point.y, MOUNT_PITCH)
    return CAMERA_X + x, -point.x, CAMERA_Z + z


def distance(a, b):
    return math.sqrt(sum((p - q) ** 2 for p, q in zip(a, b)))
