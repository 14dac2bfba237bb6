import rospy
from std_msgs.msg import Float64

done = rospy.Publisher("done", Float64, queue_size=1)
said = rospy.Publisher("said", Float64, queue_size=1)
sure = rospy.Publisher("sure", Float64, queue_size=1)
first = rospy.Publisher("first", Float64, queue_size=1)
last = rospy.Publisher("last", Float64, queue_size=1)


class Malformed(Exception):
    pass


def check(msg):
    if len(msg.data) != 3:
        raise Malformed
    return msg.data


def read(msg):
    return check(msg)


def on_scan(msg):
    first.publish(1.0)  # clean
    read(msg)
    done.publish(1.0)  # sink ~scan


def on_pose(msg):
    try:
        check(msg)
    except Malformed:
        said.publish(1.0)  # sink ~pose
    sure.publish(1.0)  # clean


def on_odom(msg):
    assert_positive(msg.data)
    last.publish(1.0)  # clean


def assert_positive(x):
    assert x > 0


rospy.Subscriber("scan", Float64, on_scan)  # source scan
rospy.Subscriber("pose", Float64, on_pose)  # source pose
rospy.Subscriber("odom", Float64, on_odom)  # source odom
rospy.spin()
