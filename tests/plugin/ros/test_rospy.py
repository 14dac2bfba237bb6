from __future__ import annotations

import sys

import pytest

from pytest_tarl.errors import NodeError, UnsupportedApiError
from pytest_tarl.ros import Ros, message_type
from tests.plugin.ros.conftest import Start, heard

Float64 = message_type("std_msgs/Float64")
String = message_type("std_msgs/String")
TRAVELLER = """
    import rospy
    from nav_msgs.msg import Odometry
    from std_msgs.msg import Float64

    position = 0.0

    def callback(data):
        global position
        position = data.pose.pose.position.x

    def travel(goal, pub, rate):
        while abs(goal - position) > 0.1 and not rospy.is_shutdown():
            pub.publish(5 * (goal - position))
            rate.sleep()

    if __name__ == "__main__":
        rospy.init_node("traveller")
        rospy.Subscriber("odom", Odometry, callback)
        pub = rospy.Publisher("cmd_vel", Float64, queue_size=1)
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
            travel(10, pub, rate)
            travel(0, pub, rate)
"""


def drive(ros: Ros, steps: int) -> list[float]:
    odometry = message_type("nav_msgs/Odometry")()
    path = []
    for _ in range(steps):
        ros.bus.publish("/odom", odometry)
        ros.step(0.1)
        odometry.pose.pose.position.x += 0.1 * max(-5.0, min(5.0, ros.bus.latest("/cmd_vel").data))
        path.append(odometry.pose.pose.position.x)
    return path


def test_a_script_node_shuttles_between_its_goals(start: Start) -> None:
    path = drive(start(TRAVELLER), 120)
    there = next(step for step, position in enumerate(path) if position > 9.5)
    assert min(path[there:]) < 0.5


def test_two_episodes_are_bitwise_equal(start: Start) -> None:
    assert drive(start(TRAVELLER), 80) == drive(start(TRAVELLER), 80)


def test_topics_are_counted_under_absolute_names(start: Start) -> None:
    ros = start(TRAVELLER)
    drive(ros, 10)
    assert ros.subscribed == {"/odom"}
    assert ros.published["/cmd_vel"] == 11
    assert ros.now == 1.0
    assert ros.alive


def test_node_class_keeps_state_between_callbacks(start: Start) -> None:
    ros = start(
        """
        import rospy
        from geometry_msgs.msg import Twist
        from sensor_msgs.msg import LaserScan

        class Avoider:
            def __init__(self):
                self.nearest = float("inf")
                self.gain = rospy.get_param("~gain", 0.5)
                self.pub = rospy.Publisher("/cmd_vel", Twist, queue_size=10)
                rospy.Subscriber("/scan", LaserScan, self.on_scan)
                rospy.Timer(rospy.Duration(0.5), self.control)

            def on_scan(self, scan):
                self.nearest = min(scan.ranges)

            def control(self, event):
                twist = Twist()
                twist.linear.x = self.gain * self.nearest
                self.pub.publish(twist)

        rospy.init_node("avoider")
        Avoider()
        rospy.spin()
    """,
        parameters={"gain": 2.0},
    )
    commands = heard(ros, "/cmd_vel")
    ros.bus.publish("/scan", message_type("sensor_msgs/LaserScan")(ranges=[3.0, 1.5]))
    ros.step(1.0)
    assert [command.linear.x for command in commands] == [3.0, 3.0]


def test_subscribers_do_not_see_later_changes_by_the_publisher(start: Start) -> None:
    ros = start("""
        import rospy
        from geometry_msgs.msg import Twist
        got = []
        rospy.init_node("keeper")
        rospy.Subscriber("twist", Twist, got.append)
        rospy.spin()
    """)
    twist = message_type("geometry_msgs/Twist")()
    ros.bus.publish("twist", twist)
    twist.linear.x = 9.0
    assert ros.namespace["got"][0].linear.x == 0.0


def test_publish_accepts_a_message_or_fields(start: Start) -> None:
    ros = Ros()
    said = heard(ros, "/x")
    with ros.installed():
        start(
            """
            import rospy
            from std_msgs.msg import Float64
            rospy.init_node("talker")
            pub = rospy.Publisher("x", Float64, queue_size=1)
            pub.publish(5.0)
            pub.publish(data=6.0)
            pub.publish(Float64(7.0))
            pub.publish(8)
            rospy.spin()
        """,
            ros=ros,
        )
        ros.close()
    assert [message.data for message in said] == [5.0, 6.0, 7.0, 8.0]


