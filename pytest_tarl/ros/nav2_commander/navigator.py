"""`BasicNavigator`: sends tasks to Nav2's action servers, and waits for them."""

# ruff: noqa: N802 (names are those of nav2_simple_commander)

from __future__ import annotations

import time
from enum import Enum
from typing import Any

from pytest_tarl.ros.messages import message_type
from pytest_tarl.ros.nav2_commander.requests import MapRequests, PathRequests
from pytest_tarl.ros.rclpy.time import Duration

__all__ = ["BasicNavigator", "TaskResult"]


_SUCCEEDED, _CANCELED, _ABORTED = 4, 5, 6  # action_msgs/GoalStatus


class TaskResult(Enum):
    """How a task ended."""

    UNKNOWN = 0
    SUCCEEDED = 1
    CANCELED = 2
    FAILED = 3


class BasicNavigator(PathRequests, MapRequests):
    """A node that sends one task at a time: start it, call `isTaskComplete` until it is true, then `getResult`.

    It waits in virtual time for missing servers, which other nodes or the test's world provide.
    """

    def __init__(self, node_name: str = "basic_navigator", namespace: str = "") -> None:
        super().__init__(node_name, namespace)
        self.initial_pose = message_type("geometry_msgs/msg/PoseStamped")()
        self.initial_pose.header.frame_id = "map"
        self.goal_handle: Any = None
        self.result_future: Any = None
        self.feedback: Any = None
        self.status: int | None = None
        self.initial_pose_received = False
        self._watch_pose()

    def setInitialPose(self, initial_pose: Any) -> None:
        """Publish the robot's pose for the localizer."""
        self.initial_pose_received = False
        self.initial_pose = initial_pose
        self._publish_pose(initial_pose)

    def goToPose(self, pose: Any, behavior_tree: str = "") -> bool:
        """Send a goal of NavigateToPose; return whether it was accepted."""
        return self._task("NavigateToPose", "navigate_to_pose", pose=pose, behavior_tree=behavior_tree)

    def goThroughPoses(self, poses: list[Any], behavior_tree: str = "") -> bool:
        """Send a goal of NavigateThroughPoses; return whether it was accepted."""
        return self._task(
            "NavigateThroughPoses", "navigate_through_poses", poses=poses, behavior_tree=behavior_tree
        )

    def followWaypoints(self, poses: list[Any]) -> bool:
        """Send a goal of FollowWaypoints; return whether it was accepted."""
        return self._task("FollowWaypoints", "follow_waypoints", poses=poses)

    def followPath(self, path: Any, controller_id: str = "", goal_checker_id: str = "") -> bool:
        """Send a goal of FollowPath; return whether it was accepted."""
        return self._task(
            "FollowPath",
            "follow_path",
            path=path,
            controller_id=controller_id,
            goal_checker_id=goal_checker_id,
        )

    def spin(self, spin_dist: float = 1.57, time_allowance: float = 10) -> bool:
        """Send a goal of Spin, an angle in rad; return whether it was accepted."""
        return self._task(
            "Spin", "spin", target_yaw=float(spin_dist), time_allowance=_seconds(time_allowance)
        )

    def backup(
        self, backup_dist: float = 0.15, backup_speed: float = 0.025, time_allowance: float = 10
    ) -> bool:
        """Send a goal of BackUp, a distance in m; return whether it was accepted."""
        return self._straight("BackUp", "backup", backup_dist, backup_speed, time_allowance)

    def driveOnHeading(self, dist: float = 0.15, speed: float = 0.025, time_allowance: float = 10) -> bool:
        """Send a goal of DriveOnHeading, a distance in m; return whether it was accepted."""
        return self._straight("DriveOnHeading", "drive_on_heading", dist, speed, time_allowance)

    def assistedTeleop(self, time_allowance: float = 30) -> bool:
        """Send a goal of AssistedTeleop; return whether it was accepted."""
        return self._task("AssistedTeleop", "assisted_teleop", time_allowance=_seconds(time_allowance))

    def _straight(self, action: str, name: str, distance: float, speed: float, seconds: float) -> bool:
        target = message_type("geometry_msgs/msg/Point")(x=float(distance))
        return self._task(action, name, target=target, speed=float(speed), time_allowance=_seconds(seconds))

    def cancelTask(self) -> None:
        """Cancel the task, and wait for the answer."""
        self.info("Canceling current task.")
        if self.result_future is not None and self.goal_handle is not None:
            self._wait_for(self.goal_handle.cancel_goal_async())

    def isTaskComplete(self) -> bool:
        """Return whether the task has ended, after waiting for at most 0.1 s."""
        if self.result_future is None:
            return True  # there is no task, or an earlier call already received its result
        self._wait_for(self.result_future, 0.1)
        if self.result_future.result() is None:
            return False  # the wait timed out
        self.status = self.result_future.result().status
        if self.status != _SUCCEEDED:
            self.debug(f"Task with failed with status code: {self.status}")
        return True

    def getFeedback(self) -> Any:
        """Return the newest feedback, or None."""
        return self.feedback

    def getResult(self) -> TaskResult:
        """Return how the task ended."""
        ends = {_SUCCEEDED: TaskResult.SUCCEEDED, _ABORTED: TaskResult.FAILED, _CANCELED: TaskResult.CANCELED}
        return ends.get(self.status, TaskResult.UNKNOWN) if self.status is not None else TaskResult.UNKNOWN

    def waitUntilNav2Active(self, navigator: str = "bt_navigator", localizer: str = "amcl") -> None:
        """Wait until localizer and navigator are active and, for AMCL, until a pose arrives."""
        if localizer != "robot_localization":
            self._wait_until_active(localizer)
        if localizer == "amcl":
            while not self.initial_pose_received:
                self.info("Waiting for amcl_pose to be received")
                self._publish_pose(self.initial_pose)
                self._spin_for(1.0)
        self._wait_until_active(navigator)
        self.info("Nav2 is ready for use!")

    def _wait_until_active(self, node: str) -> None:
        kind = message_type("lifecycle_msgs/srv/GetState")
        client = self.create_client(kind, f"{node}/get_state")
        while not client.wait_for_service(timeout_sec=1.0):
            self.info(f"{node}/get_state service not available, waiting...")
        state = "unknown"
        while state != "active":
            future = client.call_async(kind.Request())
            self._wait_for(future)
            state = future.result().current_state.label if future.result() is not None else state
            time.sleep(2)

    def _watch_pose(self) -> None:
        kind = message_type("geometry_msgs/msg/PoseWithCovarianceStamped")
        self.initial_pose_pub = self.create_publisher(kind, "initialpose", 10)
        self.localization_pose_sub = self.create_subscription(
            kind, "amcl_pose", self._received_pose, _latched()
        )

    def _received_pose(self, _pose: Any) -> None:
        self.initial_pose_received = True

    def _publish_pose(self, stamped: Any) -> None:
        pose = message_type("geometry_msgs/msg/PoseWithCovarianceStamped")()
        pose.pose.pose = stamped.pose
        pose.header.frame_id, pose.header.stamp = stamped.header.frame_id, stamped.header.stamp
        self.info("Publishing Initial Pose")
        self.initial_pose_pub.publish(pose)

    def _task(self, action: str, name: str, **goal: Any) -> bool:
        """Send a goal; return whether it was accepted."""
        self.feedback, self.status = None, None
        self.goal_handle = self._send(action, name, goal, self._fed_back)
        if not self.goal_handle.accepted:
            self.error(f"{action} request was rejected!")
            return False
        self.result_future = self.goal_handle.get_result_async()
        return True

    def _fed_back(self, message: Any) -> None:
        self.feedback = message.feedback


def _latched() -> Any:
    from pytest_tarl.ros.rclpy.qos import (
        QoSDurabilityPolicy,
        QoSHistoryPolicy,
        QoSProfile,
        QoSReliabilityPolicy,
    )

    return QoSProfile(
        durability=QoSDurabilityPolicy.TRANSIENT_LOCAL,
        reliability=QoSReliabilityPolicy.RELIABLE,
        history=QoSHistoryPolicy.KEEP_LAST,
        depth=1,
    )


def _seconds(value: float) -> Any:
    return Duration(seconds=value).to_msg()
