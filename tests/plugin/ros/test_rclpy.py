from __future__ import annotations

import pytest

from pytest_tarl.errors import NodeError, UnsupportedApiError
from pytest_tarl.ros import message_type
from tests.plugin.ros.conftest import Start, heard

Float64 = message_type("std_msgs/msg/Float64")

FOLLOWER = """
    import rclpy
    from geometry_msgs.msg import Twist
    from rclpy.executors import ExternalShutdownException
    from rclpy.node import Node
    from std_msgs.msg import Float64

    class Follower(Node):
        def __init__(self):
            super().__init__("follower")
            self.declare_parameter("speed", 0.2)
            self.error = 0.0
            self.create_subscription(Float64, "light", self.on_light, 10)
            self.pub = self.create_publisher(Twist, "cmd_vel", 10)
            self.timer = self.create_timer(0.05, self.control)

        def on_light(self, msg):
            self.error = msg.data - 0.5

        def control(self):
            twist = Twist()
            twist.linear.x = self.get_parameter("speed").get_parameter_value().double_value
            twist.angular.z = -2.0 * self.error
            self.pub.publish(twist)

    def main(args=None):
        rclpy.init(args=args)
        node = Follower()
        try:
            rclpy.spin(node)
        except (KeyboardInterrupt, ExternalShutdownException):
            ended.append("external")
        finally:
            node.destroy_node()
            rclpy.try_shutdown()
            ended.append(rclpy.ok())

    ended = []
    main()
"""


def test_a_node_class_with_a_timer_uses_received_messages(start: Start) -> None:
    ros = start(FOLLOWER, parameters={"follower": {"speed": 0.7}})
    commands = heard(ros, "/cmd_vel")
    ros.bus.publish("light", Float64(data=0.75))
    ros.step(0.1)
    assert [(command.linear.x, command.angular.z) for command in commands] == [(0.7, -0.5)] * 2
    assert (ros.subscribed, dict(ros.published)) == ({"/light"}, {"/cmd_vel": 2})


def test_episode_end_ends_spin(start: Start) -> None:
    ros = start(FOLLOWER)
    ros.close()
    assert ros.namespace["ended"] == ["external", False]
    assert ros.shutdown_errors == ()
    assert not ros.alive


