"""Realistic nodes that each use many parts of ROS; two equal runs have equal results."""

from __future__ import annotations

import math
from typing import Any

import pytest

from pytest_tarl.ros import Ros, message_type
from tests.plugin.ros.conftest import Start, heard

WAYPOINTS = """
    import math
    import rclpy
    from action_msgs.msg import GoalStatus
    from geometry_msgs.msg import PoseStamped
    from nav2_msgs.action import NavigateToPose
    from rclpy.action import ActionClient
    from rclpy.executors import ExternalShutdownException
    from rclpy.node import Node
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from std_msgs.msg import String

    class WaypointFollower(Node):
        def __init__(self):
            super().__init__("waypoints")
            self.declare_parameter("waypoints", [1.0, 2.0, 3.0])
            self.todo = list(self.get_parameter("waypoints").value)
            latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            self.state = self.create_publisher(String, "~/state", latched)
            self.client = ActionClient(self, NavigateToPose, "navigate_to_pose")
            self.start = self.create_timer(0.1, self.begin)

        def begin(self):
            if self.client.server_is_ready():
                self.start.cancel()
                self.next_goal()

        def next_goal(self):
            if not self.todo:
                self.state.publish(String(data="done"))
                return
            goal = NavigateToPose.Goal()
            goal.pose.header.frame_id = "map"
            goal.pose.header.stamp = self.get_clock().now().to_msg()
            goal.pose.pose.position.x = self.todo.pop(0)
            self.client.send_goal_async(goal, feedback_callback=self.progress).add_done_callback(self.answered)

        def progress(self, message):
            self.state.publish(String(data=f"{message.feedback.distance_remaining:.1f} m"))

        def answered(self, future):
            handle = future.result()
            if not handle.accepted:
                self.get_logger().error("rejected")
                return
            handle.get_result_async().add_done_callback(self.arrived)

        def arrived(self, future):
            if future.result().status == GoalStatus.STATUS_SUCCEEDED:
                self.next_goal()

    rclpy.init()
    node = WaypointFollower()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
"""
NAVIGATOR = """
    import rclpy
    from nav2_msgs.action import NavigateToPose
    from nav_msgs.msg import Odometry
    from geometry_msgs.msg import Twist
    from rclpy.action import ActionServer
    from rclpy.callback_groups import ReentrantCallbackGroup
    from rclpy.executors import MultiThreadedExecutor
    from rclpy.node import Node

    class Navigator(Node):
        def __init__(self):
            super().__init__("navigator")
            self.group = ReentrantCallbackGroup()
            self.x = 0.0
            self.create_subscription(Odometry, "odom", self.on_odom, 10, callback_group=self.group)
            self.pub = self.create_publisher(Twist, "cmd_vel", 10)
            self.server = ActionServer(self, NavigateToPose, "navigate_to_pose", self.execute,
                                       callback_group=self.group)

        def on_odom(self, message):
            self.x = message.pose.pose.position.x

        def execute(self, goal):
            rate = self.create_rate(10)
            while abs(goal.request.pose.pose.position.x - self.x) > 0.05:
                twist = Twist()
                twist.linear.x = max(-1.0, min(1.0, 4.0 * (goal.request.pose.pose.position.x - self.x)))
                self.pub.publish(twist)
                left = abs(goal.request.pose.pose.position.x - self.x)
                goal.publish_feedback(NavigateToPose.Feedback(distance_remaining=left))
                rate.sleep()
            self.pub.publish(Twist())
            goal.succeed()
            return NavigateToPose.Result()

    with rclpy.init():
        executor = MultiThreadedExecutor(num_threads=4)
        executor.add_node(Navigator())
        executor.spin()
"""


def drive(ros: Ros, steps: int) -> list[float]:
    odometry = message_type("nav_msgs/msg/Odometry")
    x, path = 0.0, []
    for _ in range(steps):
        message = odometry()
        message.pose.pose.position.x = x
        ros.bus.publish("/odom", message)
        ros.step(0.1)
        command = ros.bus.latest("/cmd_vel")
        x += 0.1 * command.linear.x if command is not None else 0.0
        path.append(x)
    return path


def test_a_waypoint_follower_sends_one_goal_after_another(start: Start) -> None:
    ros = start(NAVIGATOR)
    start(WAYPOINTS, ros=ros)
    path = drive(ros, 120)
    assert ros.bus.latest("/waypoints/state").data == "done"
    assert math.isclose(path[-1], 3.0, abs_tol=0.1)


def test_concurrent_runs_are_bitwise_equal(start: Start) -> None:
    def run() -> tuple[list[float], list[str]]:
        ros = start(NAVIGATOR)
        states = heard(ros, "/waypoints/state")
        start(WAYPOINTS, ros=ros)
        return drive(ros, 100), [state.data for state in states]

    assert run() == run()


