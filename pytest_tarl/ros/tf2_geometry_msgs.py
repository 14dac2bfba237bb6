"""tf2_geometry_msgs: transform stamped geometry into another frame."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import Any

from pytest_tarl.ros.tf2_kdl import transform_to_kdl
from pytest_tarl.ros.transforms import Rigid, multiply, rotate

__all__ = [
    "do_transform_point", "do_transform_polygon_stamped", "do_transform_pose", "do_transform_pose_stamped",
    "do_transform_pose_with_covariance_stamped", "do_transform_vector3", "do_transform_wrench", "from_msg_msg",
    "to_msg_msg", "transform_covariance", "transform_to_kdl",
]  # fmt: skip


def _rigid(transform: Any) -> Rigid:
    move, turn = transform.transform.translation, transform.transform.rotation
    return Rigid((move.x, move.y, move.z), (turn.x, turn.y, turn.z, turn.w))


def _set(vector: Any, parts: tuple[float, float, float]) -> None:
    vector.x, vector.y, vector.z = (float(part) for part in parts)


def _move_pose(pose: Any, rigid: Rigid) -> None:
    _set(pose.position, rigid.apply((pose.position.x, pose.position.y, pose.position.z)))
    turn = pose.orientation
    turn.x, turn.y, turn.z, turn.w = multiply(rigid.rotation, (turn.x, turn.y, turn.z, turn.w))


def _in_frame(message: Any, transform: Any) -> Any:
    moved = deepcopy(message)
    moved.header = deepcopy(transform.header)
    return moved


def do_transform_point(point: Any, transform: Any) -> Any:
    """Return a PointStamped in the transform's frame."""
    moved = _in_frame(point, transform)
    _set(moved.point, _rigid(transform).apply((point.point.x, point.point.y, point.point.z)))
    return moved


def do_transform_vector3(vector3: Any, transform: Any) -> Any:
    """Return a Vector3Stamped in the transform's frame, rotated but not translated."""
    moved = _in_frame(vector3, transform)
    _set(
        moved.vector,
        rotate(_rigid(transform).rotation, (vector3.vector.x, vector3.vector.y, vector3.vector.z)),
    )
    return moved


def do_transform_pose(pose: Any, transform: Any) -> Any:
    """Return a Pose (ROS 2) or PoseStamped (ROS 1) in the transform's frame."""
    if hasattr(pose, "header"):
        return do_transform_pose_stamped(pose, transform)
    moved = deepcopy(pose)
    _move_pose(moved, _rigid(transform))
    return moved


def do_transform_pose_stamped(pose: Any, transform: Any) -> Any:
    """Return a PoseStamped in the transform's frame."""
    moved = _in_frame(pose, transform)
    _move_pose(moved.pose, _rigid(transform))
    return moved


def transform_covariance(cov_in: Any, transform: Any) -> Any:
    """Return the 36 values of a pose covariance, rotated: an array for an array, otherwise a list."""
    import numpy as np

    rotation = _rigid(transform).rotation
    turn = np.array([rotate(rotation, axis) for axis in ((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0))]).T
    both = np.kron(np.eye(2), turn)
    turned = (both @ np.asarray(cov_in, dtype=float).reshape(6, 6) @ both.T).ravel()
    return turned if hasattr(cov_in, "dtype") else turned.tolist()


def do_transform_pose_with_covariance_stamped(pose: Any, transform: Any) -> Any:
    """Return a PoseWithCovarianceStamped in the transform's frame, including its covariance."""
    moved = _in_frame(pose, transform)
    _move_pose(moved.pose.pose, _rigid(transform))
    moved.pose.covariance = transform_covariance(pose.pose.covariance, transform)
    return moved


def do_transform_polygon_stamped(polygon: Any, transform: Any) -> Any:
    """Return a PolygonStamped in the transform's frame."""
    moved = _in_frame(polygon, transform)
    for corner in moved.polygon.points:
        _set(corner, _rigid(transform).apply((corner.x, corner.y, corner.z)))
    return moved


def do_transform_wrench(wrench: Any, transform: Any) -> Any:
    """Return a WrenchStamped in the transform's frame, rotated but not translated."""
    moved = _in_frame(wrench, transform)
    for part in (moved.wrench.force, moved.wrench.torque):
        _set(part, rotate(_rigid(transform).rotation, (part.x, part.y, part.z)))
    return moved


def to_msg_msg(msg: Any) -> Any:
    """Return the message itself."""
    return msg


def from_msg_msg(msg: Any) -> Any:
    """Return the message itself."""
    return msg


TRANSFORMERS: dict[str, Callable[[Any, Any], Any]] = {
    "PointStamped": do_transform_point,
    "PolygonStamped": do_transform_polygon_stamped,
    "PoseStamped": do_transform_pose_stamped,
    "PoseWithCovarianceStamped": do_transform_pose_with_covariance_stamped,
    "Vector3Stamped": do_transform_vector3,
    "WrenchStamped": do_transform_wrench,
}


def __getattr__(name: str) -> Any:
    """Return a stamped message class that the library exposes; raise for a name that the stand-in lacks."""
    if name in TRANSFORMERS:
        from pytest_tarl.ros.install import kind_of_caller
        from pytest_tarl.ros.messages import class_of

        return class_of(kind_of_caller(), f"geometry_msgs/{name}")
    raise AttributeError(name)