def test_publishing_a_value_of_the_wrong_type_is_an_error(start: Start) -> None:
    with pytest.raises(NodeError, match=r"'/talker' raised ROSSerializationException.*node.py, line 5"):
        start("""
            import rospy
            from std_msgs.msg import Int32
            rospy.init_node("talker")
            rospy.Publisher("x", Int32, queue_size=1).publish(1.5)
        """)


def test_names_are_resolved_with_namespace_private_and_remapped(start: Start) -> None:
    ros = start(
        """
        import rospy
        from std_msgs.msg import String
        rospy.init_node("talker")
        for name in ("a", "/b", "~c", "old"):
            rospy.Publisher(name, String, queue_size=1).publish(rospy.get_name())
        rospy.spin()
    """,
        argv=("old:=new", "__ns:=robot", "__name:=other"),
    )
    assert sorted(ros.published) == ["/b", "/robot/a", "/robot/new", "/robot/other/c"]
    assert ros.bus.latest("/b").data == "/robot/other"


def test_parameters_come_from_test_command_line_and_set_param(start: Start) -> None:
    ros = start(
        """
        import rospy
        rospy.init_node("n")
        rospy.set_param("~own/deep", [1, 2])
        found = (rospy.get_param("~kp"), rospy.get_param("kp"), rospy.get_param("~cli"), rospy.get_param("~own"),
                 rospy.get_param("absent", 7), rospy.has_param("absent"), rospy.search_param("kp"))
        try:
            rospy.get_param("absent")
        except KeyError as error:
            missing = error.args[0]
        rospy.spin()
    """,
        parameters={"kp": 2.5},
        argv=("_cli:=3",),
    )
    assert ros.namespace["found"] == (2.5, 2.5, 3, {"deep": [1, 2]}, 7, False, "/n/kp")
    assert ros.namespace["missing"] == "absent"


def test_sleep_rate_and_time_follow_the_virtual_clock(start: Start) -> None:
    ros = start("""
        import time
        import rospy
        rospy.init_node("clock")
        seen = []
        rate = rospy.Rate(4)
        rospy.sleep(1)
        seen.append(rospy.get_time())
        rospy.sleep(rospy.Duration(0.5))
        seen.append(rospy.Time.now().to_sec())
        time.sleep(0.5)
        seen.append(time.time())
        rate.sleep(), rate.sleep()
        seen.append((rospy.Time.now() - rospy.Time(1)).to_sec())
        rospy.spin()
    """)
    ros.step(10)
    assert ros.namespace["seen"] == [1.0, 1.5, 2.0, 1.25]


def test_wait_for_message_returns_or_times_out(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import String
        rospy.init_node("waiter")
        first = rospy.wait_for_message("word", String).data
        try:
            rospy.wait_for_message("word", String, timeout=2.0)
        except rospy.ROSException as error:
            late = (rospy.get_time(), str(error))
        rospy.spin()
    """)
    ros.step(1.0)
    ros.bus.publish("/word", String("hello"))
    ros.step(5.0)
    assert ros.namespace["first"] == "hello"
    assert ros.namespace["late"][0] == 3.0
    assert "timeout exceeded while waiting for message on topic /word" in ros.namespace["late"][1]


def test_sleeping_callback_does_not_block_the_test(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import String
        done = []
        def slow(message):
            rospy.sleep(1.0)
            done.append((message.data, rospy.get_time()))
        rospy.init_node("slow")
        rospy.Subscriber("word", String, slow, queue_size=1)
        rospy.spin()
    """)
    for word in "abc":
        ros.bus.publish("word", String(word))
    assert ros.namespace["done"] == []
    ros.step(5.0)
    assert ros.namespace["done"] == [("a", 1.0), ("c", 2.0)]