MODES = """
    import rospy
    from geometry_msgs.msg import Twist
    from sensor_msgs.msg import LaserScan
    from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse

    class ModeSwitch(object):
        def __init__(self):
            self.enabled, self.nearest = False, float("inf")
            self.limit = rospy.get_param("~limit", 0.5)
            self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
            rospy.Subscriber("scan", LaserScan, self.on_scan, queue_size=1)
            rospy.Service("~enable", SetBool, self.on_enable)
            rospy.Service("~status", Trigger, lambda _: TriggerResponse(self.enabled, "near" if self.near else "free"))
            self.timer = rospy.Timer(rospy.Duration(0.1), self.control)
            rospy.on_shutdown(self.stop)

        @property
        def near(self):
            return self.nearest < self.limit

        def on_scan(self, scan):
            self.nearest = min(scan.ranges)

        def on_enable(self, request):
            self.enabled = request.data
            return SetBoolResponse(success=True, message="on" if request.data else "off")

        def control(self, event):
            twist = Twist()
            if self.enabled and not self.near:
                twist.linear.x = 0.4
            self.pub.publish(twist)

        def stop(self):
            self.pub.publish(Twist())

    if __name__ == "__main__":
        rospy.init_node("modes")
        ModeSwitch()
        rospy.spin()
"""


def test_a_mode_switch_follows_service_calls(start: Start) -> None:
    ros = start(MODES, parameters={"/modes/limit": 1.0})
    enable, status = message_type("std_srvs/SetBool"), message_type("std_srvs/Trigger")
    scan = message_type("sensor_msgs/LaserScan")

    def speed() -> float:
        ros.step(0.1)
        return float(ros.bus.latest("/cmd_vel").linear.x)

    ros.bus.publish("/scan", scan(ranges=[3.0]))
    assert speed() == 0.0
    assert ros.bus.call("/modes/enable", enable._request_class(data=True)).response.message == "on"  # type: ignore[attr-defined]
    assert speed() == 0.4
    ros.bus.publish("/scan", scan(ranges=[0.8]))
    assert speed() == 0.0
    assert ros.bus.call("/modes/status", status._request_class()).response.message == "near"  # type: ignore[attr-defined]


TF_FOLLOWER = """
    import math
    import rclpy
    from geometry_msgs.msg import TransformStamped, Twist
    from nav_msgs.msg import Odometry
    from rclpy.node import Node
    from rclpy.time import Time
    from tf2_ros import TransformBroadcaster, TransformException
    from tf2_ros.buffer import Buffer
    from tf2_ros.transform_listener import TransformListener

    class Follower(Node):
        def __init__(self):
            super().__init__("follower")
            self.target = self.declare_parameter("target", "leader").get_parameter_value().string_value
            self.buffer = Buffer()
            self.listener = TransformListener(self.buffer, self)
            self.broadcaster = TransformBroadcaster(self)
            self.pub = self.create_publisher(Twist, "cmd_vel", 1)
            self.create_subscription(Odometry, "odom", self.on_odom, 1)
            self.create_timer(0.1, self.control)

        def on_odom(self, message):
            t = TransformStamped()
            t.header.stamp = message.header.stamp
            t.header.frame_id, t.child_frame_id = "odom", "base"
            t.transform.translation.x = message.pose.pose.position.x
            t.transform.rotation = message.pose.pose.orientation
            self.broadcaster.sendTransform(t)

        def control(self):
            try:
                t = self.buffer.lookup_transform("base", self.target, Time())
            except TransformException as error:
                self.get_logger().info(f"no {self.target}: {error}", throttle_duration_sec=1.0)
                return
            twist = Twist()
            twist.linear.x = 0.5 * math.sqrt(t.transform.translation.x ** 2 + t.transform.translation.y ** 2)
            twist.angular.z = 4.0 * math.atan2(t.transform.translation.y, t.transform.translation.x)
            self.pub.publish(twist)

    def main():
        rclpy.init()
        rclpy.spin(Follower())

    main()
"""


def test_a_follower_reaches_its_leader(start: Start) -> None:
    ros = start(TF_FOLLOWER)
    made: Any = message_type("geometry_msgs/msg/TransformStamped")()
    made.header.frame_id, made.child_frame_id = "odom", "leader"
    made.transform.translation.x = 2.0
    assert drive(ros, 5)[-1] == 0.0
    ros.bus.publish("/tf_static", message_type("tf2_msgs/msg/TFMessage")(transforms=[made]), latch=True)
    assert math.isclose(drive(ros, 100)[-1], 2.0, abs_tol=0.05)