def test_spin_once_handles_one_message(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.qos import QoSProfile, ReliabilityPolicy
        from std_msgs.msg import Float64
        rclpy.init()
        node = rclpy.create_node("n")
        got = []
        profile = QoSProfile(depth=2, reliability=ReliabilityPolicy.BEST_EFFORT)
        node.create_subscription(Float64, "x", lambda msg: got.append(msg.data), profile)
        node.get_clock().sleep_for(rclpy.duration.Duration(seconds=1)) if False else None
        import time
        time.sleep(1.0)
        for _ in range(2):
            rclpy.spin_once(node, timeout_sec=0.5)
        counts = [len(got)]
        rclpy.spin_once(node, timeout_sec=0.5)
        counts.append((len(got), node.get_clock().now().nanoseconds))
        rclpy.spin(node)
    """)
    for number in (1.0, 2.0, 3.0):
        ros.bus.publish("x", Float64(data=number))
    ros.step(5.0)
    assert ros.namespace["got"] == [2.0, 3.0]
    assert ros.namespace["counts"] == [2, (2, 1_500_000_000)]


def test_a_late_timer_skips_missed_periods(start: Start) -> None:
    ros = start("""
        import time
        import rclpy
        rclpy.init()
        node = rclpy.create_node("n")
        calls = []
        def tick():
            calls.append(node.get_clock().now().nanoseconds / 1e9)
            if len(calls) == 2:
                time.sleep(0.35)
        timer = node.create_timer(0.1, tick)
        rclpy.spin(node)
    """)
    ros.step(0.8)
    assert ros.namespace["calls"] == [0.1, 0.2, 0.55, 0.6, 0.7, 0.8]


def test_integer_in_a_float_field_fails(start: Start) -> None:
    with pytest.raises(NodeError, match="AssertionError: The 'x' field must be of type 'float'"):
        start("""
            from geometry_msgs.msg import Twist
            import rclpy
            Twist().linear.x = 1
        """)


def test_declared_parameter_keeps_its_type(start: Start) -> None:
    ros = start(
        """
        import rclpy
        from rcl_interfaces.msg import SetParametersResult
        from rclpy.exceptions import ParameterNotDeclaredException
        from rclpy.parameter import Parameter
        rclpy.init()
        node = rclpy.create_node("n")
        node.declare_parameters("", [("gain", 1.0), ("name", "a"), ("limits", [0.0, 1.0])])
        seen = [node.get_parameter(name).value for name in ("gain", "name", "limits")]
        try:
            node.get_parameter("absent")
        except ParameterNotDeclaredException:
            seen.append("undeclared")
        def check(parameters):
            return SetParametersResult(successful=all(p.value > 0 for p in parameters))
        node.add_on_set_parameters_callback(check)
        results = node.set_parameters([Parameter("gain", Parameter.Type.DOUBLE, 3.0), Parameter("gain", value=-1.0),
                                       Parameter("gain", value="text")])
        seen += [result.successful for result in results] + [node.get_parameter("gain").value]
    """,
        parameters={"gain": 2.0},
        argv=("--ros-args", "-p", "n:name:=b", "-p", "other:gain:=9.0"),
    )
    assert ros.namespace["seen"] == [2.0, "b", [0.0, 1.0], "undeclared", True, False, False, 3.0]


def test_override_of_another_type_is_refused(start: Start) -> None:
    with pytest.raises(NodeError, match=r"InvalidParameterTypeException.*'gain'.*expecting type 'DOUBLE'"):
        start(
            """
            import rclpy
            rclpy.init()
            rclpy.create_node("n").declare_parameter("gain", 1.0)
        """,
            parameters={"gain": 2},
        )


def test_names_are_resolved_with_namespace_private_and_remapped(start: Start) -> None:
    ros = start(
        """
        import rclpy
        from std_msgs.msg import Float64
        rclpy.init()
        node = rclpy.create_node("n", namespace="robot")
        for topic in ("a", "/b", "~/c", "old"):
            node.create_publisher(Float64, topic, 1).publish(Float64(data=1.0))
    """,
        argv=("--ros-args", "-r", "old:=/new"),
    )
    assert sorted(ros.published) == ["/b", "/new", "/robot/a", "/robot/n/c"]


def test_a_service_is_called_with_a_future_across_nodes(start: Start) -> None:
    ros = start("""
        import rclpy
        from example_interfaces.srv import AddTwoInts
        rclpy.init()
        node = rclpy.create_node("server")
        def add(request, response):
            response.sum = request.a + request.b
            return response
        node.create_service(AddTwoInts, "add", add)
        rclpy.spin(node)
    """)
    start(
        """
        import rclpy
        from example_interfaces.srv import AddTwoInts
        rclpy.init()
        node = rclpy.create_node("client")
        client = node.create_client(AddTwoInts, "add")
        ready = client.wait_for_service(timeout_sec=1.0)
        future = client.call_async(AddTwoInts.Request(a=2, b=3))
        rclpy.spin_until_future_complete(node, future)
        total = future.result().sum
        lost = node.create_client(AddTwoInts, "lost").wait_for_service(timeout_sec=1.0)
        never = client.call_async(AddTwoInts.Request())
        rclpy.spin(node)
    """,
        ros=ros,
    )
    ros.step(2.0)
    assert (ros.namespace["ready"], ros.namespace["total"], ros.namespace["lost"]) == (True, 5, False)


def test_coroutine_callbacks_await_futures(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.callback_groups import ReentrantCallbackGroup
        from std_srvs.srv import Trigger
        rclpy.init()
        node = rclpy.create_node("n")
        log = []
        def answer(request, response):
            response.message = "yes"
            return response
        node.create_service(Trigger, "ask", answer)
        client = node.create_client(Trigger, "ask")
        async def tick():
            timer.cancel()
            log.append((await client.call_async(Trigger.Request())).message)
        timer = node.create_timer(0.1, tick, callback_group=ReentrantCallbackGroup())
        rclpy.spin(node)
    """)
    ros.step(1.0)
    assert ros.namespace["log"] == ["yes"]


def test_awaiting_in_an_exclusive_group_deadlocks(start: Start) -> None:
    ros = start("""
        import rclpy
        from std_srvs.srv import Trigger
        rclpy.init()
        node = rclpy.create_node("n")
        log = []
        node.create_service(Trigger, "ask", lambda request, response: response)
        client = node.create_client(Trigger, "ask")
        async def tick():
            timer.cancel()
            log.append("asked")
            await client.call_async(Trigger.Request())
            log.append("answered")
        timer = node.create_timer(0.1, tick)
        rclpy.spin(node)
    """)
    ros.step(5.0)
    assert ros.namespace["log"] == ["asked"]


def test_a_multi_threaded_executor_continues_while_a_callback_waits(start: Start) -> None:
    ros = start("""
        import time
        import rclpy
        from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
        from rclpy.executors import MultiThreadedExecutor
        rclpy.init()
        node = rclpy.create_node("n")
        log = []
        def slow():
            log.append("slow")
            time.sleep(0.25)
        node.create_timer(0.1, slow, callback_group=MutuallyExclusiveCallbackGroup())
        node.create_timer(0.1, lambda: log.append("quick"), callback_group=ReentrantCallbackGroup())
        with MultiThreadedExecutor() as executor:
            executor.add_node(node)
            executor.spin()
    """)
    ros.step(0.4)
    assert ros.namespace["log"] == ["slow", "quick", "quick", "quick", "slow", "quick"]


