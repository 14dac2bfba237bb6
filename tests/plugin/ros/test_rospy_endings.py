"""How rospy nodes end: with the episode, by returning, by an exception, or because they never wait."""

from __future__ import annotations

import pytest

from pytest_tarl.errors import NodeError, RecordingError, UnsupportedApiError
from pytest_tarl.ros import message_type
from tests.plugin.ros.conftest import Start

String = message_type("std_msgs/String")


def test_episode_end_runs_hooks(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import String
        log = []
        rospy.init_node("n")
        pub = rospy.Publisher("last", String, queue_size=1)
        def stop():
            pub.publish("stopped")
            rospy.sleep(1)
            log.append("hook")
        rospy.on_shutdown(stop)
        try:
            while not rospy.is_shutdown():
                rospy.sleep(1)
        except rospy.ROSInterruptException:
            log.append("interrupted")
        log.append(rospy.is_shutdown())
    """)
    ros.step(0.5)
    ros.close()
    assert ros.namespace["log"] == ["hook", "interrupted", True]
    assert ros.bus.latest("last").data == "stopped"
    assert not ros.alive
    assert ros.shutdown_errors == ()


def test_a_node_that_refuses_to_end_is_killed(start: Start) -> None:
    ros = start("""
        import rospy
        rospy.init_node("stubborn")
        while True:
            try:
                rospy.sleep(1)
            except rospy.ROSInterruptException:
                pass
    """)
    ros.step(3.0)
    ros.close()
    assert not ros.alive


def test_node_that_ignores_shutdown_is_reported(start: Start) -> None:
    ros = start(
        """
        import rospy
        rospy.init_node("hanging")
        rospy.spin()
        while True:
            pass
    """,
        watchdog_limit=0.2,
    )
    start("import rospy; rospy.init_node('other'); rospy.spin(); ended = True", ros=ros)
    with pytest.raises(NodeError, match=r"'/hanging' never waits.*node\.py, line [56]"):
        ros.close()
    assert ros.namespace["ended"]
    assert not ros.alive


def test_returning_main_program_ends_its_node(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import String
        got = []
        rospy.init_node("short")
        rospy.Subscriber("word", String, got.append)
        rospy.Timer(rospy.Duration(0.1), got.append)
        rospy.sleep(0.25)
    """)
    ros.step(1.0)
    ros.bus.publish("word", String("late"))
    assert len(ros.namespace["got"]) == 2
    assert not ros.alive


def test_exception_report_names_the_node_and_the_line(start: Start) -> None:
    ros = start("""
        import rospy
        rospy.init_node("faulty")
        rospy.sleep(1)
        def divide(number):
            return 1 / number
        divide(0)
    """)
    with pytest.raises(
        NodeError, match=r"'/faulty' raised ZeroDivisionError.*node\.py, line 6, in divide"
    ) as caught:
        ros.step(2.0)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    assert ros.now == 1.0


def test_callback_exception_is_raised_at_the_publish(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import String
        rospy.init_node("n")
        rospy.Subscriber("word", String, lambda message: message.dat)
        rospy.spin()
    """)
    with pytest.raises(NodeError, match="AttributeError"):
        ros.bus.publish("word", String("x"))


def test_a_nonzero_exit_status_of_a_node_is_reported(start: Start) -> None:
    start("import sys; sys.exit(0)")
    with pytest.raises(NodeError, match="exited with status 3"):
        start("import sys; sys.exit(3)")


def test_never_waiting_node_is_stopped_with_its_line(start: Start) -> None:
    with pytest.raises(NodeError, match=r"'/busy' never waits.*node\.py, line \d+, in look") as caught:
        start(
            """
            import rospy
            rospy.init_node("busy")
            def look():
                while rospy.get_name() == "/busy":
                    try:
                        rospy.resolve_name("a")
                    except Exception:
                        pass
            look()
        """,
            watchdog_limit=0.2,
        )
    assert "Rate.sleep()" in str(caught.value)


def test_errors_name_missing_apis(start: Start) -> None:
    for missing, line in {
        r"rospy\.get_node_info": "import rospy; rospy.get_node_info()",
        r"rospy\.impl": "import rospy.impl",
        r"rosgraph\.network": "import rosgraph.network",
        r"tf2_kdl\.Stamped": "from tf2_kdl import Stamped",
        r"Spaceship": "import rospy; from std_msgs.msg import Spaceship",
    }.items():
        with pytest.raises(UnsupportedApiError, match=missing):
            start(line)


def test_publishing_another_type_from_the_world_is_an_error(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import Float64
        rospy.init_node("n")
        rospy.Subscriber("x", Float64, print)
        rospy.spin()
    """)
    with pytest.raises(
        RecordingError, match=r"/x carries std_msgs/String.*'/n' subscribes to it as std_msgs/Float64"
    ):
        ros.bus.publish("x", String("text"))
    with pytest.raises(RecordingError, match="is not a ROS message"):
        ros.bus.publish("x", 5.0)


def test_error_in_a_world_callback_is_raised_in_the_test(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import String
        rospy.init_node("n")
        rospy.sleep(1)
        try:
            rospy.Publisher("x", String, queue_size=1).publish("x")
        except Exception:
            caught = True
        rospy.spin()
    """)

    def listener(_: object) -> None:
        raise LookupError("world")

    ros.bus.subscribe("x", listener)
    with pytest.raises(LookupError, match="world"):
        ros.step(2.0)
    assert "caught" not in ros.namespace
