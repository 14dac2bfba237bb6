"""Composition: parts that get the node, talk through an event bus of their own, and share a blackboard."""

from collections import defaultdict
from types import SimpleNamespace

import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, Imu
from std_msgs.msg import Float64, String


class EventBus:
    def __init__(self):
        self._handlers = defaultdict(list)

    def on(self, event, handler):
        self._handlers[event].append(handler)

    def emit(self, event, *args, **kwargs):
        for handler in self._handlers[event]:
            handler(*args, **kwargs)


class Localizer:
    def __init__(self, bus, board):
        self.bus = bus
        self.board = board
        rospy.Subscriber("odom", Odometry, self.on_odom)  # source odom
        rospy.Subscriber("imu", Imu, self.on_imu)  # source imu

    def on_odom(self, msg):
        self.board.x = msg.pose.pose.position.x
        self.bus.emit("moved", self.board.x, source="odom")

    def on_imu(self, msg):
        self.bus.emit("turned", rate=msg.angular_velocity.z)


class Battery:
    def __init__(self, bus, board):
        self.board = board
        rospy.Subscriber("battery", BatteryState, lambda m: setattr(board, "low", m.percentage < 0.2))  # source battery


class Reporter:
    def __init__(self, bus, board):
        self.board = board
        self.x_pub = rospy.Publisher("x", Float64, queue_size=1)
        self.rate_pub = rospy.Publisher("turn_rate", Float64, queue_size=1)
        self.text_pub = rospy.Publisher("text", String, queue_size=1)
        bus.on("moved", self.moved)
        bus.on("turned", self.turned)
        bus.on("nothing", self.never)

    def moved(self, x, source):
        self.x_pub.publish(x)  # sink odom
        self.text_pub.publish(source)  # clean

    def turned(self, rate):
        self.rate_pub.publish(rate)  # sink imu
        if self.board.low:
            self.text_pub.publish("low at %.1f" % self.board.x)  # sink odom ~battery

    def never(self, value):
        self.rate_pub.publish(value)  # clean


class App:
    PARTS = (Localizer, Battery, Reporter)

    def __init__(self):
        rospy.init_node("app")
        bus = EventBus()
        board = SimpleNamespace(x=0.0, low=False)
        self.parts = [part(bus, board) for part in self.PARTS]


if __name__ == "__main__":
    App()
    rospy.spin()