def test_nodes_receive_messages_in_the_order_of_publication(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import Float64
        rospy.init_node("doubler")
        pub = rospy.Publisher("double", Float64, queue_size=1)
        rospy.Subscriber("single", Float64, lambda message, factor: pub.publish(message.data * factor), 2.0)
        rospy.spin()
    """)
    start(
        """
        import rospy
        from std_msgs.msg import Float64
        rospy.init_node("counter")
        got = []
        rospy.Subscriber("double", Float64, lambda message: got.append(message.data))
        pub = rospy.Publisher("single", Float64, queue_size=1)
        for number in (1, 2, 3):
            pub.publish(number)
        still_empty = not got
        rospy.spin()
    """,
        ros=ros,
    )
    assert ros.namespace["still_empty"]
    assert ros.namespace["got"] == [2.0, 4.0, 6.0]


def test_observers_get_messages_before_subscribers_and_also_without_subscribers(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import String
        rospy.init_node("n")
        order = []
        rospy.Subscriber("heard", String, lambda message: order.append("node"))
        rospy.spin()
    """)
    order = ros.namespace["order"]
    ros.on_delivery(lambda topic, message: order.append((topic, message.data)))
    ros.bus.publish("heard", String("x"))
    ros.bus.publish("unheard", String("y"))
    assert order == [("/heard", "x"), "node", ("/unheard", "y")]


