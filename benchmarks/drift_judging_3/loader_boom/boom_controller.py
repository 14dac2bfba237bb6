#!/usr/bin/env python3
"""Bring the boom of a wheel loader to an angle and hold it there although oil leaks past the cylinder."""

import math

import rclpy
from pid import PID
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64


class BoomController(Node):
    """Compute the spool position of the proportional valve from the joint state."""

    def __init__(self):
        super().__init__("boom_controller", namespace="loader")
        self.declare_parameters(
            "",
            [
                ("joint", "boom"),
                ("rate", 20.0),
                ("pid.p", 1.0),
                ("pid.i", 0.0),
                ("pid.d", 0.0),
                ("pid.i_limit", 0.5),
                ("valve_deadband", 0.0),
                ("done_within", 0.05),
            ],
        )
        self.joint = self.get("joint")
        self.dt = 1.0 / self.get("rate")
        gains = {key: self.get(f"pid.{key}") for key in ("p", "i", "d", "i_limit")}
        self.pid = PID(**gains)
        self.deadband = self.get("valve_deadband")
        self.goal = None
        self.angle = None
        self.spool = self.create_publisher(Float64, "boom/spool", 10)
        self.settled = self.create_publisher(Bool, "boom/settled", 10)
        self.create_subscription(JointState, "joint_states", self.joint_callback, 10)
        self.create_subscription(Float64, "boom/goal", self.goal_callback, 10)
        self.create_timer(self.dt, self.timer_callback)

    def get(self, name):
        return self.get_parameter(name).value

    def joint_callback(self, msg):
        if self.joint in msg.name:
            self.angle = msg.position[msg.name.index(self.joint)]

    def goal_callback(self, msg):
        if self.goal is None or abs(msg.data - self.goal) > 1e-3:
            self.pid.reset()
        self.goal = msg.data

    def over_deadband(self, flow):
        """Skip the overlap of the spool, in which no oil flows."""
        if abs(flow) < 1e-3:
            return 0.0
        return flow + math.copysign(self.deadband, flow)

    def timer_callback(self):
        if self.angle is None or self.goal is None:
            return
        error = self.goal - self.angle
        flow = self.pid(error, self.angle, self.dt)
        self.spool.publish(Float64(data=self.over_deadband(flow)))
        self.settled.publish(Bool(data=abs(error) < self.get("done_within")))


def main():
    rclpy.init()
    rclpy.spin(BoomController())


if __name__ == "__main__":
    main()
