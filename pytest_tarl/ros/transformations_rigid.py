"""Rigid part of `tf.transformations`: quaternions (x, y, z, w), Euler angles and 4×4 matrices."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from pytest_tarl.ros.missing import unsupported
from pytest_tarl.ros.transforms import multiply, slerp

__all__ = [
    "compose", "concatenate_matrices", "euler_from_matrix", "euler_from_quaternion", "euler_matrix", "identity_matrix",
    "inverse_matrix", "quaternion_about_axis", "quaternion_conjugate", "quaternion_from_euler",
    "quaternion_from_matrix", "quaternion_inverse", "quaternion_matrix", "quaternion_multiply", "quaternion_slerp",
    "rotation_matrix", "translation_from_matrix", "translation_matrix", "unit_vector", "vector_norm",
]  # fmt: skip

Numbers = Sequence[float]
_AXES = "xyz"


def quaternion_from_euler(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Any:
    """Return the quaternion of three rotations, in radians, about fixed (`s…`) or moving (`r…`) axes."""
    turn = (0.0, 0.0, 0.0, 1.0)
    for angle, axis in zip((ai, aj, ak), _letters(axes), strict=True):
        one = [0.0, 0.0, 0.0, math.cos(angle / 2)]
        one[_AXES.index(axis)] = math.sin(angle / 2)
        elementary = (one[0], one[1], one[2], one[3])
        turn = multiply(elementary, turn) if axes[0] == "s" else multiply(turn, elementary)
    return _array(turn)


def euler_from_quaternion(quaternion: Numbers, axes: str = "sxyz") -> tuple[float, float, float]:
    """Return the three angles in radians; roll, pitch and yaw by default."""
    x, y, z, w = (float(part) for part in quaternion)
    if x * x + y * y + z * z + w * w < 1e-15:
        return 0.0, 0.0, 0.0
    return euler_from_matrix(quaternion_matrix(quaternion), axes)


def euler_from_matrix(matrix: Any, axes: str = "sxyz") -> tuple[float, float, float]:
    """Return the three angles of a rotation matrix, in radians.

    Rotations about fixed axes equal rotations about moving axes in reverse order. With moving axes i, j, k, the matrix
    is R_i(a) R_j(b) R_k(c), whose entries give the angles. At gimbal lock (b at its limit), one angle is set to zero.
    """
    letters = _letters(axes) if axes[0] == "r" else _letters(axes)[::-1]
    i, j, k = (_AXES.index(letter) for letter in letters)
    angles = _proper(matrix, i, j) if i == k else _three_axes(matrix, i, j, k)
    return angles if axes[0] == "r" else angles[::-1]


def _three_axes(matrix: Any, i: int, j: int, k: int) -> tuple[float, float, float]:
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    level = math.hypot(matrix[i][i], matrix[i][j])
    second = math.atan2(sign * matrix[i][k], level)
    if level > 1e-12:
        return (
            math.atan2(-sign * matrix[j][k], matrix[k][k]),
            second,
            math.atan2(-sign * matrix[i][j], matrix[i][i]),
        )
    # gimbal lock determines only the sum of the first and last angle: assign it to the first (fixed axes)
    return 0.0, second, math.atan2(sign * matrix[j][i], matrix[j][j])


def _proper(matrix: Any, i: int, j: int) -> tuple[float, float, float]:
    k = 3 - i - j
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    level = math.hypot(matrix[i][j], matrix[i][k])
    second = math.atan2(level, matrix[i][i])
    if level > 1e-12:
        return (
            math.atan2(matrix[j][i], -sign * matrix[k][i]),
            second,
            math.atan2(matrix[i][j], sign * matrix[i][k]),
        )
    return 0.0, second, math.atan2(-sign * matrix[j][k], matrix[j][j])


def euler_matrix(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Any:
    """Return the 4×4 matrix of three rotations, in radians."""
    return quaternion_matrix(quaternion_from_euler(ai, aj, ak, axes))


def quaternion_about_axis(angle: float, axis: Numbers) -> Any:
    """Return the quaternion of a rotation by `angle` radians about an axis."""
    length = math.sqrt(sum(float(part) ** 2 for part in axis))
    factor = math.sin(angle / 2.0) / length if length else 0.0
    return _array([*(float(part) * factor for part in axis), math.cos(angle / 2.0)])


def quaternion_multiply(quaternion1: Numbers, quaternion0: Numbers) -> Any:
    """Return the product quaternion1 × quaternion0: rotate by `quaternion0`, then by `quaternion1`."""
    x1, y1, z1, w1 = (float(part) for part in quaternion1)
    x0, y0, z0, w0 = (float(part) for part in quaternion0)
    return _array(multiply((x1, y1, z1, w1), (x0, y0, z0, w0)))


def quaternion_conjugate(quaternion: Numbers) -> Any:
    """Return the conjugate: the inverse rotation of a unit quaternion."""
    x, y, z, w = (float(part) for part in quaternion)
    return _array([-x, -y, -z, w])


def quaternion_inverse(quaternion: Numbers) -> Any:
    """Return the inverse rotation."""
    return quaternion_conjugate(quaternion) / sum(float(part) ** 2 for part in quaternion)


def quaternion_slerp(
    quat0: Numbers, quat1: Numbers, fraction: float, spin: int = 0, shortestpath: bool = True
) -> Any:
    """Interpolate between two rotations (slerp), at `fraction` from 0 to 1 along the shorter arc.

    Extra turns and the longer arc are not supported and raise an error that says so.
    """
    if spin or not shortestpath:
        raise unsupported("tf.transformations.quaternion_slerp(spin=…, shortestpath=False)")
    start, end = (unit_vector(quaternion) for quaternion in (quat0, quat1))
    return _array(slerp(tuple(start.tolist()), tuple(end.tolist()), fraction))


def quaternion_matrix(quaternion: Numbers) -> Any:
    """Return the 4×4 rotation matrix of a quaternion, which need not have unit length."""
    x, y, z, w = (float(part) for part in quaternion)
    norm = x * x + y * y + z * z + w * w
    s = 2.0 / norm if norm > 1e-15 else 0.0
    return _array([
        [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w), 0],
        [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w), 0],
        [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y), 0],
        [0, 0, 0, 1],
    ])  # fmt: skip


def quaternion_from_matrix(matrix: Any) -> Any:
    """Return the quaternion of a rotation matrix.

    As in tf, w is positive for rotations below 120°; for larger ones, the largest component is.
    """
    m = matrix
    squares = [  # the quaternion's 4x², 4y², 4z² and 4w²
        1 + m[0][0] - m[1][1] - m[2][2],
        1 - m[0][0] + m[1][1] - m[2][2],
        1 - m[0][0] - m[1][1] + m[2][2],
        1 + m[0][0] + m[1][1] + m[2][2],
    ]
    rows = [
        [squares[0], m[0][1] + m[1][0], m[0][2] + m[2][0], m[2][1] - m[1][2]],
        [m[0][1] + m[1][0], squares[1], m[1][2] + m[2][1], m[0][2] - m[2][0]],
        [m[0][2] + m[2][0], m[1][2] + m[2][1], squares[2], m[1][0] - m[0][1]],
        [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], squares[3]],
    ]
    largest = (
        3 if squares[3] > 1 else squares.index(max(squares))
    )  # divide by a large component for precision
    return unit_vector(rows[largest])


def translation_matrix(direction: Numbers) -> Any:
    """Return the 4×4 matrix of a translation."""
    return compose(direction, (0.0, 0.0, 0.0, 1.0))


def translation_from_matrix(matrix: Any) -> Any:
    """Return the translation of a 4×4 matrix."""
    return _array([row[3] for row in matrix[:3]])


def rotation_matrix(angle: float, direction: Numbers, point: Numbers | None = None) -> Any:
    """Return the 4×4 matrix of a rotation, in radians, about an axis through the origin or a point."""
    turned = quaternion_matrix(quaternion_about_axis(angle, direction))
    if point is not None:
        centre = _array([float(part) for part in point[:3]])
        turned[:3, 3] = centre - turned[:3, :3] @ centre
    return turned


def compose(translation: Numbers, rotation: Numbers) -> Any:
    """Return the 4×4 matrix of a rotation followed by a translation."""
    matrix = quaternion_matrix(rotation)
    matrix[:3, 3] = translation
    return matrix


def identity_matrix() -> Any:
    """Return the 4×4 identity matrix."""
    return quaternion_matrix((0.0, 0.0, 0.0, 1.0))


def inverse_matrix(matrix: Any) -> Any:
    """Return the inverse of a square matrix."""
    import numpy as np

    return np.linalg.inv(matrix)


def concatenate_matrices(*matrices: Any) -> Any:
    """Return the product of 4×4 matrices; the last one is applied first."""
    product = identity_matrix()
    for matrix in matrices:
        product = product @ matrix
    return product


def unit_vector(data: Any) -> Any:
    """Return a vector of length one in the same direction."""
    vector = _array([float(part) for part in data])
    return vector / vector_norm(vector)


def vector_norm(data: Any) -> float:
    """Return a vector's length."""
    return math.sqrt(sum(float(part) ** 2 for part in data))


def _letters(axes: str) -> str:
    if len(axes) != 4 or axes[0] not in "sr" or any(letter not in _AXES for letter in axes[1:]):
        raise KeyError(axes)
    return axes[1:]


def _array(parts: Any) -> Any:
    import numpy as np  # nodes expect arrays, because they index, unpack and add the results

    return np.array(parts, dtype=float)
