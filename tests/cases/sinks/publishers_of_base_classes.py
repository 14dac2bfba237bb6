"""A base class outside the files publishes on the topic in its first argument."""

import rospy
from panels import Panel
from std_msgs.msg import Bool, Float64


class Wide(Panel):
    def show(self, text):
        self.pub.publish(text)  # sink ~door


class Named(Panel):
    def __init__(self):
        super().__init__("~named", size=3)

    def show(self, value):
        self.pub.publish(value)  # sink level


class Shy(Panel):
    def show(self, text):
        self.pub.publish(text)  # clean


def on_door(msg):
    wide.show("open" if msg.data else "shut")


def on_level(msg):
    named.show(msg.data)


rospy.init_node("panels")
wide, named, shy = Wide("~wide"), Named(), Shy("~shy")
shy.show("ready")
rospy.Subscriber("door", Bool, on_door)  # source door
rospy.Subscriber("level", Float64, on_level)  # source level
rospy.spin()
