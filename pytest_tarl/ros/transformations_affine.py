"""Affine part of `tf.transformations`: reflection, scaling, shear, projection, decomposition of 4×4 matrices.

A 4×4 matrix is composed as P · T · R · Z · S (perspective, translation, rotation, shear, scale), applied from right to
left.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from pytest_tarl.ros import transformations_rigid as plain

__all__ = [
    "clip_matrix", "compose_matrix", "decompose_matrix", "is_same_transform", "orthogonalization_matrix",
    "projection_matrix", "random_quaternion", "random_rotation_matrix", "random_vector", "reflection_from_matrix",
    "reflection_matrix", "rotation_from_matrix", "scale_from_matrix", "scale_matrix", "shear_matrix",
    "superimposition_matrix",
]  # fmt: skip

Numbers = Sequence[float]


def reflection_matrix(point: Numbers, normal: Numbers) -> Any:
    """Return the 4×4 matrix of a reflection in the plane through a point with this normal."""
    import numpy as np

    direction = plain.unit_vector(list(normal)[:3])
    matrix = np.identity(4)
    matrix[:3, :3] -= 2.0 * np.outer(direction, direction)
    matrix[:3, 3] = 2.0 * np.dot(np.asarray(point, float)[:3], direction) * direction
    return matrix


def reflection_from_matrix(matrix: Any) -> tuple[Any, Any]:
    """Return a point on the mirror plane and its normal. Raise ValueError if the matrix is not a reflection."""
    normal = _eigenvector(matrix, -1.0, 3)
    return _eigenvector(matrix, 1.0, 4), normal


def rotation_from_matrix(matrix: Any) -> tuple[float, Any, Any]:
    """Return angle, axis and a point on the axis. Raise ValueError if the matrix is not a rotation."""
    import numpy as np

    turn = np.asarray(matrix, float)[:3, :3]
    direction = _eigenvector(turn.T, 1.0, 3)
    cosine = (np.trace(turn) - 1.0) / 2.0
    k = int(np.argmax(abs(direction)))  # divide by the largest component for precision
    i, j = (k + 1) % 3, (k + 2) % 3
    sine = (turn[j, i] + (cosine - 1.0) * direction[i] * direction[j]) / direction[k]
    return math.atan2(sine, cosine), direction, _eigenvector(matrix, 1.0, 4)


def scale_matrix(factor: float, origin: Numbers | None = None, direction: Numbers | None = None) -> Any:
    """Return the 4×4 matrix of a scaling about an origin, in all directions or along one."""
    import numpy as np

    matrix = np.diag([factor, factor, factor, 1.0])
    if direction is not None:
        axis = plain.unit_vector(list(direction)[:3])
        matrix[:3, :3] = np.identity(3) - (1.0 - factor) * np.outer(axis, axis)
    if origin is not None:
        centre = np.asarray(origin, float)[:3]
        matrix[:3, 3] = centre - matrix[:3, :3] @ centre
    return matrix


def scale_from_matrix(matrix: Any) -> tuple[float, Any, Any]:
    """Return factor, origin and direction, which is None if the scaling is uniform."""
    import numpy as np

    part = np.asarray(matrix, float)[:3, :3]
    factor = float(np.trace(part) - 2.0)
    values, vectors = np.linalg.eig(part)
    along = np.where(abs(values.real - factor) < 1e-8)[0]
    direction = None
    if len(along) and not np.allclose(part, part[0, 0] * np.identity(3)):
        direction = plain.unit_vector(vectors[:, along[0]].real)
    else:
        factor = float(np.trace(part) / 3.0)
    return factor, _eigenvector(matrix, 1.0, 4), direction


def projection_matrix(
    point: Numbers,
    normal: Numbers,
    direction: Numbers | None = None,
    perspective: Numbers | None = None,
    pseudo: bool = False,
) -> Any:
    """Return the 4×4 matrix of a projection onto a plane: along its normal, along a direction, or from a viewpoint."""
    import numpy as np

    centre, axis = np.asarray(point, float)[:3], plain.unit_vector(list(normal)[:3])
    matrix = np.identity(4)
    if perspective is not None:
        eye = np.asarray(perspective, float)[:3]
        distance = np.dot(eye - centre, axis)
        matrix[:3, :3] = distance * np.identity(3) - np.outer(eye, axis)
        matrix[:3, 3] = np.dot(centre, axis) * eye
        if pseudo:
            matrix[:3, :3] -= np.outer(axis, axis)
            matrix[:3, 3] += np.dot(centre, axis) * axis
        matrix[3, :3], matrix[3, 3] = -axis, np.dot(eye, axis)
        return matrix
    along = axis if direction is None else np.asarray(direction, float)[:3]
    share = np.outer(along, axis) / np.dot(along, axis)
    matrix[:3, :3] -= share
    matrix[:3, 3] = share @ centre
    return matrix


def clip_matrix(
    left: float, right: float, bottom: float, top: float, near: float, far: float, perspective: bool = False
) -> Any:
    """Return the 4×4 matrix that maps a frustum to the cube from -1 to 1. Raise ValueError for an empty one."""
    import numpy as np

    if left >= right or bottom >= top or near >= far:
        raise ValueError("invalid frustrum")
    width, height, depth = right - left, top - bottom, far - near
    if perspective:
        if near <= 1e-15:
            raise ValueError("invalid frustrum: near <= 0")
        return np.array([
            [-2.0 * near / width, 0.0, (right + left) / width, 0.0],
            [0.0, -2.0 * near / height, (top + bottom) / height, 0.0],
            [0.0, 0.0, -(far + near) / depth, 2.0 * near * far / depth],
            [0.0, 0.0, -1.0, 0.0],
        ])  # fmt: skip
    return np.array([
        [2.0 / width, 0.0, 0.0, -(right + left) / width],
        [0.0, 2.0 / height, 0.0, -(top + bottom) / height],
        [0.0, 0.0, 2.0 / depth, -(far + near) / depth],
        [0.0, 0.0, 0.0, 1.0],
    ])  # fmt: skip


def shear_matrix(angle: float, direction: Numbers, point: Numbers, normal: Numbers) -> Any:
    """Return the 4×4 matrix of a shear by an angle (radians), along a direction in a plane through a point.

    Raise ValueError if direction and normal are not orthogonal.
    """
    import numpy as np

    axis, along = plain.unit_vector(list(normal)[:3]), plain.unit_vector(list(direction)[:3])
    if abs(np.dot(axis, along)) > 1e-6:
        raise ValueError("direction and normal vectors are not orthogonal")
    matrix = np.identity(4)
    matrix[:3, :3] += math.tan(angle) * np.outer(along, axis)
    matrix[:3, 3] = -math.tan(angle) * np.dot(np.asarray(point, float)[:3], axis) * along
    return matrix


def decompose_matrix(matrix: Any) -> tuple[Any, list[float], tuple[float, float, float], Any, Any]:
    """Return scale, shear, angles, translation and perspective. Raise ValueError for a singular matrix."""
    import numpy as np

    whole = np.array(matrix, dtype=float).T
    if abs(whole[3, 3]) < 1e-15:
        raise ValueError("M[3, 3] is zero")
    whole /= whole[3, 3]
    affine = whole.copy()
    affine[:, 3] = 0, 0, 0, 1
    if not np.linalg.det(affine):
        raise ValueError("Matrix is singular")
    perspective = np.array((0.0, 0.0, 0.0, 1.0))
    if any(abs(whole[:3, 3]) > 1e-15):
        perspective = np.dot(whole[:, 3], np.linalg.inv(affine.T))
    translation = whole[3, :3].copy()
    rows = [row.copy() for row in whole[:3, :3]]
    scale, shear = (
        np.zeros(3),
        [0.0, 0.0, 0.0],
    )  # Gram-Schmidt: the shear is a row's projection on the others, the scale is the length left
    scale[0] = np.linalg.norm(rows[0])
    rows[0] /= scale[0]
    shear[0] = float(np.dot(rows[0], rows[1]))
    rows[1] -= rows[0] * shear[0]
    scale[1] = np.linalg.norm(rows[1])
    rows[1] /= scale[1]
    shear[0] /= scale[1]
    shear[1] = float(np.dot(rows[0], rows[2]))
    rows[2] -= rows[0] * shear[1]
    shear[2] = float(np.dot(rows[1], rows[2]))
    rows[2] -= rows[1] * shear[2]
    scale[2] = np.linalg.norm(rows[2])
    rows[2] /= scale[2]
    shear[1], shear[2] = shear[1] / scale[2], shear[2] / scale[2]
    turn = np.array(rows)
    if np.dot(rows[0], np.cross(rows[1], rows[2])) < 0:
        scale, turn = -scale, -turn
    return scale, shear, plain.euler_from_matrix(turn.T), translation, perspective


def compose_matrix(
    scale: Numbers | None = None,
    shear: Numbers | None = None,
    angles: Numbers | None = None,
    translate: Numbers | None = None,
    perspective: Numbers | None = None,
) -> Any:
    """Return the 4×4 matrix with these parts (the inverse of `decompose_matrix`)."""
    import numpy as np

    matrix = np.identity(4)
    if perspective is not None:
        matrix[3, :] = list(perspective)[:4]
    if translate is not None:
        matrix = matrix @ plain.translation_matrix(list(translate)[:3])
    if angles is not None:
        matrix = matrix @ plain.euler_matrix(angles[0], angles[1], angles[2], "sxyz")
    if shear is not None:
        slanted = np.identity(4)
        slanted[0, 1], slanted[0, 2], slanted[1, 2] = shear[0], shear[1], shear[2]
        matrix = matrix @ slanted
    if scale is not None:
        matrix = matrix @ np.diag([scale[0], scale[1], scale[2], 1.0])
    return matrix / matrix[3, 3]


def orthogonalization_matrix(lengths: Numbers, angles: Numbers) -> Any:
    """Return the matrix from crystallographic cells (lengths, angles in degrees) to orthogonal coordinates."""
    import numpy as np

    a, b, c = lengths
    cosines, sines = np.cos(np.radians(angles)), np.sin(np.radians(angles))
    share = (cosines[0] * cosines[1] - cosines[2]) / (sines[0] * sines[1])
    return np.array([
        [a * sines[1] * math.sqrt(1.0 - share * share), 0.0, 0.0, 0.0],
        [-a * sines[1] * share, b * sines[0], 0.0, 0.0],
        [a * cosines[1], b * cosines[0], c, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ])  # fmt: skip


def superimposition_matrix(v0: Any, v1: Any, scaling: bool = False, usesvd: bool = True) -> Any:  # noqa: ARG001
    """Return the 4×4 matrix that maps points v0 to v1, each of shape (3, n), by least squares (Kabsch)."""
    import numpy as np

    old, new = np.array(v0, float)[:3], np.array(v1, float)[:3]
    from_centre, to_centre = old.mean(axis=1), new.mean(axis=1)
    old, new = old - from_centre[:, None], new - to_centre[:, None]
    left, _, right = np.linalg.svd(new @ old.T)
    turn = left @ np.diag([1.0, 1.0, float(np.sign(np.linalg.det(left @ right)))]) @ right
    if scaling:
        turn = turn * math.sqrt(float((new * new).sum()) / float((old * old).sum()))
    matrix = np.identity(4)
    matrix[:3, :3], matrix[:3, 3] = turn, to_centre - turn @ from_centre
    return matrix


def random_vector(size: int) -> Any:
    """Return uniform random numbers in [0, 1), shape (size,)."""
    import numpy as np

    return np.random.random(size)


def random_quaternion(rand: Numbers | None = None) -> Any:
    """Return a uniform random rotation, or the one given by three numbers in [0, 1] (Shoemake 1992)."""
    import numpy as np

    one, two, three = random_vector(3) if rand is None else rand
    low, high = math.sqrt(1.0 - one), math.sqrt(one)
    return np.array([
        math.sin(2 * math.pi * two) * low, math.cos(2 * math.pi * two) * low,
        math.sin(2 * math.pi * three) * high, math.cos(2 * math.pi * three) * high,
    ])  # fmt: skip


def random_rotation_matrix(rand: Numbers | None = None) -> Any:
    """Return the 4×4 matrix of a uniform random rotation."""
    return plain.quaternion_matrix(random_quaternion(rand))


def is_same_transform(matrix0: Any, matrix1: Any) -> bool:
    """Return whether two 4×4 matrices describe the same transformation."""
    import numpy as np

    first, second = np.array(matrix0, float), np.array(matrix1, float)
    return bool(np.allclose(first / first[3, 3], second / second[3, 3]))


def _eigenvector(matrix: Any, value: float, size: int) -> Any:
    """Return the unit eigenvector for an eigenvalue; for a 4×4 matrix, its last element is scaled to one.

    Raise ValueError if there is none.
    """
    import numpy as np

    values, vectors = np.linalg.eig(np.asarray(matrix, float)[:size, :size])
    found = np.where(abs(values.real - value) < 1e-8)[0]
    if not len(found):
        raise ValueError(f"no unit eigenvector corresponding to eigenvalue {value:g}")
    vector = vectors[:, found[-1]].real
    return vector / vector[3] if size == 4 else vector
