import rospy
from std_msgs.msg import Float64


def parse(text):
    try:
        value = float(text)
    except (TypeError, ValueError):
        value = -1.0
    else:
        value = 2.0 * value
    finally:
        rospy.logdebug("parsed")
    return value


class Guarded:
    def __init__(self):
        self.last = 0.0
        self.done = 0.0
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("in", Float64, self.on_in)  # source value

    def on_in(self, msg):
        self.pub.publish(parse(msg.data))  # sink value
        self.pub.publish(parse("1.0"))  # clean
        try:
            self.last = msg.data
            self.check()
        finally:
            self.done = 1.0
            self.pub.publish(self.last)  # sink value
        self.pub.publish(self.done)  # clean
        try:
            self.pub.publish(1.0 / msg.data)  # sink value
        except ZeroDivisionError as error:
            rospy.logwarn("%s", error)
            self.pub.publish(0.0)  # clean
        with open("/tmp/log") as file:
            limit = float(file.read())
        self.pub.publish(limit)  # clean

    def check(self):
        rospy.logdebug("checked")


rospy.init_node("guarded")
Guarded()
rospy.spin()
