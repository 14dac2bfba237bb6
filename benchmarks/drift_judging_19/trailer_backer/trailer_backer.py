#!/usr/bin/env python3
"""Backs a trailer into its bay: steers the tractor so that the trailer follows the middle of the bay."""

import rclpy
from ackermann_msgs.msg import AckermannDrive
from geometry_msgs.msg import Pose2D
from hitch import joint_for, limited, steering_for
from rclpy.node import Node
from std_msgs.msg import Bool, Float32


class TrailerBacker(Node):
    def __init__(self):
        super().__init__("trailer_backer")
        self.declare_parameters(
            "",
            [
                ("speed", 0.8),  # m/s, backwards
                ("creep", 0.25),
                ("creep_at", 1.5),  # m before the dock
                ("stop_at", 0.3),
                ("k_offset", 0.3),  # rad per m
                ("max_aim", 0.26),  # rad
                ("k_aim", 0.6),  # 1/m
                ("max_bend", 0.35),  # 1/m, of the trailer's path
                ("k_joint", 0.9),  # 1/s
                ("max_steer", 0.62),  # rad
                ("jackknife", 1.05),  # rad
                ("dock_share", 0.4),
            ],
        )
        self.pose = None
        self.joint = 0.0
        self.dock = None
        self.stopped = False
        self.drive = self.create_publisher(AckermannDrive, "drive", 10)
        self.parked = self.create_publisher(Bool, "backer/parked", 10)
        self.horn = self.create_publisher(Bool, "horn", 10)
        self.create_subscription(Pose2D, "trailer/pose", self.on_pose, 10)
        self.create_subscription(Float32, "hitch/angle", self.on_joint, 10)
        self.create_subscription(Float32, "dock/range", self.on_dock, 10)
        self.create_timer(0.1, self.step)

    def value(self, name):
        return self.get_parameter(name).value

    def on_pose(self, msg):
        self.pose = msg

    def on_joint(self, msg):
        self.joint = msg.data

    def on_dock(self, msg):
        if self.dock is None:
            self.dock = msg.data
        self.dock += self.value("dock_share") * (msg.data - self.dock)

    def step(self):
        if self.pose is None or self.dock is None:
            return
        msg = AckermannDrive()
        if self.dock < self.value("stop_at") or self.stopped:
            self.stopped = True
        elif abs(self.joint) > self.value("jackknife"):
            self.get_logger().error(f"jackknife, {self.joint:.2f} rad")
            self.stopped = True
        else:
            speed = self.value("speed") if self.dock > self.value("creep_at") else self.value("creep")
            # the heading is that of the way backwards, along the bay
            aim = limited(-self.value("k_offset") * self.pose.y, self.value("max_aim"))
            bend = limited(self.value("k_aim") * (aim - self.pose.theta), self.value("max_bend"))
            joint = joint_for(bend)
            rate = self.value("k_joint") * (joint - self.joint)
            msg.steering_angle = limited(steering_for(self.joint, rate, speed), self.value("max_steer"))
            msg.speed = -speed
        self.drive.publish(msg)
        self.parked.publish(Bool(data=self.stopped))
        self.horn.publish(Bool(data=not self.stopped))


def main():
    rclpy.init()
    backer = TrailerBacker()
    rclpy.spin(backer)
    backer.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