def test_spin_works_beside_a_rate(start: Start) -> None:
    ros = start("""
        import threading
        import rclpy
        from std_msgs.msg import Float64
        rclpy.init()
        node = rclpy.create_node("n")
        heard, said = [], node.create_publisher(Float64, "out", 10)
        node.create_subscription(Float64, "in", lambda msg: heard.append(msg.data), 10)
        threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
        rate = node.create_rate(2)
        try:
            while rclpy.ok():
                said.publish(Float64(data=float(len(heard))))
                rate.sleep()
        except KeyboardInterrupt:
            pass
    """)
    ros.bus.publish("in", Float64(data=1.0))
    ros.step(1.0)
    assert ros.published["/out"] == 3
    assert ros.bus.latest("/out").data == 1.0
    ros.close()
    assert ros.shutdown_errors == ()


def test_a_custom_context_is_the_context_of_the_program(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.executors import SingleThreadedExecutor
        context = rclpy.Context()
        rclpy.init(context=context)
        node = rclpy.create_node("n", context=context)
        down = []
        context.on_shutdown(lambda: down.append(True))
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        node.create_timer(0.1, lambda: rclpy.shutdown(context=context))
        executor.spin()
        state = (context.ok(), rclpy.ok(context=context), down)
    """)
    ros.step(0.2)
    assert ros.namespace["state"] == (False, False, [True])


def test_wait_for_message_needs_no_executor(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.wait_for_message import wait_for_message
        from std_msgs.msg import Float64
        rclpy.init()
        node = rclpy.create_node("n")
        late = wait_for_message(Float64, node, "x", time_to_wait=0.5)
        found, message = wait_for_message(Float64, node, "x")
        rclpy.spin(node)
    """)
    ros.step(0.7)
    ros.bus.publish("x", Float64(data=2.0))
    assert ros.namespace["late"] == (False, None)
    assert (ros.namespace["found"], ros.namespace["message"].data) == (True, 2.0)


def test_nodes_can_query_the_graph(start: Start) -> None:
    ros = start("""
        import rclpy
        from std_msgs.msg import Float64
        from std_srvs.srv import Trigger
        rclpy.init()
        node = rclpy.create_node("talker", namespace="robot")
        node.create_publisher(Float64, "x", 1)
        node.create_service(Trigger, "go", lambda request, response: response)
        seen = (node.get_node_names_and_namespaces(), node.get_topic_names_and_types(),
                node.get_service_names_and_types(), node.count_services("go"),
                node.get_publishers_info_by_topic("x")[0].topic_type,
                node.get_publisher_names_and_types_by_node("talker", "/robot"), node.wait_for_node("/nobody", 0.2))
        rclpy.spin(node)
    """)
    ros.step(0.5)
    assert ros.namespace["seen"] == (
        [("talker", "/robot")], [("/robot/x", ["std_msgs/msg/Float64"])],
        [("/robot/go", ["std_srvs/srv/Trigger"])], 1, "std_msgs/msg/Float64",
        [("/robot/x", ["std_msgs/msg/Float64"])], False,
    )  # fmt: skip


def test_durations_support_arithmetic(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.duration import Duration
        half = Duration(seconds=0.5)
        seen = ((half + half).nanoseconds, (half - half * 3).nanoseconds, half < half * 2)
    """)
    assert ros.namespace["seen"] == (1_000_000_000, -1_000_000_000, True)


def test_transient_local_reaches_later_subscribers_and_volatile_does_not(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.qos import DurabilityPolicy, QoSProfile
        from std_msgs.msg import Float64
        rclpy.init()
        node = rclpy.create_node("n")
        kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        node.create_publisher(Float64, "kept", kept).publish(Float64(data=1.0))
        node.create_publisher(Float64, "lost", 1).publish(Float64(data=2.0))
        got = []
        node.create_subscription(Float64, "kept", lambda msg: got.append(msg.data), kept)
        node.create_subscription(Float64, "lost", lambda msg: got.append(msg.data), 1)
        rclpy.spin(node)
    """)
    assert ros.namespace["got"] == [1.0]


