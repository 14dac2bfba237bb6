#!/usr/bin/env python3
"""Pan axis of a camera jib: PD control of a torque-driven joint."""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

JOINT = "jib_pan"


class JibPan(Node):
    def __init__(self):
        super().__init__("jib_pan")
        self.declare_parameters(
            "",
            [
                ("kp", 40.0),
                ("kd", 8.0),
                ("max_torque", 120.0),
                ("friction_torque", 0.4),
            ],
        )
        self.kp = self.get_parameter("kp").get_parameter_value().double_value
        self.kd = self.get_parameter("kd").get_parameter_value().double_value
        self.max_torque = self.get_parameter("max_torque").get_parameter_value().double_value
        self.friction = self.get_parameter("friction_torque").get_parameter_value().double_value
        self.target = None
        self.position = None
        self.velocity = 0.0
        self.create_subscription(Float64, "jib/target", self.target_callback, 10)
        self.create_subscription(JointState, "joint_states", self.joint_callback, 10)
        self.torque_pub = self.create_publisher(Float64, "jib/torque", 10)
        self.timer = self.create_timer(0.02, self.control_loop)

    def target_callback(self, msg: Float64):
        if msg.data != self.target:
            self.get_logger().info(f"new target {msg.data:.2f} rad")
        self.target = msg.data

    def joint_callback(self, msg: JointState):
        if JOINT not in msg.name:
            return
        index = msg.name.index(JOINT)
        self.position = msg.position[index]
        self.velocity = msg.velocity[index]

    def control_loop(self):
        if self.target is None or self.position is None:
            return
        error = self.target - self.position
        spring = self.kp * error
        damper = self.kd * self.velocity
        torque = spring - damper
        if abs(error) > 0.01:
            torque += self.friction if error > 0 else -self.friction
        torque = min(max(torque, -self.max_torque), self.max_torque)
        self.torque_pub.publish(Float64(data=torque))


def main(args=None):
    rclpy.init(args=args)
    node = JibPan()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
