from std_msgs.msg import Int16
from ..params import MAX
from .. import mixing


class Motor:
    def __init__(self, node, side):
        self._pub = node.create_publisher(Int16, "motor/" + side, 1)
        self._trim = node.create_publisher(Int16, "trim", 1)

    def set(self, value):
        self._pub.publish(Int16(data=int(mixing.clip(value, MAX) * 255)))  # sink sonar cmd
        self._trim.publish(Int16(data=MAX))  # clean