def test_time_and_duration_support_arithmetic_and_conversion(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.duration import Duration
        from rclpy.time import Time
        rclpy.init()
        node = rclpy.create_node("n")
        before = node.get_clock().now()
        node.get_clock().sleep_for(Duration(seconds=1.25))
        now = node.get_clock().now()
        values = [(now - before).nanoseconds, now > before, now.to_msg().nanosec, Time.from_msg(now.to_msg()) == now,
                  (now + Duration(nanoseconds=5)).seconds_nanoseconds()]
        try:
            now < Time()
        except TypeError as error:
            values.append(str(error))
        rclpy.spin(node)
    """)
    ros.step(2.0)
    assert ros.namespace["values"] == [
        1_250_000_000, True, 250_000_000, True, (1, 250_000_005), "Can't compare times with different clock types",
    ]  # fmt: skip


def test_callback_exception_ends_the_node(start: Start) -> None:
    ros = start(FOLLOWER.replace("self.error = msg.data - 0.5", "self.error = msg.dat - 0.5"))
    with pytest.raises(
        NodeError, match=r"'/follower' raised AttributeError.*node\.py, line \d+, in on_light"
    ):
        ros.bus.publish("light", Float64(data=1.0))


def test_early_use_and_double_shutdown_fail(start: Start) -> None:
    with pytest.raises(NodeError, match="NotInitializedException"):
        start("from rclpy.node import Node; Node('n')")
    with pytest.raises(
        NodeError, match=r"RuntimeError: Context must be initialized before it can be shutdown"
    ):
        start("import rclpy; rclpy.init(); rclpy.shutdown(); rclpy.shutdown()")


@pytest.mark.parametrize(
    ("end", "reported"),
    [("rclpy.shutdown()", ()), ("rclpy.try_shutdown()", ()), ("1 / 0", ("ZeroDivisionError",))],
)
def test_late_shutdown_is_not_a_node_error(start: Start, end: str, reported: tuple[str, ...]) -> None:
    ros = start(f"""
        import rclpy
        rclpy.init()
        try:
            rclpy.spin(rclpy.create_node("n"))
        finally:
            {end}
    """)
    ros.step(0.1)
    ros.close()
    assert tuple(type(one.__cause__).__name__ for one in ros.shutdown_errors) == reported


def test_errors_name_missing_apis(start: Start) -> None:
    make = "import rclpy; rclpy.init(); node = rclpy.create_node('n');"
    for missing, line in {
        r"rclpy\.waitable": "import rclpy.waitable",
        r"rclpy\.type_hash": "from rclpy.type_hash import TypeHash",
        r"Node\.add_waitable": f"{make} node.add_waitable(print)",
    }.items():
        with pytest.raises(UnsupportedApiError, match=missing):
            start(line)


def test_world_can_publish_the_ros1_class(start: Start) -> None:
    ros = start("""
        import rclpy
        from sensor_msgs.msg import LaserScan
        rclpy.init()
        node = rclpy.create_node("n")
        got = []
        node.create_subscription(LaserScan, "scan", got.append, 1)
        rclpy.spin(node)
    """)
    scan = message_type("sensor_msgs/LaserScan")(ranges=[1.0, 2.0])
    scan.header.stamp.secs, scan.header.frame_id = 3, "laser"
    ros.bus.publish("scan", scan)
    (got,) = ros.namespace["got"]
    assert (got.header.stamp.sec, got.header.frame_id, got.ranges.tolist()) == (3, "laser", [1.0, 2.0])


def test_logging_uses_python_and_respects_once_and_throttle(
    start: Start, caplog: pytest.LogCaptureFixture
) -> None:
    ros = start("""
        import rclpy
        rclpy.init()
        node = rclpy.create_node("talker")
        def tick():
            node.get_logger().warn("once", once=True)
            node.get_logger().warn("throttled", throttle_duration_sec=0.25)
        node.create_timer(0.1, tick)
        rclpy.spin(node)
    """)
    ros.step(0.6)
    assert [record.message for record in caplog.records].count("once") == 1
    assert [record.message for record in caplog.records].count("throttled") == 2
    assert {record.name for record in caplog.records} == {"rclpy.talker"}


def test_introspection_has_the_names_of_rclpy(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.qos_overriding_options import QosCallbackResult, QoSOverridingOptions
        from rclpy.service_introspection import ServiceIntrospectionState
        from std_srvs.srv import Empty
        rclpy.init()
        node = rclpy.create_node("node")
        client = node.create_client(Empty, "empty")
        client.configure_introspection(node.get_clock(), 10, ServiceIntrospectionState.METADATA)
        accepted = QosCallbackResult(successful=True)
        try:
            client.configure_introspection(node.get_clock(), 10, "metadata")
        except TypeError as error:
            refused = str(error)
        rclpy.spin(node)
    """)
    namespace = ros.namespace  # type: ignore[attr-defined]
    assert namespace["accepted"].successful
    assert "not a ServiceIntrospectionState" in namespace["refused"]
