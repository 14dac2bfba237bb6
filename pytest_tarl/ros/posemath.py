"""`tf_conversions` and its `posemath`: convert frames of PyKDL to and from messages, tf and matrices."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pytest_tarl.ros.kdl.frames import Frame
from pytest_tarl.ros.kdl.rotations import Rotation
from pytest_tarl.ros.kdl.vectors import Vector

__all__ = ["fromMatrix", "fromMsg", "fromTf", "toMatrix", "toMsg", "toTf"]


def fromTf(tf: Sequence[Sequence[float]]) -> Frame:  # noqa: N802 (these names are posemath's)
    """Return the frame for a position and a quaternion, as returned by `TransformListener.lookupTransform`."""
    position, quaternion = tf
    return Frame(Rotation.Quaternion(*quaternion), Vector(*position))


def toTf(f: Frame) -> tuple[tuple[float, ...], tuple[float, ...]]:  # noqa: N802
    """Return the position and the quaternion of a frame."""
    return tuple(f.p), f.M.GetQuaternion()


def fromMsg(p: Any) -> Frame:  # noqa: N802
    """Return the frame of a geometry_msgs/Pose."""
    turn, place = p.orientation, p.position
    return Frame(Rotation.Quaternion(turn.x, turn.y, turn.z, turn.w), Vector(place.x, place.y, place.z))


def toMsg(f: Frame) -> Any:  # noqa: N802
    """Return a frame as a geometry_msgs/Pose of the importing node's ROS generation."""
    from pytest_tarl.ros.install import kind_of_caller
    from pytest_tarl.ros.messages import class_of

    pose = class_of(kind_of_caller(), "geometry_msgs/Pose")()
    pose.position.x, pose.position.y, pose.position.z = f.p
    turn = pose.orientation
    turn.x, turn.y, turn.z, turn.w = f.M.GetQuaternion()
    return pose


def fromMatrix(m: Any) -> Frame:  # noqa: N802
    """Return the frame of a 4×4 matrix."""
    numbers = [float(m[row][column]) for row in range(3) for column in range(3)]
    return Frame(Rotation(*numbers), Vector(*(float(m[row][3]) for row in range(3))))


def toMatrix(f: Frame) -> Any:  # noqa: N802
    """Return the 4×4 matrix of a frame."""
    import numpy as np

    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape([*f.M], (3, 3))
    matrix[:3, 3] = list(f.p)
    return matrix
