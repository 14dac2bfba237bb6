"""Stand-in for `tf2_kdl`: transform PyKDL's values by a TransformStamped, without `Stamped` values."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.kdl.frames import Frame
from pytest_tarl.ros.kdl.rotations import Rotation
from pytest_tarl.ros.kdl.vectors import Twist, Vector, Wrench

__all__ = ["do_transform_frame", "do_transform_twist", "do_transform_vector", "do_transform_wrench",
           "transform_to_kdl"]  # fmt: skip


def transform_to_kdl(t: Any) -> Frame:
    """Return the frame of a TransformStamped."""
    move, turn = t.transform.translation, t.transform.rotation
    return Frame(Rotation.Quaternion(turn.x, turn.y, turn.z, turn.w), Vector(move.x, move.y, move.z))


def do_transform_vector(vector: Vector, transform: Any) -> Vector:
    """Return a point in the transform's frame."""
    moved: Vector = transform_to_kdl(transform) * vector
    return moved


def do_transform_frame(frame: Frame, transform: Any) -> Frame:
    """Return a frame in the transform's frame."""
    moved: Frame = transform_to_kdl(transform) * frame
    return moved


def do_transform_twist(twist: Twist, transform: Any) -> Twist:
    """Return a twist in the transform's frame."""
    moved: Twist = transform_to_kdl(transform) * twist
    return moved


def do_transform_wrench(wrench: Wrench, transform: Any) -> Wrench:
    """Return a wrench in the transform's frame."""
    moved: Wrench = transform_to_kdl(transform) * wrench
    return moved
