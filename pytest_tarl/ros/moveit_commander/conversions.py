"""`moveit_commander.conversions`: poses as lists, and back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pytest_tarl.ros.messages import class_of
from pytest_tarl.ros.moveit_commander.exception import MoveItCommanderException
from pytest_tarl.ros.transformations_rigid import euler_from_quaternion, quaternion_from_euler

__all__ = ["list_to_pose", "list_to_pose_stamped", "list_to_transform", "pose_to_list", "transform_to_list"]


def pose_to_list(pose_msg: Any) -> list[float]:
    """Return x, y, z and the quaternion of a pose."""
    place, turn = pose_msg.position, pose_msg.orientation
    return [place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w]


def list_to_pose(pose_list: Sequence[float]) -> Any:
    """Return the pose for x, y, z and a quaternion, or for x, y, z, roll, pitch and yaw.

    Raise MoveItCommanderException for a list of another length.
    """
    pose: Any = class_of("ros1", "geometry_msgs/Pose")()
    if len(pose_list) not in (6, 7):
        raise MoveItCommanderException(
            "Expected either 6 or 7 elements in list: (x,y,z,r,p,y) or (x,y,z,qx,qy,qz,qw)"
        )
    turned = (
        pose_list[3:]
        if len(pose_list) == 7
        else quaternion_from_euler(pose_list[3], pose_list[4], pose_list[5])
    )
    pose.position.x, pose.position.y, pose.position.z = map(float, pose_list[:3])
    turn = pose.orientation
    turn.x, turn.y, turn.z, turn.w = map(float, turned)
    return pose


def list_to_pose_stamped(pose_list: Sequence[float], target_frame: str) -> Any:
    """Return the pose for a list, stamped with a frame and the current time."""
    from pytest_tarl.ros.rospy.timing import Time

    stamped: Any = class_of("ros1", "geometry_msgs/PoseStamped")()
    stamped.pose = list_to_pose(pose_list)
    stamped.header.frame_id, stamped.header.stamp = target_frame, Time.now()
    return stamped


def transform_to_list(trf_msg: Any) -> list[float]:
    """Return the translation and the quaternion of a transform."""
    move, turn = trf_msg.translation, trf_msg.rotation
    return [move.x, move.y, move.z, turn.x, turn.y, turn.z, turn.w]


def list_to_transform(trf_list: Sequence[float]) -> Any:
    """Return the transform of a translation and a quaternion."""
    transform: Any = class_of("ros1", "geometry_msgs/Transform")()
    move, turn = transform.translation, transform.rotation
    move.x, move.y, move.z = map(float, trf_list[:3])
    turn.x, turn.y, turn.z, turn.w = map(float, trf_list[3:])
    return transform


def rpy_of(pose: Any) -> list[float]:
    """Return roll, pitch and yaw of a pose."""
    turn = pose.orientation
    return [float(one) for one in euler_from_quaternion((turn.x, turn.y, turn.z, turn.w))]
