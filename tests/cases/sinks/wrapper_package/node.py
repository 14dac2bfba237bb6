import rospy
from std_msgs.msg import Float64, String

from .ros import Bus, Topic


class Node:
    def __init__(self):
        self.bus = Bus("robot")
        self.stored = Topic(self.bus, "stored", Float64)
        self.bus.listen("level", Float64, self.on_level)  # source level
        self.bus.listen("name", String, self.on_name, queue_size=1)  # source name
        self.pub = rospy.Publisher("direct", Float64, queue_size=1)

    def on_level(self, msg):
        self.bus.send("doubled", Float64, data=2 * msg.data)
        self.pub.publish(self.stored.last)  # sink stored
        self.pub.publish(1.0)  # clean

    def on_name(self, msg):
        self.bus.send("echo", String, data=msg.data)


if __name__ == "__main__":
    rospy.init_node("wrapped")
    Node()
    rospy.spin()
