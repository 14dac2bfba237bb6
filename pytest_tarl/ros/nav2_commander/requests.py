"""A navigator's requests to the servers of Nav2: paths, maps, costmaps, and node lifecycles."""

# ruff: noqa: N802 (names are those of nav2_simple_commander)

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pytest_tarl.ros.messages import message_type
from pytest_tarl.ros.rclpy import spin_once, spin_until_future_complete
from pytest_tarl.ros.rclpy.action.client import ActionClient
from pytest_tarl.ros.rclpy.node import Node
from pytest_tarl.ros.rclpy.time import Duration

_SUCCEEDED = 4  # action_msgs/GoalStatus


class Requests(Node):
    """A node that calls Nav2's actions and services, and waits for them in virtual time."""

    def __init__(self, node_name: str, namespace: str) -> None:
        super().__init__(node_name=node_name, namespace=namespace)
        self._actions: dict[str, Any] = {}
        self._services: dict[str, Any] = {}

    def info(self, msg: str) -> None:
        """Log a string."""
        self.get_logger().info(msg)

    def warn(self, msg: str) -> None:
        """Log a warning."""
        self.get_logger().warning(msg)

    def error(self, msg: str) -> None:
        """Log an error."""
        self.get_logger().error(msg)

    def debug(self, msg: str) -> None:
        """Log a string for developers."""
        self.get_logger().debug(msg)

    def destroyNode(self) -> None:
        """Destroy the node."""
        self.destroy_node()

    def _send(
        self, action: str, name: str, goal: dict[str, Any], on_feedback: Callable[[Any], None] | None = None
    ) -> Any:
        """Send a goal to an action server; return its handle once the server has answered."""
        kind = message_type(f"nav2_msgs/action/{action}")
        if name not in self._actions:
            self._actions[name] = ActionClient(self, kind, name)
        client = self._actions[name]
        self.debug(f"Waiting for '{action}' action server")
        while not client.wait_for_server(timeout_sec=1.0):
            self.info(f"'{action}' action server not available, waiting...")
        future = client.send_goal_async(kind.Goal(**goal), on_feedback)
        self._wait_for(future)
        return future.result()

    def _call(self, service: str, name: str, **fields: Any) -> Any:
        """Call a service, and return its response."""
        kind = message_type(f"nav2_msgs/srv/{service}")
        if name not in self._services:
            self._services[name] = self.create_client(kind, name)
        client = self._services[name]
        while not client.wait_for_service(timeout_sec=1.0):
            self.info(f"{name} service not available, waiting...")
        future = client.call_async(kind.Request(**fields))
        self._wait_for(future)
        return future.result()

    def _wait_for(self, future: Any, seconds: float | None = None) -> None:
        spin_until_future_complete(self, future, timeout_sec=seconds)

    def _spin_for(self, seconds: float) -> None:
        spin_once(self, timeout_sec=seconds)


class PathRequests(Requests):
    """Requests to the planner and the smoother."""

    def getPath(self, start: Any, goal: Any, planner_id: str = "", use_start: bool = False) -> Any:
        """Return the planner's path to a pose, or None if it finds none."""
        result = self._result(
            "ComputePathToPose",
            "compute_path_to_pose",
            start=start,
            goal=goal,
            planner_id=planner_id,
            use_start=use_start,
        )
        return None if result is None else result.path

    def getPathThroughPoses(
        self, start: Any, goals: Any, planner_id: str = "", use_start: bool = False
    ) -> Any:
        """Return the planner's path through poses, or None if it finds none."""
        result = self._result(
            "ComputePathThroughPoses",
            "compute_path_through_poses",
            start=start,
            goals=goals,
            planner_id=planner_id,
            use_start=use_start,
        )
        return None if result is None else result.path

    def smoothPath(
        self, path: Any, smoother_id: str = "", max_duration: float = 2.0, check_for_collision: bool = False
    ) -> Any:
        """Return the smoothed path, or None if the smoother fails."""
        result = self._result(
            "SmoothPath",
            "smooth_path",
            path=path,
            smoother_id=smoother_id,
            max_smoothing_duration=Duration(seconds=max_duration).to_msg(),
            check_for_collisions=check_for_collision,
        )
        return None if result is None else result.path

    def _result(self, action: str, name: str, **goal: Any) -> Any:
        """Return the result of a goal, or None if it was rejected or failed."""
        handle = self._send(action, name, goal)
        if not handle.accepted:
            self.error(f"{action} was rejected!")
            return None
        future = handle.get_result_async()
        self._wait_for(future)
        status = future.result().status
        if status != _SUCCEEDED:
            self.warn(f"{action} failed with status code: {status}")
            return None
        return future.result().result


class MapRequests(Requests):
    """Requests to the map server, the costmaps and the lifecycle managers."""

    def changeMap(self, map_filepath: str) -> None:
        """Load another map."""
        answer = self._call("LoadMap", "map_server/load_map", map_url=map_filepath)
        if answer.result == answer.RESULT_SUCCESS:
            self.info("Change map request was successful!")
        else:
            self.error("Change map request failed!")

    def clearAllCostmaps(self) -> None:
        """Clear the local and the global costmap."""
        self.clearLocalCostmap()
        self.clearGlobalCostmap()

    def clearLocalCostmap(self) -> None:
        """Clear the local costmap."""
        self._call("ClearEntireCostmap", "local_costmap/clear_entirely_local_costmap")

    def clearGlobalCostmap(self) -> None:
        """Clear the global costmap."""
        self._call("ClearEntireCostmap", "global_costmap/clear_entirely_global_costmap")

    def getGlobalCostmap(self) -> Any:
        """Return the global costmap."""
        return self._call("GetCostmap", "global_costmap/get_costmap").map

    def getLocalCostmap(self) -> Any:
        """Return the local costmap."""
        return self._call("GetCostmap", "local_costmap/get_costmap").map

    def lifecycleStartup(self) -> None:
        """Start the nodes of all lifecycle managers."""
        self._manage(0)

    def lifecycleShutdown(self) -> None:
        """Shut down the nodes of all lifecycle managers."""
        self._manage(4)

    def _manage(self, command: int) -> None:
        for name, kinds in self.get_service_names_and_types():
            if kinds[0] == "nav2_msgs/srv/ManageLifecycleNodes":
                self._call("ManageLifecycleNodes", name, command=command)
