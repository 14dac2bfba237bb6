"""A rospy node that unregisters its last subscriber of a topic is disconnected, and connected anew by the next one."""

from __future__ import annotations

from tests.plugin.ros.conftest import Start


def test_new_subscriber_gets_the_latched_message_again(
    start: Start,
) -> None:
    publisher = """
        import rospy
        from std_msgs.msg import Float64
        rospy.init_node("source")
        out = rospy.Publisher("/map", Float64, latch=True, queue_size=1)
        out.publish(2.0)
        rospy.spin()
    """
    ros = start(publisher)
    start(
        """
        import rospy
        from std_msgs.msg import Float64
        rospy.init_node("reader")
        found = [rospy.wait_for_message("/map", Float64, timeout=1.0).data for _ in range(3)]
        take = lambda message: found.append(message.data)
        first, second = (rospy.Subscriber("/map", Float64, take) for _ in range(2))
        rospy.sleep(0.1)
        first.unregister()
        first.unregister()
        again = rospy.Subscriber("/map", Float64, lambda message: found.append(-message.data))
        rospy.sleep(0.1)
        rospy.spin()
        """,
        ros=ros,
        name="reader.py",
    )
    ros.step(5.0)
    # the node stays connected by the second subscriber, so the third one gets no latched message
    assert ros.namespace["found"] == [2.0] * 5


LISTENER = """
    import rospy
    from std_msgs.msg import Float64
    rospy.init_node("source")
    log = []
    class Listener(rospy.SubscribeListener):
        def peer_subscribe(self, name, publish, to_peer):
            log.append(("joined", name, out.get_num_connections()))
        def peer_unsubscribe(self, name, count):
            log.append(("left", name, count))
    out = rospy.Publisher("/out", Float64, subscriber_listener=Listener(), queue_size=1)
    rospy.spin()
"""
READER = """
    import rospy
    from std_msgs.msg import Float64
    rospy.init_node("reader")
    first, second = (rospy.Subscriber("/out", Float64) for _ in range(2))
    rospy.sleep(1.0)
    first.unregister()
    rospy.sleep(1.0)
    second.unregister()
    rospy.sleep(1.0)
    third = rospy.Subscriber("/out", Float64)
    rospy.sleep(1.0)
    {end}
"""


def test_publisher_notices_connections(start: Start) -> None:
    for end, last in (("rospy.spin()", []), ("", [("left", "/out", 0)])):
        ros = start(LISTENER)
        log = ros.namespace["log"]
        start(READER.format(end=end), ros=ros, name="reader.py")
        ros.step(1.5)
        assert log == [("joined", "/out", 2)]  # the simulated world counts as a connection, too
        ros.step(1.0)
        assert log[1:] == [("left", "/out", 0)]
        ros.step(3.0)
        assert log[2:] == [("joined", "/out", 2), *last]
