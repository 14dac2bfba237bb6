"""Quaternions (x, y, z, w) and Euler angles as `tf.transformations` and `tf_transformations` offer them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

__all__ = [
    "euler_from_quaternion", "quaternion_about_axis", "quaternion_conjugate", "quaternion_from_euler",
    "quaternion_inverse", "quaternion_multiply",
]  # fmt: skip

Quaternion = Sequence[float]


def euler_from_quaternion(quaternion: Quaternion, axes: str = "sxyz") -> tuple[float, float, float]:
    """Return roll, pitch and yaw in radians: rotations about the fixed axes x, y, z in this order."""
    _require_default(axes, "euler_from_quaternion")
    x, y, z, w = (float(part) for part in quaternion)
    norm = x * x + y * y + z * z + w * w
    if norm < 1e-15:
        return 0.0, 0.0, 0.0
    scale = 2.0 / norm
    sine = max(-1.0, min(1.0, scale * (w * y - x * z)))
    cosine_roll, sine_roll = 1.0 - scale * (x * x + y * y), scale * (y * z + w * x)
    cosine_yaw, sine_yaw = 1.0 - scale * (y * y + z * z), scale * (x * y + w * z)
    pitch = math.asin(sine)
    if math.hypot(cosine_yaw, sine_yaw) < 1e-12:  # looking straight up or down: yaw is a matter of choice
        return math.atan2(-scale * (y * z - w * x), 1.0 - scale * (x * x + z * z)), pitch, 0.0
    return math.atan2(sine_roll, cosine_roll), pitch, math.atan2(sine_yaw, cosine_yaw)


def quaternion_from_euler(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Any:
    """Return the quaternion of roll, pitch and yaw in radians, as a numpy array."""
    _require_default(axes, "quaternion_from_euler")
    (ci, si), (cj, sj), (ck, sk) = ((math.cos(a / 2), math.sin(a / 2)) for a in (ai, aj, ak))
    return _vector(
        si * cj * ck - ci * sj * sk,
        ci * sj * ck + si * cj * sk,
        ci * cj * sk - si * sj * ck,
        ci * cj * ck + si * sj * sk,
    )


def quaternion_about_axis(angle: float, axis: Sequence[float]) -> Any:
    """Return the quaternion of a turn by `angle` radians about an axis."""
    length = math.sqrt(sum(float(part) ** 2 for part in axis))
    factor = math.sin(angle / 2.0) / length if length else 0.0
    return _vector(*(float(part) * factor for part in axis), math.cos(angle / 2.0))


def quaternion_multiply(quaternion1: Quaternion, quaternion0: Quaternion) -> Any:
    """Return the turn `quaternion0` followed by `quaternion1`."""
    x0, y0, z0, w0 = (float(part) for part in quaternion0)
    x1, y1, z1, w1 = (float(part) for part in quaternion1)
    return _vector(
        w1 * x0 + x1 * w0 + y1 * z0 - z1 * y0,
        w1 * y0 - x1 * z0 + y1 * w0 + z1 * x0,
        w1 * z0 + x1 * y0 - y1 * x0 + z1 * w0,
        w1 * w0 - x1 * x0 - y1 * y0 - z1 * z0,
    )


def quaternion_conjugate(quaternion: Quaternion) -> Any:
    """Return the opposite turn of a unit quaternion."""
    x, y, z, w = (float(part) for part in quaternion)
    return _vector(-x, -y, -z, w)


def quaternion_inverse(quaternion: Quaternion) -> Any:
    """Return the opposite turn."""
    return quaternion_conjugate(quaternion) / sum(float(part) ** 2 for part in quaternion)


def _vector(*parts: float) -> Any:
    import numpy as np  # nodes index, unpack and add what they get

    return np.array(parts)


def _require_default(axes: str, function: str) -> None:
    if axes != "sxyz":
        from pytest_tarl.ros.missing import unsupported

        raise unsupported(f"{function}(axes={axes!r})")


def __getattr__(name: str) -> Any:
    """Name what is missing."""
    from pytest_tarl.ros.missing import refuse

    raise refuse("tf.transformations", name)
