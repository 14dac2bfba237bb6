"""`tf.transformations`: quaternions (x, y, z, w), Euler angles and 4×4 matrices."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros import transformations_rigid
from pytest_tarl.ros.transformations_rigid import *  # noqa: F403

_SELDOM = (
    "clip_matrix", "compose_matrix", "decompose_matrix", "is_same_transform", "orthogonalization_matrix",
    "projection_matrix", "random_quaternion", "random_rotation_matrix", "random_vector", "reflection_from_matrix",
    "reflection_matrix", "rotation_from_matrix", "scale_from_matrix", "scale_matrix", "shear_matrix",
    "superimposition_matrix",
)  # fmt: skip
__all__ = [*transformations_rigid.__all__, *_SELDOM]


def __getattr__(name: str) -> Any:
    """Import a rarely used function; raise for a name that the stand-in lacks."""
    if name in _SELDOM:
        from pytest_tarl.ros import transformations_affine

        return getattr(transformations_affine, name)
    raise AttributeError(name)
