"""Each function and method of ROS in the catalog has an exact test here."""

from __future__ import annotations

from textwrap import dedent

import pytest

from tarl_lint import catalog
from tarl_lint.settings.config import Config
from tests.lint.models.marked import differing, flows

HEAD = """\
import actionlib, actionlib.simple_action_server, asyncio, copy, functools, image_transport, message_filters
import multiprocessing
import rclpy, rclpy.action, rclpy.action.server, rclpy.wait_for_message
import rospy, rospy.client, rospy.topics, threading
from std_msgs.msg import Float64

out = rospy.Publisher("out", Float64, queue_size=1)
node = rclpy.create_node("node")
last = 0.0

def on_last(msg):
    global last
    last = msg.data

rospy.Subscriber("last", Float64, on_last)
"""
SPIN = "\nrospy.spin()\n"

FUNCTIONS: dict[tuple[str, ...], str] = {
    ("rospy.Subscriber", "rospy.topics.Subscriber"): """
        def on(msg, extra):
            out.publish(msg.data)  # data
            out.publish(extra)  # clean
        NAME("in", Float64, on, 1.0)
        NAME("other", Float64, callback=lambda msg: out.publish(msg.data))  # data
    """,
    ("py_trees_ros.subscribers.ToBlackboard", "py_trees_ros.subscribers.Handler"): """
        import py_trees, py_trees_ros
        NAME("near", "in", Float64, 1, {"near": "data"})
        rospy.Timer(1.0, lambda event: out.publish(py_trees.blackboard.Blackboard.get("near")))  # data
        rospy.Timer(1.0, lambda event: out.publish(py_trees.blackboard.Blackboard.get("far")))  # clean
    """,
    ("py_trees_ros.battery.ToBlackboard",): """
        import py_trees, py_trees_ros
        NAME("level", "in", 1, threshold=30.0)
        rospy.Timer(1.0, lambda event: out.publish(py_trees.blackboard.Blackboard.get("battery").voltage))  # data
        rospy.Timer(1.0, lambda event: out.publish(py_trees.blackboard.Blackboard.get("far")))  # clean
    """,
    ("py_trees_ros.subscribers.CheckData",): """
        import py_trees, py_trees_ros
        class Tell(py_trees.behaviour.Behaviour):
            def update(self):
                out.publish(1.0)  # control
        check = NAME("check", "in", Float64, 1, "data", 1.0)
        root = py_trees.composites.Sequence("root", False, children=[check, Tell("tell")])
    """,
    ("smach_ros.MonitorState",): """
        import smach_ros
        def low(userdata, msg):
            out.publish(msg.data)  # data
            return msg.data > 1.0
        NAME("in", Float64, low)
        NAME("other", Float64, cond_cb=lambda userdata, msg: out.publish(msg.data))  # data
        NAME("third", Float64, lambda userdata, msg: out.publish(1.0))  # clean
    """,
    ("rospy.Publisher", "rospy.topics.Publisher"): """
        made = NAME("made", Float64)
        rospy.Subscriber("in", Float64, lambda msg: made.publish(msg.data))  # data
        rospy.Subscriber("in", Float64, lambda msg: made.publish(1.0))  # clean
    """,
    ("rospy.wait_for_message", "rospy.client.wait_for_message"): """
        out.publish(NAME("in", Float64).data)  # data
        out.publish(Float64().data)  # clean
    """,
    ("rclpy.wait_for_message.wait_for_message",): """
        out.publish(NAME(Float64, node, "in"))  # data
        out.publish(node)  # clean
    """,
    ("rospy.Timer",): """
        def tick(event):
            out.publish(last)  # data
            out.publish(event.current_real)  # clean
        NAME(rospy.Duration(1.0), tick)
        NAME(rospy.Duration(1.0), callback=lambda event: out.publish(last))  # data
    """,
    ("image_transport.Publisher",): """
        made = NAME("image")
        rospy.Subscriber("in", Float64, lambda msg: made.publish(msg.data))  # data
        rospy.Subscriber("in", Float64, lambda msg: made.publish(1.0))  # clean
    """,
    ("image_transport.Subscriber",): """
        NAME("image/compressed", lambda image: out.publish(image))  # data
        NAME("image", callback=lambda image: out.publish(1.0))  # clean
    """,
    ("rospy.on_shutdown",): """
        def ended():
            out.publish(last)  # data
            out.publish(1.0)  # clean
        NAME(ended)
    """,
    ("rospy.Service",): """
        def handle(request):
            out.publish(request.near)  # data
            out.publish(1.0)  # clean
        NAME("near", Near, handle)
    """,
    ("actionlib.SimpleActionServer", "actionlib.simple_action_server.SimpleActionServer"): """
        def execute(goal):
            out.publish(goal.near)  # data
            out.publish(1.0)  # clean
        server = NAME("near", Near, execute_cb=execute)
        out.publish(server.accept_new_goal().near)  # data
    """,
    ("actionlib.ActionServer",): """
        def begin(handle):
            out.publish(handle.get_goal().near)  # data
            out.publish(1.0)  # clean
        NAME("near", Near, begin)
    """,
    ("rclpy.action.ActionServer", "rclpy.action.server.ActionServer"): """
        def execute(handle):
            out.publish(handle.request.near)  # data
            out.publish(1.0)  # clean
        NAME(node, Near, "near", execute)
    """,
    ("message_filters.Subscriber",): """
        def on(msg, extra):
            out.publish(msg.data)  # data
            out.publish(extra)  # clean
        NAME("in", Float64).registerCallback(on, 1.0)
        NAME(node, Float64, "in").registerCallback(lambda msg: out.publish(msg.data))  # data
    """,
    ("message_filters.ApproximateTimeSynchronizer", "message_filters.TimeSynchronizer"): """
        def on(near, far, extra):
            out.publish(near.data)  # data
            out.publish(far.data)  # data
            out.publish(extra)  # clean
        parts = [message_filters.Subscriber(name, Float64) for name in ("near", "far")]
        near, far = message_filters.Subscriber("near", Float64), message_filters.Subscriber("far", Float64)
        NAME([near, far], 10).registerCallback(on, 1.0)
    """,
    ("message_filters.Cache",): """
        NAME(message_filters.Subscriber("in", Float64), 9).registerCallback(lambda msg: out.publish(msg.data))  # data
    """,
    ("threading.Thread", "multiprocessing.Process"): """
        def work(factor):
            out.publish(last)  # data
            out.publish(factor)  # clean
        NAME(target=work, args=(2.0,)).start()
    """,
    ("threading.Timer",): """
        def work(factor):
            out.publish(last)  # data
            out.publish(factor)  # clean
        NAME(1.0, work, [2.0]).start()
    """,
    ("functools.partial",): """
        def on(msg):
            near = NAME(lambda a, b: a, msg.data)
            far = NAME(lambda a, b: b, msg.data)
            out.publish(near(0.0))  # data
            out.publish(far(0.0))  # clean
            out.publish(NAME(lambda a, b: b, b=msg.data)(0.0))  # data
        rospy.Subscriber("in", Float64, on)
    """,
    ("copy.copy", "copy.deepcopy"): """
        def on(msg):
            kept = [msg.data, 0.0]
            made = NAME(kept)
            kept[1] = msg.data
            out.publish(made[0])  # data
            out.publish(made[1])  # clean
        rospy.Subscriber("in", Float64, on)
    """,
    ("rospy.get_param", "rospy.get_param_cached"): """
        def on(msg):
            out.publish(NAME("~near", msg.data))  # data
            out.publish(NAME("~far", 1.0))  # clean
            out.publish(NAME("~far"))  # clean
        rospy.Subscriber("in", Float64, on)
    """,
}
METHODS: dict[tuple[str, ...], str] = {
    ("create_subscription",): """
        def on(msg):
            out.publish(msg.data)  # data
            out.publish(1.0)  # clean
        node.NAME(Float64, "in", on, 10)
        node.NAME(Float64, "in", callback=lambda msg: out.publish(msg.data), qos_profile=10)  # data
    """,
    ("create_publisher", "create_lifecycle_publisher"): """
        made = node.NAME(Float64, "made", 10)
        rospy.Subscriber("in", Float64, lambda msg: made.publish(msg.data))  # data
        rospy.Subscriber("in", Float64, lambda msg: made.publish(1.0))  # clean
    """,
    ("advertise",): """
        made = node.NAME("made", Float64)
        rospy.Subscriber("in", Float64, lambda msg: made.publish(msg.data))  # data
        rospy.Subscriber("in", Float64, lambda msg: made.publish(1.0))  # clean
    """,
    ("create_timer",): """
        def tick():
            out.publish(last)  # data
            out.publish(1.0)  # clean
        node.NAME(0.1, tick)
    """,
    ("create_service",): """
        def handle(request, response):
            out.publish(request.near)  # data
            out.publish(response.near)  # clean
            return response
        node.NAME(Near, "near", handle)
    """,
    ("add_done_callback",): """
        def on(msg):
            future = asyncio.Future()
            future.set_result(msg.data)
            future.NAME(lambda future: out.publish(future.result()))  # data
            other = asyncio.Future()
            other.set_result(1.0)
            other.NAME(lambda future: out.publish(future.result()))  # clean
        rospy.Subscriber("in", Float64, on)
    """,
    ("add_on_set_parameters_callback",): """
        def changed(parameters):
            out.publish(last)  # data
            out.publish(parameters[0].value)  # clean
        node.NAME(changed)
    """,
    ("declare_parameter", "get_parameter"): """
        def on(msg):
            out.publish(node.declare_parameter("near", msg.data).value)  # data
            out.publish(node.declare_parameter("far", 1.0).value)  # clean
            out.publish(node.get_parameter("near").value)  # data
            out.publish(node.get_parameter("far").value)  # clean
        rospy.Subscriber("in", Float64, on)
    """,
    ("declare_parameters",): """
        def on(msg):
            node.NAME("", [("near", msg.data), ("far", 1.0)])
            out.publish(node.get_parameter("near").value)  # data
            out.publish(node.get_parameter("far").value)  # clean
            both = node.NAME("inner", [("near", 1.0), ("far", msg.data)])
            out.publish(both[1].value)  # data
            out.publish(both[0].value)  # clean
            out.publish(node.get_parameter("inner.far").value)  # data
        rospy.Subscriber("in", Float64, on)
    """,
    ("get_parameter_or",): """
        def on(msg):
            out.publish(node.NAME("near", msg.data))  # data
            out.publish(node.NAME("far", 1.0))  # clean
        rospy.Subscriber("in", Float64, on)
    """,
    (
        *("lookupTransform", "lookupTransformFull", "lookupTwist"),
        *("lookup_transform", "lookup_transform_core", "lookup_transform_full"),
        *("lookup_transform_async", "lookup_transform_full_async"),
        *(
            "asMatrix",
            "canTransform",
            "canTransformFull",
            "can_transform",
            "can_transform_full",
            "frameExists",
        ),
        *(
            "getLatestCommonTime",
            "get_latest_common_time",
            "lookupTwistFull",
            "transformPoint",
            "transformPose",
        ),
        *("transformPointCloud", "transformPointStamped", "transformQuaternion", "transformVector3"),
        *("transform_full", "waitForTransform", "waitForTransformFull"),
    ): """
        def on(msg):
            out.publish(node.buffer.NAME(msg.frame, "base"))  # data
            out.publish(node.buffer.NAME("map", "base"))  # clean
        rospy.Subscriber("in", Float64, on)
    """,
    ("registerCallback",): """
        def on(msg):
            out.publish(msg.data)  # data
            out.publish(1.0)  # clean
        message_filters.Subscriber("in", Float64).NAME(on)
    """,
}
TABLES = {"functions": FUNCTIONS, "methods": METHODS}
COVERED = [(name, body) for table in TABLES.values() for names, body in table.items() for name in names]


