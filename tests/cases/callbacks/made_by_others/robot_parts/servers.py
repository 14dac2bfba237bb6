"""Nodes that only offer services or actions and that other software starts (a launch file, a container)."""

import rospy
from actionlib import SimpleActionServer
from control_msgs.msg import FollowJointTrajectoryAction
from rclpy.action import ActionServer
from rclpy.node import Node
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, Trigger
from tutorial_interfaces.action import Fibonacci


class Lamp:
    """A ROS 1 node with only a service."""

    def __init__(self):
        self.light = rospy.Publisher("light", Float64, queue_size=1)
        self.blink = rospy.Publisher("blink", Float64, queue_size=1)
        self.server = rospy.Service("dim", SetBool, self.dim)  # source dim
        rospy.Service("reset", Trigger, self.reset)  # source reset

    def dim(self, request):
        self.light.publish(1.0 if request.data else 0.0)  # sink ~dim
        return True, ""  # the response

    def reset(self, request):
        self.blink.publish(0.0)  # clean
        return []


class Arm:
    """A ROS 1 node with only an action, whose server class is imported by name."""

    def __init__(self):
        self.joint = rospy.Publisher("joint", Float64, queue_size=1)
        self.server = SimpleActionServer(  # source follow
            "follow", FollowJointTrajectoryAction, execute_cb=self.follow, auto_start=False
        )

    def follow(self, goal):
        for point in goal.trajectory.points:
            self.joint.publish(point.positions[0])  # sink follow


class Counter(Node):
    """A ROS 2 node with only an action."""

    def __init__(self):
        super().__init__("counter")
        self.seen = self.create_publisher(Float64, "seen", 1)
        self.server = ActionServer(self, Fibonacci, "count", self.count)  # source count

    def count(self, handle):
        self.seen.publish(Float64(data=float(handle.request.order)))  # sink count


class Valve(Node):
    """A ROS 2 node with only a service."""

    def __init__(self):
        super().__init__("valve")
        self.flow = self.create_publisher(Float64, "flow", 1)
        self.create_service(SetBool, "open", self.open)  # source open

    def open(self, request, response):
        self.flow.publish(Float64(data=float(request.data)))  # sink open
        return response