DYNAMIC = """
    import rclpy
    from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
    from rclpy.node import Node
    from rclpy.parameter import Parameter
    from rclpy.timer import TimerInfo
    from std_msgs.msg import Float64

    class Controller(Node):
        def __init__(self):
            super().__init__("controller")
            limits = FloatingPointRange(from_value=0.0, to_value=5.0, step=0.5)
            self.declare_parameter("gain", 1.0, ParameterDescriptor(description="P", floating_point_range=[limits]))
            self.declare_parameter("frame", "base", ParameterDescriptor(read_only=True))
            self.declare_parameter("count", Parameter.Type.INTEGER)
            self.add_on_set_parameters_callback(self.check)
            self.add_post_set_parameters_callback(self.applied)
            self.gain, self.late, self.results = 1.0, [], []
            self.pub = self.create_publisher(Float64, "out", 1)
            self.create_timer(0.1, self.tick)
            self.guard = self.create_guard_condition(lambda: self.results.append("guard"))

        def check(self, parameters):
            return SetParametersResult(successful=all(p.value != 3.0 for p in parameters), reason="three is taken")

        def applied(self, parameters):
            self.gain = self.get_parameter("gain").value

        def tick(self, info: TimerInfo):
            self.late.append(info.actual_call_time.nanoseconds - info.expected_call_time.nanoseconds)
            self.pub.publish(Float64(data=self.gain))
            self.guard.trigger()

    rclpy.init()
    node = Controller()
    for value in (2.5, 2.7, 9.0, 3.0):
        node.results.append(node.set_parameters([Parameter("gain", value=value)])[0].reason.split(" ")[0])
    node.results.append(node.set_parameters([Parameter("frame", value="x")])[0].successful)
    try:
        node.get_parameter("count")
    except rclpy.exceptions.ParameterUninitializedException as error:
        node.results.append(str(error))
    names = node.list_parameters([], 0).names
    rclpy.spin(node)
"""


def test_parameters_change_within_their_descriptors_and_by_service(start: Start) -> None:
    ros = start(DYNAMIC)
    events = heard(ros, "/parameter_events")
    node = ros.namespace["node"]
    assert node.results[:5] == ["", "The", "Parameter", "three", False]
    assert node.results[5] == "The parameter is not initialized: count"
    assert ros.namespace["names"] == ["count", "frame", "gain", "use_sim_time"]
    ros.step(0.1)
    assert ros.bus.latest("/out").data == 2.5
    assert node.results[-1] == "guard"
    set_type, value = (
        message_type("rcl_interfaces/srv/SetParameters"),
        message_type("rcl_interfaces/msg/Parameter"),
    )
    wanted = value(name="gain")
    wanted.value.type, wanted.value.double_value = 3, 4.0
    assert (
        ros.bus.call("/controller/set_parameters", set_type.Request(parameters=[wanted]))
        .response.results[0]
        .successful
    )
    ros.step(0.1)
    assert ros.bus.latest("/out").data == 4.0
    assert [p.name for p in events[-1].changed_parameters] == ["gain"]
    assert node.late == [0, 0]


@pytest.mark.parametrize("exclusive", [True, False])
def test_only_reentrant_groups_overlap(start: Start, exclusive: bool) -> None:
    kind = "MutuallyExclusiveCallbackGroup" if exclusive else "ReentrantCallbackGroup"
    ros = start(f"""
        import time
        import rclpy
        from rclpy.callback_groups import {kind}
        from rclpy.executors import MultiThreadedExecutor
        from std_msgs.msg import Int32
        rclpy.init()
        node = rclpy.create_node("n")
        running, most = [0], [0]
        def work(message):
            running[0] += 1
            most[0] = max(most[0], running[0])
            time.sleep(0.3)
            running[0] -= 1
        node.create_subscription(Int32, "job", work, 10, callback_group={kind}())
        executor = MultiThreadedExecutor()
        executor.add_node(node)
        executor.spin()
    """)
    for number in range(3):
        ros.bus.publish("/job", message_type("std_msgs/msg/Int32")(data=number))
    ros.step(2.0)
    assert ros.namespace["most"] == [1 if exclusive else 3]
    assert ros.namespace["running"] == [0]


def test_a_custom_callback_group_decides_when_a_callback_runs(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.callback_groups import CallbackGroup
        class Thrifty(CallbackGroup):
            tokens = 3
            def can_execute(self, entity):
                return self.tokens > 0
            def beginning_execution(self, entity):
                self.tokens -= 1
                return True
            def ending_execution(self, entity):
                pass
        rclpy.init()
        node = rclpy.create_node("n")
        calls = []
        node.create_timer(0.1, lambda: calls.append(1), callback_group=Thrifty())
        rclpy.spin(node)
    """)
    ros.step(2.0)
    assert len(ros.namespace["calls"]) == 3