@pytest.mark.parametrize(("table", "facts"), [("functions", catalog.FUNCTIONS), ("methods", catalog.METHODS)])
def test_each_entry_of_the_catalog_has_a_test(table, facts):
    assert sorted(name for names in TABLES[table] for name in names) == sorted(facts)


@pytest.mark.parametrize(("name", "body"), COVERED, ids=[name for name, _ in COVERED])
def test_only_data_of_messages_reaches_sinks(name, body):
    assert differing(f"{HEAD}{dedent(body.replace('NAME', name))}{SPIN}") == {}


@pytest.mark.parametrize(
    "call", ["node.destroy_subscription(sub)", "node.destroy_timer(sub)", "sub.unregister()"]
)
def test_destroyed_endpoints_do_not_affect_findings(call):
    text = f"""
        sub = node.create_subscription(Float64, "other", print, 10)
        def on(msg):
            global sub
            if msg.data > 0.0:
                {call}
                sub = None
        rospy.Subscriber("in", Float64, on)
        while node.get_topic_names_and_types():
            out.publish(len(node.get_topic_names_and_types()))  # clean
    """
    assert differing(HEAD + dedent(text) + SPIN) == {}


def test_images_are_received_and_published_through_image_transport():
    text = HEAD + dedent("""
        from image_transport_py import ImageTransport
        images = ImageTransport("images", image_transport="raw")
        made, camera = images.advertise("made", 10), images.advertise_camera("camera", 10)
        def on_image(image):
            made.publish(image)  # data
            made.publish(1.0)  # clean
        images.subscribe("image", 10, on_image)
        images.subscribe_camera("left", 10, lambda image, info: camera.publish(image, info))  # data
    """)
    assert differing(text) == {}
    ends = {(one.source.topics, one.sink.topics, one.sink.type) for one in flows(text)}
    assert ends == {
        (("image",), ("made", "made/compressed"), "Image"),
        (("left",), ("camera", "camera/compressed"), "Image"),
    }


