"""Further parts of the stand-ins that few nodes use: MoveIt, diagnostics, filters, parameters and actions of ROS 2."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.ros import message_type
from pytest_tarl.ros.message_filters import Subscriber
from pytest_tarl.ros.moveit_commander.scene import PlanningSceneInterface
from pytest_tarl.ros.tf2_ros.buffer import TransformRegistration, TypeException
from tests.plugin.ros.conftest import Start, heard
from tests.plugin.ros.test_moveit_commander import DESCRIBED, run

# MoveIt


def test_targets_are_set_by_poses_names_and_random_values(start: Start) -> None:
    found = run(
        start,
        """
    group.set_joint_value_target([0.4, 0.7])
    goal = group.get_joint_value_target()
    pose = robot.arm.get_current_pose()
    found.append((pose.header.frame_id, round(pose.pose.position.x, 3)))
    state = group.get_current_state()
    found.append((state.joint_state.header.frame_id, list(state.joint_state.name), list(state.joint_state.position)))
    there = group.get_random_pose()
    found.append(there.pose.position.x ** 2 + there.pose.position.y ** 2 <= 4.0 + 1e-6)
    values = group.get_random_joint_values()
    found.append((len(values), all(-2 <= one <= 2 for one in values)))
    group.remember_joint_values("here")
    group.remember_joint_values("there", [0.1, 0.2])
    found.append((group.get_remembered_joint_values(), group.get_named_targets()))
    group.set_named_target("there")
    found.append(group.get_joint_value_target())
    group.forget_joint_values("there")
    group.forget_joint_values("nowhere")
    found.append(list(group.get_remembered_joint_values()))
    try:
        group.set_named_target("there")
    except moveit_commander.MoveItCommanderException as error:
        found.append(str(error))
    group.set_random_target()
    found.append(all(-2 <= one <= 2 for one in group.get_joint_value_target()))
    """,
    )
    assert found[0] == ("base", 2.0)
    assert found[1] == ("base", ["shoulder", "elbow"], [0.0, 0.0])
    assert found[2:4] == [True, (2, True)]
    assert found[4] == ({"here": [0.0, 0.0], "there": [0.1, 0.2]}, ["folded", "here", "there"])
    assert found[5] == [0.1, 0.2]
    assert found[6] == ["here"]
    assert "there" in found[7]
    assert found[8] is True


def test_joint_target_pose_must_be_reachable(start: Start) -> None:
    found = run(
        start,
        """
    from math import cos, sin
    def at(shoulder, elbow):
        pose = Pose()
        pose.position.x = cos(shoulder) + cos(shoulder + elbow)
        pose.position.y = sin(shoulder) + sin(shoulder + elbow)
        pose.orientation.z, pose.orientation.w = sin((shoulder + elbow) / 2), cos((shoulder + elbow) / 2)
        return pose
    for given in ((at(0.3, 0.5),), (at(0.3, 0.5), "hand"), (at(0.3, 0.5), True), (at(0.3, 0.5), "hand", True)):
        group.set_joint_value_target([0.0, 0.0])
        group.set_joint_value_target(*given)
        found.append([round(one, 2) for one in group.get_joint_value_target()])
    far = Pose()
    far.position.x, far.orientation.w = 9.0, 1.0
    for given in ((far,), (far, True)):
        try:
            group.set_joint_value_target(*given)
        except moveit_commander.MoveItCommanderException as error:
            found.append("approximate" in str(error))
    group.set_pose_targets([at(0.2, 0.4), far])
    found.append(group.go(wait=True))
    found.append([round(one, 2) for one in group.get_current_joint_values()])
    group.set_pose_target([0.0, 2.0, 0.0, 0.0, 0.0, 1.5707963])
    found.append(group.go(wait=True))
    for clear in (group.clear_pose_targets, group.clear_pose_target):
        group.set_pose_target(far)
        found.append(group._pose is None)
        clear()
        found.append(group._pose is None)
    group.set_path_constraints(None)
    found.append(type(group.get_path_constraints()).__name__)
    group.set_path_constraints("mine")
    found.append(group.get_path_constraints())
    group.clear_path_constraints()
    found.append(type(group.get_path_constraints()).__name__)
    """,
        60.0,
    )
    assert found[:4] == [[0.3, 0.5]] * 4
    assert found[4:6] == [False, True]
    assert found[6:9] == [True, [0.2, 0.4], True]
    assert found[9:13] == [False, True, False, True]
    assert found[13:] == ["Constraints", "mine", "Constraints"]


def test_attached_objects_are_published_with_their_link(start: Start) -> None:
    ros = start(
        """
        import sys
        import moveit_commander, rospy
        moveit_commander.roscpp_initialize(sys.argv)
        rospy.init_node("arm")
        group = moveit_commander.MoveGroupCommander("arm")
        rospy.sleep(0.1)
        found = [group.attach_object("cup"), group.attach_object("jar", "lower", ["upper"]), group.detach_object("cup")]
        rospy.spin()
        """,
        parameters=DESCRIBED,
    )
    seen = heard(ros, "/attached_collision_object")
    ros.step(1.0)
    assert ros.namespace["found"] == [True, True, True]
    told = [(one.object.id, one.object.operation, one.link_name, list(one.touch_links)) for one in seen]
    assert told == [("cup", 0, "hand", []), ("jar", 0, "lower", ["upper"]), ("cup", 1, "", [])]


def scene() -> tuple[Any, list[Any]]:
    made = PlanningSceneInterface.__new__(PlanningSceneInterface)
    published: list[Any] = []
    made._objects, made._attached = {}, {}
    made._publisher = SimpleNamespace(publish=published.append)  # type: ignore[assignment]
    return made, published


def stamped(x: float) -> Any:
    pose: Any = message_type("geometry_msgs/PoseStamped")()
    pose.header.frame_id, pose.pose.position.x = "base", x
    return pose


def test_scene_objects_are_added_and_removed() -> None:
    made, published = scene()
    made.add_box("box", stamped(1.0), (1, 2, 3))
    made.add_sphere("ball", stamped(2.0), 0.5)
    made.add_cylinder("can", stamped(3.0), 2, 0.5)
    made.add_cone("hat", stamped(4.0), 3, 0.25)
    made.add_plane("floor", stamped(5.0), (0, 1, 0), 7)
    items = [one.world.collision_objects[0] for one in published]
    assert [(one.id, one.operation, one.pose.position.x, one.header.frame_id) for one in items] == [
        (name, 0, float(x), "base") for x, name in enumerate(("box", "ball", "can", "hat", "floor"), 1)
    ]
    assert [(one.primitives[0].type, list(one.primitives[0].dimensions)) for one in items[:4]] == [
        (1, [1.0, 2.0, 3.0]), (2, [0.5]), (3, [2.0, 0.5]), (4, [3.0, 0.25])
    ]  # fmt: skip
    assert items[0].primitive_poses[0].orientation.w == 1.0
    assert list(items[4].planes[0].coef) == [0.0, 1.0, 0.0, 7.0]
    assert items[4].plane_poses[0].position.x == 5.0
    assert all(one.is_diff for one in published)
    assert sorted(made.get_objects(["ball", "can"])) == ["ball", "can"]
    assert len(made.get_objects()) == 5
    assert made.get_object_poses(["hat"])["hat"].position.x == 4.0
    made.attach_box("hand", "box")
    made.attach_box("lower", "new", stamped(9.0), (1, 1, 1), ["upper"])
    assert (made.get_known_object_names(), [*made.get_attached_objects()]) == (
        ["ball", "can", "hat", "floor"], ["box", "new"]
    )  # fmt: skip
    assert [*made.get_attached_objects(["new"])] == ["new"]
    attached = published[-1].robot_state.attached_collision_objects[0]
    assert (attached.link_name, list(attached.touch_links), attached.object.pose.position.x) == (
        "lower", ["upper"], 9.0
    )  # fmt: skip
    made.remove_attached_object("hand")
    assert [*made.get_attached_objects()] == ["new"]
    published.clear()
    made.clear()
    assert (made.get_known_object_names(), made.get_attached_objects()) == ([], {})
    assert sorted(one.world.collision_objects[0].id for one in published if one.world.collision_objects) == [
        "ball", "box", "can", "floor", "hat", "new"
    ]  # fmt: skip
    made.remove_world_object("unknown")
    assert published[-1].world.collision_objects[0].operation == 1


# diagnostics

UPDATER = """
    import diagnostic_updater, rospy
    from std_msgs.msg import Header
    from geometry_msgs.msg import PointStamped
    rospy.init_node("node")
    updater = diagnostic_updater.Updater()
    warned = []
    updater._warn = warned.append
    class Task(diagnostic_updater.DiagnosticTask):
        level = 0
        def run(self, status):
            status.summary(self.level, "as it is")
            return status
    task = Task("motor")
    updater.add(task)
    updater.force_update()
    updater.force_update()
    updater.verbose = True
    updater.setHardwareID("none")
    updater.force_update()
    task.level = 1
    updater.force_update()
    first = list(warned)
    rospy.sleep(0.1)
    updater.broadcast(2, "stopping")
    bounds = diagnostic_updater.FrequencyStatusParam({"min": 1.0, "max": 2.0}, 0.1, 5)
    stamps = diagnostic_updater.TimeStampStatusParam()
    topic = diagnostic_updater.TopicDiagnostic("in", updater, bounds, stamps)
    points = rospy.Publisher("/out", PointStamped, queue_size=1)
    out = diagnostic_updater.DiagnosedPublisher(points, updater, bounds, stamps)
    names = [topic.name, out.name]
    for number in range(5):
        rospy.sleep(0.6)
        out.publish(PointStamped(header=Header(stamp=rospy.Time.now())))
    updater.force_update()
    out.clear_window()
    updater.force_update()
    rospy.sleep(1000.0)
