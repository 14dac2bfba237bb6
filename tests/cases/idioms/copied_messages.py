"""Copies of messages: `deepcopy` before overwriting, shared parts, and slices of lists in messages."""

import copy

import rclpy
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64


class Copier(Node):
    def __init__(self):
        super().__init__("copier")
        self.template = JointState()
        self.template.name = ["a", "b"]
        self.template.position = [0.0, 0.0]
        self.path = Path()
        self.joints = self.create_publisher(JointState, "joint_command", 10)
        self.paths = self.create_publisher(Path, "path", 10)
        self.first = self.create_publisher(PoseStamped, "first", 10)
        self.gap = self.create_publisher(Float64, "gap", 10)
        self.create_subscription(JointState, "joint_states", self.on_joints, 10)  # source joints
        self.create_subscription(PoseStamped, "pose", self.on_pose, 10)  # source pose

    def on_joints(self, msg):
        command = copy.deepcopy(self.template)
        command.position[0] = msg.position[0] + 0.1
        self.joints.publish(command)  # sink joints
        self.joints.publish(self.template)  # clean
        other = copy.copy(msg)
        other.position = [0.0 for _ in other.name]
        other.velocity = []
        other.effort = []
        self.joints.publish(other)  # sink joints
        self.template.header.stamp = self.get_clock().now().to_msg()
        self.joints.publish(self.template)  # clean

    def on_pose(self, msg):
        self.path.header = msg.header
        self.path.poses.append(msg)
        self.path.poses = self.path.poses[-100:]
        self.paths.publish(self.path)  # sink pose
        goal = copy.deepcopy(self.path.poses[0])
        goal.pose.position.z = 0.0
        self.first.publish(goal)  # sink pose
        empty = Path()
        empty.header = copy.copy(self.template.header)
        self.paths.publish(empty)  # clean
        delta = copy.deepcopy(msg.pose.position)
        delta.x -= goal.pose.position.x
        self.gap.publish(Float64(data=delta.x))  # sink pose


def main():
    rclpy.init()
    rclpy.spin(Copier())


if __name__ == "__main__":
    main()
