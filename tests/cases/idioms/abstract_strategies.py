"""Abstract base classes: a controller chosen by a parameter from a registry of subclasses."""

from abc import ABC, abstractmethod
from math import atan2, hypot

import rospy
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import String
from tf.transformations import euler_from_quaternion


class Controller(ABC):
    registry = {}
    title = "none"

    def __init_subclass__(cls, **kwargs):
        super().__init_subclass__(**kwargs)
        Controller.registry[cls.title] = cls

    def __init__(self):
        self.goal = None

    def __call__(self, x, y, yaw):
        if self.goal is None:
            return Twist()
        return self.command(x, y, yaw)

    @abstractmethod
    def command(self, x, y, yaw):
        """Return the velocity."""


class Proportional(Controller):
    title = "p"

    def command(self, x, y, yaw):
        out = Twist()
        gx, gy = self.goal
        out.linear.x = min(0.5, hypot(gx - x, gy - y))
        out.angular.z = atan2(gy - y, gx - x) - yaw
        return out


class BangBang(Controller):
    title = "bang"

    def command(self, x, y, yaw):
        out = Twist()
        out.linear.x = 0.3
        out.angular.z = 1.0 if yaw < 0 else -1.0
        return out


class Follower:
    def __init__(self):
        self.name = rospy.get_param("~controller", "p")
        self.control = Controller.registry[self.name]()
        self.cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.log = rospy.Publisher("log", String, queue_size=1)
        rospy.Subscriber("goal", PoseStamped, self.on_goal)  # source goal
        rospy.Subscriber("odom", Odometry, self.on_odom)  # source odom

    def on_goal(self, msg):
        self.control.goal = (msg.pose.position.x, msg.pose.position.y)

    def on_odom(self, msg):
        q = msg.pose.pose.orientation
        _, _, yaw = euler_from_quaternion([q.x, q.y, q.z, q.w])
        position = msg.pose.pose.position
        self.cmd.publish(self.control(position.x, position.y, yaw))  # sink odom goal
        self.log.publish("uses " + self.control.title)  # clean


if __name__ == "__main__":
    rospy.init_node("follower")
    Follower()
    rospy.spin()