"""


def test_updater_warns_once_without_a_hardware_id(start: Start) -> None:
    ros = start(UPDATER)
    seen = heard(ros, "/diagnostics")
    points = heard(ros, "/out")
    ros.step(4.0)
    warned = ros.namespace["first"]
    assert len(warned) == 2
    assert "no hardware ID was set" in warned[0]
    assert warned[1] == "Task 'motor' has level 1: 'as it is'"
    told = [{status.name: (status.level, status.message) for status in one.status} for one in seen]
    assert {"node: motor": (2, "stopping")} in told
    assert ros.namespace["names"] == ["in topic status", "/out topic status"]
    assert len(points) == 5
    before, after = (one["node: /out topic status"] for one in told[-2:])
    assert before[1] != after[1]
    assert after[0] == 2  # no events since the window was cleared


# message filters and tf2


def test_a_filter_subscribes_in_either_generation_and_ends() -> None:
    made: list[tuple[Any, ...]] = []
    ended: list[str] = []

    class Node:
        def create_subscription(self, *given: Any, **named: Any) -> Any:
            made.append((given, named))
            return SimpleNamespace(destroy=lambda: ended.append("destroy"))

    node = Node()
    for more, named, profile in (
        ((), {}, 10),
        ((5,), {}, 5),
        ((), {"qos_profile": 7}, 7),
        ((5,), {"qos_profile": 7}, 7),
    ):
        one = Subscriber(node, "type", "/in", *more, raw=True, **named)
        assert made[-1] == (("type", "/in", one.callback, profile), {"raw": True})
        assert one.getTopic() == "/in"
    seen: list[Any] = []
    one.registerCallback(lambda *given: seen.append(given), "more")
    one.callback("message")
    assert seen == [("message", "more")]
    one.unregister()
    one.sub = SimpleNamespace(unregister=lambda: ended.append("unregister"), destroy=None)
    one.unsubscribe()
    assert ended == ["destroy", "unregister"]


def test_a_registered_type_is_transformed_by_its_own_function() -> None:
    made = TransformRegistration()
    kind = type("Own", (), {})
    with pytest.raises(TypeException, match="Own"):
        made.get(kind)
    made.add(kind, "function")  # type: ignore[arg-type]
    assert made.get(kind) == "function"  # type: ignore[comparison-overlap]
    assert made.get(type("PointCloud2", (), {})).__name__ == "do_transform_cloud"


def test_buffer_knows_frames_and_common_times(start: Start) -> None:
    ros = start("""
        import rospy, tf2_ros
        from geometry_msgs.msg import TransformStamped
        rospy.init_node("node")
        buffer = tf2_ros.Buffer()
        def put(parent, child, seconds, static=False):
            one = TransformStamped()
            one.header.frame_id, one.child_frame_id, one.header.stamp = parent, child, rospy.Time(seconds)
            one.transform.rotation.w = 1.0
            (buffer.set_transform_static if static else buffer.set_transform)(one, "me")
        put("map", "base", 1)
        put("map", "base", 3)
        put("base", "arm", 2)
        put("arm", "hand", 0, static=True)
        known = [buffer.frame_exists(name) for name in ("map", "/base", "hand", "moon")]
        common = buffer.get_latest_common_time("map", "hand").to_sec()
        buffer.clear()
        left = [buffer.frame_exists(name) for name in ("map", "base", "arm", "hand")]
    """)
    assert ros.namespace["known"] == [True, True, True, False]
    assert ros.namespace["common"] == 2.0
    assert ros.namespace["left"] == [False, False, True, True]


# rclpy

PARAMETERS = """
    import rclpy
    from rclpy.node import Node
    from rclpy.parameter import Parameter
    from rcl_interfaces.srv import DescribeParameters, GetParameters, GetParameterTypes, SetParameters
    rclpy.init()
    node = Node("node", automatically_declare_parameters_from_overrides=True,
                parameter_overrides=[Parameter("own", value=4)])
    node.declare_parameter("speed", 2.0)
    from pytest_tarl.ros.rclpy.parameter_services import _Services as Services, parameter_event
    services = Services(node)
    found = []
    for kind, name, field in ((GetParameters, "get_parameters", "values"),
                              (GetParameterTypes, "get_parameter_types", "types"),
                              (DescribeParameters, "describe_parameters", "descriptors")):
        for names in (["speed", "own"], ["speed", "none"]):
            answer = getattr(services, name)(kind.Request(names=names), kind.Response())
            found.append(len(getattr(answer, field)))
    request = SetParameters.Request(parameters=[Parameter("speed", value=3.0).to_parameter_msg(),
                                                Parameter("none", value=1).to_parameter_msg()])
    results = services.set_parameters(request, SetParameters.Response()).results
    found += [[one.successful for one in results], "none" in results[1].reason, node.get_parameter("speed").value]
    changes = [Parameter("speed", value=1.0), Parameter("new", value=1), Parameter("own")]
    event = parameter_event(node, changes, {"speed", "own"})
    parts = (event.new_parameters, event.changed_parameters, event.deleted_parameters)
    found.append([[one.name for one in part] for part in parts])
    from rclpy.executors import SingleThreadedExecutor
    one, other = SingleThreadedExecutor(), SingleThreadedExecutor()
    node.executor = one
    node.executor = one
    inside = [node in one.get_nodes(), node in other.get_nodes()]
    node.executor = other
    inside += [node in one.get_nodes(), node in other.get_nodes()]
    node.executor = None
    inside += [node in other.get_nodes(), node.executor]
    timer = node.create_timer(1.0, lambda: None)
    removed = [node.destroy_timer(timer), node.destroy_timer(timer), timer.is_canceled()]
    with Node("inner") as inner:
        names = node.get_node_names()
    gone = node.get_node_names()
