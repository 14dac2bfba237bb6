import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from arm_common.limits import LIMITS, limited
from arm_control import kinematics
from arm_control.kinematics import Arm as Kinematics


class Arm(Node):
    def __init__(self):
        super().__init__("arm")
        self.arm = Kinematics([0.3, 0.2])
        self.pub = self.create_publisher(Float64, "height", 10)
        self.create_subscription(JointState, "joints", self.on_joints, 10)  # source joints

    def on_joints(self, msg):
        height = self.arm.height(msg.position)
        self.pub.publish(Float64(data=limited("height", height)))  # sink joints
        self.pub.publish(Float64(data=LIMITS["height"]))  # clean
        self.pub.publish(Float64(data=kinematics.reach(self.arm)))  # clean


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Arm())