def test_with_the_setting_tf2_a_transform_is_a_source():
    text = HEAD + dedent("""
        out.publish(node.buffer.lookup_transform("map", "base").x)  # data
        out.publish(node.buffer.other("map", "base").x)  # clean
        try:
            node.buffer.lookup_transform("map", "base")
            out.publish(1.0)  # control
        except TransformException:
            out.publish(2.0)  # control
        node.buffer.lookup_transform("map", "base")
        out.publish(3.0)  # clean
    """)
    assert differing(text, flows(text, Config(tf2=True))) == {}


LIBRARY = """
    def near(value):
        out.publish(value)  # {passed}
    def on(msg):
        {call}
    rospy.Subscriber("in", Float64, on)
"""


@pytest.mark.parametrize(
    ("call", "passed"),
    [
        ("library.run(near, msg.data)", "data"),
        ("library.run(msg.data, near)", "clean"),
        ("library.run(callback=near, value=msg.data)", "data"),
        ("library.Tool().run(near, msg.data)", "data"),
        *((f"{name.removeprefix('builtins.')}(near, msg.data)", "clean") for name in sorted(catalog.KEEPERS)),
    ],
)
def test_library_may_pass_later_arguments_to_the_callback(call, passed):
    text = HEAD + "import inspect, library\n" + dedent(LIBRARY.format(call=call, passed=passed))
    assert differing(text) == {}
