import rospy
from std_msgs.msg import Float64


class TooHigh(Exception):
    pass


class TooLow(Exception):
    pass


def check(value):
    if value > 10.0:
        raise TooHigh(value)
    return value


def check_twice(value):
    return check(check(value))


def harmless(value):
    return 2.0


def on_level(msg):
    try:
        check(msg.data)
        pub.publish(1.0)  # sink ~level
    except TooHigh:
        pub.publish(2.0)  # sink ~level
    pub.publish(3.0)  # clean
    try:
        check_twice(msg.data)
    except Exception:
        pub.publish(4.0)  # sink ~level
    else:
        pub.publish(5.0)  # sink ~level
    finally:
        pub.publish(6.0)  # clean
    try:
        harmless(msg.data)
        pub.publish(7.0)  # clean
    except TooLow:
        pub.publish(8.0)  # clean
    try:
        assert msg.data > 0.0
        pub.publish(9.0)  # sink ~level
    except AssertionError:
        pub.publish(10.0)  # sink ~level
    try:
        raise TooLow(msg.data)
    except TooLow as error:
        pub.publish(error.args[0])  # sink level
    try:
        check(msg.data)
    except TooHigh as error:
        pub.publish(float(str(error)))  # sink level
    if msg.data < 0.0:
        raise TooLow
    pub.publish(11.0)  # sink ~level


rospy.init_node("exceptions")
pub = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("level", Float64, on_level)  # source level
rospy.spin()