def test_latched_messages_reach_later_subscribers(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import String
        rospy.init_node("map")
        rospy.Publisher("map", String, queue_size=1, latch=True).publish("here")
        rospy.spin()
    """)
    ros.bus.publish("/world_map", String("there"), latch=True)
    start(
        """
        import rospy
        from std_msgs.msg import String
        rospy.init_node("reader")
        got = [rospy.wait_for_message("map", String, 1).data, rospy.wait_for_message("world_map", String, 1).data]
        rospy.spin()
    """,
        ros=ros,
    )
    assert ros.namespace["got"] == ["here", "there"]


def test_services_are_called_across_nodes(start: Start) -> None:
    ros = start("""
        import rospy
        from std_srvs.srv import SetBool, SetBoolResponse
        rospy.init_node("server")
        def handle(request):
            rospy.sleep(0.5)
            return SetBoolResponse(success=request.data, message="done")
        rospy.sleep(1.0)
        rospy.Service("switch", SetBool, handle)
        rospy.spin()
    """)
    start(
        """
        import rospy
        from std_srvs.srv import SetBool
        rospy.init_node("client")
        rospy.wait_for_service("switch")
        answer = rospy.ServiceProxy("switch", SetBool)(True)
        when = rospy.get_time()
        rospy.spin()
    """,
        ros=ros,
    )
    ros.step(3.0)
    assert (ros.namespace["answer"].success, ros.namespace["answer"].message) == (True, "done")
    assert ros.namespace["when"] == 1.5


def test_episodes_leave_nothing_in_the_interpreter(start: Start) -> None:
    import threading
    import time

    before = (
        {**sys.modules},
        list(sys.meta_path),
        time.sleep,
        threading.Lock,
        threading.Thread.start,
        sys.argv,
    )
    ros = Ros()
    with ros.installed():
        start(TRAVELLER, ros=ros)
        assert "rospy" in sys.modules
        assert "nav_msgs.msg" in sys.modules
        ros.close()
    after = (
        dict(sys.modules),
        list(sys.meta_path),
        time.sleep,
        threading.Lock,
        threading.Thread.start,
        sys.argv,
    )
    assert {name for name in after[0] if name.partition(".")[0] in ("rospy", "nav_msgs", "std_msgs")} == set()
    assert after[1:] == before[1:]


def test_modules_imported_before_are_restored(monkeypatch: pytest.MonkeyPatch, start: Start) -> None:
    own = type(sys)("rospy")
    monkeypatch.setitem(sys.modules, "rospy", own)
    ros = Ros()
    with ros.installed():
        start(TRAVELLER, ros=ros)
        assert sys.modules["rospy"] is not own
        ros.close()
    assert sys.modules["rospy"] is own


def test_rospy_outside_of_a_node_is_an_error() -> None:
    ros = Ros()
    with ros.installed():
        import rospy

        with pytest.raises(UnsupportedApiError, match=r"rospy\.sleep was called outside a node"):
            rospy.sleep(1)


def test_threads_run_on_the_virtual_clock(start: Start) -> None:
    ros = start("""
        import queue, threading, time
        import rospy
        rospy.init_node("threads")
        lock, box, log = threading.Lock(), queue.Queue(), []
        def produce():
            with lock:
                time.sleep(1.0)
                box.put("item")
        worker = threading.Thread(target=produce, daemon=True)
        worker.start()
        time.sleep(0.5)
        with lock:
            log.append(rospy.get_time())
        log.append(box.get(timeout=5))
        try:
            box.get(timeout=2)
        except queue.Empty:
            log.append(rospy.get_time())
        worker.join()
        log.append(worker.is_alive())
        rospy.spin()
    """)
    ros.step(10.0)
    assert ros.namespace["log"] == [1.0, "item", 3.0, False]


def test_libraries_imported_by_a_node_keep_real_locks(start: Start) -> None:
    import _thread

    ros = start(
        """
        import sys, threading
        sys.modules.pop("concurrent.futures.thread", None)
        import concurrent.futures.thread as library
        own, theirs = type(threading.Lock()), type(library._global_shutdown_lock)
    """
    )
    assert ros.namespace["theirs"] is _thread.LockType
    assert ros.namespace["own"] is not _thread.LockType


def test_unset_stamps_become_the_virtual_time(start: Start) -> None:
    ros = start("""
        import rospy
        from sensor_msgs.msg import Range
        rospy.init_node("n")
        stamps = []
        rospy.Subscriber("range", Range, lambda message: stamps.append(message.header.stamp))
        rospy.spin()
    """)
    reading = message_type("sensor_msgs/Range")()
    ros.step(1.5)
    ros.bus.publish("range", reading)
    reading.header.stamp.secs = 7
    ros.bus.publish("range", reading)
    assert [stamp.to_sec() for stamp in ros.namespace["stamps"]] == [1.5, 7.0]


def test_message_filters_synchronise_messages_with_equal_stamps(start: Start) -> None:
    ros = start("""
        import message_filters
        import rospy
        from sensor_msgs.msg import Range
        rospy.init_node("n")
        pairs = []
        near, far = (message_filters.Subscriber(name, Range) for name in ("near", "far"))
        both = message_filters.ApproximateTimeSynchronizer([near, far], queue_size=5, slop=0.05)
        both.registerCallback(lambda one, other: pairs.append((one.range, other.range)))
        rospy.spin()
    """)
    make = message_type("sensor_msgs/Range")
    for topic, distance in (("near", 1.0), ("far", 2.0), ("near", 3.0)):
        ros.bus.publish(topic, make(range=distance))
        ros.step(0.04)
    ros.step(1.0)
    ros.bus.publish("far", make(range=4.0))
    assert ros.namespace["pairs"] == [(1.0, 2.0)]


def test_transformations_convert_quaternions_to_angles_and_back(start: Start) -> None:
    ros = start("""
        from tf.transformations import euler_from_quaternion, quaternion_from_euler
        angles = euler_from_quaternion(quaternion_from_euler(0.1, -0.7, 2.5))
    """)
    assert ros.namespace["angles"] == pytest.approx((0.1, -0.7, 2.5))


def test_messages_name_their_publisher_in_the_connection_header(start: Start) -> None:
    talker = """
        import rospy
        from std_msgs.msg import String
        out = rospy.Publisher("/chatter", String, queue_size=1, latch=True, headers={"cookies": "oreo"})
        rospy.init_node("talker")
        out.publish("a")
        rospy.spin()
    """
    listener = """
        import rospy
        from std_msgs.msg import String
        heard = []
        out = rospy.Publisher("/chatter", String, queue_size=1)
        def hear(message):
            header = message._connection_header
            heard.append((message.data, header["callerid"], header.get("cookies"), header["topic"], header["latching"]))
        rospy.Subscriber("/chatter", String, hear)
        rospy.init_node("listener")
        out.publish("b")
        rospy.spin()
    """
    ros = start(talker)
    start(listener, ros=ros)
    namespace = ros.namespace  # type: ignore[attr-defined]
    ros.step(0.1)
    ros.bus.publish("/chatter", message_type("std_msgs/String")("c"))
    ros.step(0.1)
    assert namespace["heard"] == [
        ("a", "/talker", "oreo", "/chatter", "1"),
        ("b", "/listener", None, "/chatter", "0"),
        ("c", "/world", None, "/chatter", "0"),
    ]


def test_any_type_subscriber_learns_the_type(start: Start) -> None:
    ros = start("""
        import roslib.message, rospy
        heard = []
        def hear(message):
            kind = roslib.message.get_message_class(message._connection_header["type"])
            heard.append(kind().deserialize(message._buff).data)
        rospy.init_node("listener")
        rospy.Subscriber("/any", rospy.AnyMsg, hear)
        rospy.spin()
    """)
    ros.bus.publish("/any", message_type("std_msgs/Float64")(1.5))
    ros.bus.publish("/any", message_type("std_msgs/String")("a"))
    assert ros.namespace["heard"] == [1.5, "a"]  # type: ignore[attr-defined]
