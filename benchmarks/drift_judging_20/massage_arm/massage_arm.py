#!/usr/bin/env python3
"""Massage arm: presses the points of a program one after the other, each with the force that the therapist chose."""

from enum import Enum

import rclpy
from elastic import ElasticHead
from geometry_msgs.msg import TwistStamped
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, Int32, String


class Phase(Enum):
    IDLE = "idle"
    APPROACH = "approach"
    PRESS = "press"
    LIFT = "lift"
    DONE = "done"


class MassageArm(Node):
    def __init__(self):
        super().__init__("massage_arm")
        self.declare_parameter("points", 3)
        self.declare_parameter("approach_speed", 0.025)  # m/s
        self.declare_parameter("lift_speed", 0.05)
        self.declare_parameter("press_speed", 0.02)  # m/s, largest speed while pressing
        self.declare_parameter("touch_force", 3.0)  # N
        self.declare_parameter("max_force", 60.0)
        self.declare_parameter("kp", 0.0012)  # m/s per N
        self.declare_parameter("hold_time", 2.0)  # s
        self.declare_parameter("ramp", 25.0)  # N/s
        self.declare_parameter("rest_height", 0.0)  # m, carriage travel
        self.declare_parameter("period", 0.05)
        self.period = self.get_parameter("period").value
        self.head = ElasticHead()
        self.phase = Phase.IDLE
        self.goal = None
        self.wanted = 0.0
        self.travel = None
        self.held = 0.0
        self.point = 0
        self.vel_pub = self.create_publisher(TwistStamped, "carriage/velocity", 10)
        self.force_pub = self.create_publisher(Float64, "pad/force_estimate", 10)
        self.point_pub = self.create_publisher(Int32, "session/point", 10)
        self.phase_pub = self.create_publisher(String, "session/phase", 10)
        self.create_subscription(JointState, "carriage/joint", self.joint_cb, 10)
        self.create_subscription(Float64, "head/deflection", self.deflection_cb, 10)
        self.create_subscription(Float64, "session/force", self.force_cb, 10)
        self.create_timer(self.period, self.control)

    def param(self, name):
        return self.get_parameter(name).value

    def joint_cb(self, msg):
        self.travel = msg.position[0]

    def deflection_cb(self, msg):
        self.head.measure(msg.data)

    def force_cb(self, msg):
        self.goal = msg.data

    def switch(self, phase):
        self.get_logger().info(f"point {self.point}: {phase.value}")
        self.phase = phase

    def control(self):
        if self.travel is None or self.goal is None:
            return
        force = self.head.force()
        velocity = 0.0
        if self.phase is Phase.IDLE:
            self.switch(Phase.APPROACH)
        elif self.phase is Phase.APPROACH:
            velocity = self.param("approach_speed")
            if force > self.param("touch_force"):
                self.wanted = force
                self.held = 0.0
                self.switch(Phase.PRESS)
        elif self.phase is Phase.PRESS:
            velocity = self.press(force)
        elif self.phase is Phase.LIFT:
            velocity = -self.param("lift_speed")
            if self.travel <= self.param("rest_height"):
                velocity = 0.0
                self.point += 1
                self.switch(Phase.DONE if self.point >= self.param("points") else Phase.APPROACH)
        cmd = TwistStamped()
        cmd.header.stamp = self.get_clock().now().to_msg()
        cmd.twist.linear.z = velocity
        self.vel_pub.publish(cmd)
        self.force_pub.publish(Float64(data=force))
        self.point_pub.publish(Int32(data=self.point))
        self.phase_pub.publish(String(data=self.phase.value))

    def press(self, force):
        """Raise the force to the goal, hold it, then let go; return the speed of the carriage."""
        if force > self.param("max_force"):
            self.get_logger().error(f"{force:.0f} N on the skin, letting go")
            self.switch(Phase.LIFT)
            return 0.0
        self.wanted = min(self.goal, self.wanted + self.param("ramp") * self.period)
        if self.wanted >= self.goal:
            self.held += self.period
            if self.held >= self.param("hold_time"):
                self.switch(Phase.LIFT)
        limit = self.param("press_speed")
        return max(-limit, min(limit, self.param("kp") * (self.wanted - force)))


def main():
    rclpy.init()
    node = MassageArm()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