"""


def test_a_node_has_parameter_services_executors_and_timers(start: Start) -> None:
    import pytest_tarl.ros.rclpy.parameter_services as module

    (name,) = [one for one, kind in vars(module).items() if hasattr(kind, "set_parameters_atomically")]
    ros = start(PARAMETERS.replace("_Services", name))
    found = ros.namespace
    assert found["found"] == [2, 0, 2, 0, 2, 0, [True, False], True, 3.0, [["new"], ["speed"], ["own"]]]
    assert found["inside"] == [True, False, False, True, False, None]
    assert found["removed"] == [True, False, True]
    assert ("inner" in found["names"], "inner" in found["gone"]) == (True, False)
    assert found["node"].get_parameter("own").value == 4


ACTION = """
    import rclpy
    from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
    from rclpy.node import Node
    from example_interfaces.action import Fibonacci
    rclpy.init()
    node = Node("node")
    log = []
    def decide(goal):
        return {0: GoalResponse.ACCEPT, 1: GoalResponse.REJECT, 2: True}[goal.order % 3]
    def execute(handle):
        log.append(("run", handle.request.order))
        if handle.request.order == 3:
            raise ValueError("odd")
        if handle.request.order == 6:
            handle.succeed()
        return Fibonacci.Result(sequence=[handle.request.order])
    server = ActionServer(node, Fibonacci, "act", execute, goal_callback=decide)
    client = ActionClient(node, Fibonacci, "act")
    client.wait_for_server()
    answers = []
    for order in (0, 1, 2, 3, 6):
        future = client.send_goal_async(Fibonacci.Goal(order=order))
        rclpy.spin_until_future_complete(node, future)
        handle = future.result()
        if not handle.accepted:
            answers.append((order, "refused"))
            continue
        done = handle.get_result_async()
        rclpy.spin_until_future_complete(node, done)
        answers.append((order, done.result().status, list(done.result().result.sequence)))
    cancelled = handle.cancel_goal_async()
    rclpy.spin_until_future_complete(node, cancelled)
    late = cancelled.result().return_code
    before = client.server_is_ready()
    with server:
        pass
    after = client.server_is_ready()
"""


def test_an_action_server_decides_executes_and_ends(start: Start) -> None:
    ros = start(ACTION)
    ros.step(5.0)
    found = ros.namespace
    # 6 is ABORTED, 4 SUCCEEDED; an answer that is no GoalResponse rejects the goal
    assert found["answers"] == [(0, 6, [0]), (1, "refused"), (2, "refused"), (3, 6, []), (6, 4, [6])]
    assert found["log"] == [("run", 0), ("run", 3), ("run", 6)]
    assert found["late"] == 3  # the goal has ended
    assert (found["before"], found["after"]) == (True, False)
