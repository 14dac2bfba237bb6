"""nav2_simple_commander: tasks for action servers, which a second node of the test serves."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.ros import message_type
from tests.plugin.ros.conftest import Start, heard

SERVER = """
    import time
    import rclpy
    from lifecycle_msgs.srv import GetState
    from nav2_msgs.action import ComputePathToPose, NavigateToPose, Spin
    from nav2_msgs.srv import ClearEntireCostmap, LoadMap, ManageLifecycleNodes
    from rclpy.action import ActionServer, CancelResponse, GoalResponse
    from rclpy.callback_groups import ReentrantCallbackGroup
    from rclpy.executors import MultiThreadedExecutor

    rclpy.init()
    node = rclpy.create_node("nav2")
    log = []

    def drive(goal):
        for step in range(10):
            if goal.is_cancel_requested:
                goal.canceled()
                return NavigateToPose.Result()
            goal.publish_feedback(NavigateToPose.Feedback(distance_remaining=float(10 - step)))
            time.sleep(0.5)
        goal.succeed() if goal.request.pose.pose.position.x < 5 else goal.abort()
        return NavigateToPose.Result()

    def plan(goal):
        result = ComputePathToPose.Result()
        result.path.poses = [goal.request.start, goal.request.goal]
        goal.succeed() if goal.request.planner_id != "none" else goal.abort()
        return result

    def serve(kind, name, execute, accept=True):
        answer = GoalResponse.ACCEPT if accept else GoalResponse.REJECT
        ActionServer(node, kind, name, execute, callback_group=ReentrantCallbackGroup(),
                     goal_callback=lambda goal: answer, cancel_callback=lambda goal: CancelResponse.ACCEPT)

    def active(request, response):
        response.current_state.label = "active"
        return response

    def load(request, response):
        log.append(request.map_url)
        return response

    serve(NavigateToPose, "navigate_to_pose", drive)
    serve(ComputePathToPose, "compute_path_to_pose", plan)
    serve(Spin, "spin", drive, accept=False)
    node.create_service(GetState, "bt_navigator/get_state", active)
    node.create_service(GetState, "amcl/get_state", active)
    node.create_service(LoadMap, "map_server/load_map", load)
    for part in ("global", "local"):
        node.create_service(ClearEntireCostmap, f"{part}_costmap/clear_entirely_{part}_costmap",
                            lambda request, response, part=part: log.append(part) or response)
    node.create_service(ManageLifecycleNodes, "manager/manage_nodes",
                        lambda request, response: log.append(request.command) or response)
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    executor.spin()
"""
BEGIN = """
    import rclpy
    from geometry_msgs.msg import PoseStamped
    from nav2_simple_commander.robot_navigator import BasicNavigator, TaskResult

    rclpy.init()
    navigator = BasicNavigator()
    found = []
    goal = PoseStamped()
    goal.header.frame_id, goal.pose.position.x = "map", X
"""
DRIVE = """
    def wait():
        while not navigator.isTaskComplete():
            feedback = navigator.getFeedback()
            if feedback and feedback.distance_remaining < CANCEL:
                navigator.cancelTask()
        found.append(navigator.getResult())

    found.append(navigator.goToPose(goal))
    wait()
"""


def run(start: Start, source: str, seconds: float = 20.0, **values: object) -> Any:
    for name, value in values.items():
        source = source.replace(name, str(value))
    ros = start(SERVER)
    served = ros.namespace["log"]  # type: ignore[attr-defined]
    start(source, ros=ros)
    for _ in range(int(seconds)):
        ros.step(1.0)
    return ros.namespace["found"], served  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("x", "cancel", "result"),
    [(1.0, 0, "SUCCEEDED"), (9.0, 0, "FAILED"), (1.0, 5, "CANCELED")],
    ids=["succeeds", "fails", "is cancelled"],
)
def test_a_task_runs_on_the_action_server(start: Start, x: float, cancel: float, result: str) -> None:
    found, _ = run(start, BEGIN + DRIVE, X=x, CANCEL=cancel)
    assert [found[0], found[1].name] == [True, result]


def test_a_rejected_task_is_not_started(start: Start) -> None:
    found, _ = run(
        start, BEGIN + "    found.append((navigator.spin(1.0), navigator.isTaskComplete()))", X=1.0
    )
    assert found == [(False, True)]


def test_paths_maps_and_costmaps_are_requested_from_their_servers(start: Start) -> None:
    source = """
    path = navigator.getPath(PoseStamped(), goal)
    found += [[one.pose.position.x for one in path.poses], navigator.getPath(goal, goal, planner_id="none")]
    navigator.changeMap("hall.yaml")
    navigator.clearAllCostmaps()
    navigator.lifecycleShutdown()
    """
    found, served = run(start, BEGIN + source, X=2.0)
    assert found == [[0.0, 2.0], None]
    assert served == ["hall.yaml", "local", "global", 4]


def test_navigator_waits_for_nav2_and_localization(start: Start) -> None:
    source = """
    navigator.setInitialPose(goal)
    navigator.waitUntilNav2Active()
    found.append(True)
    """
    ros = start(SERVER)
    poses = heard(ros, "/initialpose")
    start((BEGIN + source).replace("X", "2.0"), ros=ros)
    for _ in range(8):
        ros.step(1.0)
    assert ros.namespace["found"] == []  # type: ignore[attr-defined]
    assert {one.pose.pose.position.x for one in poses} == {2.0}
    ros.bus.publish("/amcl_pose", message_type("geometry_msgs/msg/PoseWithCovarianceStamped")())
    for _ in range(8):
        ros.step(1.0)
    assert ros.namespace["found"] == [True]  # type: ignore[attr-defined]


def test_without_nav2_the_node_waits(start: Start) -> None:
    ros = start((BEGIN + "    navigator.goToPose(goal)").replace("X", "1.0"))
    ros.step(5.0)
    assert ros.alive
