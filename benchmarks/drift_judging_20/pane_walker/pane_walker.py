#!/usr/bin/env python3
"""Pane walker: cleans a glass front lane by lane, held by a suction cup; it sets its rope brake when the seal fails."""

import rclpy
from geometry_msgs.msg import Pose2D, Twist
from rclpy.node import Node
from sensor_msgs.msg import FluidPressure
from std_msgs.msg import Bool, Float32, String


class PaneWalker(Node):
    def __init__(self):
        super().__init__("pane_walker")
        defaults = {
            "lanes": 3,
            "lane_width": 0.5,  # m
            "top": 0.2,  # m below the upper frame
            "bottom": 2.4,
            "down_speed": 0.3,  # m/s
            "up_speed": 0.4,
            "shift_speed": 0.25,
            "vacuum_goal": 32.0,  # kPa
            "vacuum_low": 22.0,
            "low_count": 3,
            "fan_base": 0.55,
            "fan_gain": 0.02,
            "vacuum_share": 0.6,
            "brush_duty": 0.7,
        }
        for name, value in defaults.items():
            self.declare_parameter(name, value)
        self.p = {name: self.get_parameter(name).value for name in defaults}
        self.pose = None
        self.vacuum = 0.0
        self.low = 0
        self.lane = 0
        self.state = "attach"
        self.fan_pub = self.create_publisher(Float32, "cup/fan", 10)
        self.vel_pub = self.create_publisher(Twist, "walker/velocity", 10)
        self.brake_pub = self.create_publisher(Bool, "rope/brake", 10)
        self.brush_pub = self.create_publisher(Float32, "brush/duty", 10)
        self.state_pub = self.create_publisher(String, "walker/state", 10)
        self.create_subscription(Pose2D, "walker/pose", self.on_pose, 10)
        self.create_subscription(FluidPressure, "cup/vacuum", self.on_vacuum, 10)
        self.create_timer(0.1, self.step)

    def on_pose(self, msg):
        self.pose = msg

    def on_vacuum(self, msg):
        kpa = msg.fluid_pressure / 1000.0
        self.vacuum += self.p["vacuum_share"] * (kpa - self.vacuum)
        if self.state in ("attach", "halt", "done"):
            return
        if self.vacuum < self.p["vacuum_low"]:
            self.low += 1
        else:
            self.low = 0
        if self.low >= self.p["low_count"]:
            self.get_logger().error(f"seal lost, {self.vacuum:.1f} kPa, rope brake set")
            self.state = "halt"

    def move(self):
        """Go down the lane with the brush, up again, and over to the next; return the velocity."""
        p = self.p
        across, down = 0.0, 0.0
        if self.state == "down":
            down = p["down_speed"]
            if self.pose.y > p["bottom"]:
                self.state = "up"
        elif self.state == "up":
            down = -p["up_speed"]
            if self.pose.y < p["top"]:
                self.lane += 1
                self.state = "done" if self.lane >= p["lanes"] else "shift"
        elif self.state == "shift":
            across = p["shift_speed"]
            if self.pose.x > self.lane * p["lane_width"]:
                self.state = "down"
        return across, down

    def step(self):
        if self.pose is None:
            return
        p = self.p
        if self.state == "attach" and self.vacuum > 0.9 * p["vacuum_goal"]:
            self.state = "down"
        across, down = self.move()
        fan = p["fan_base"] + p["fan_gain"] * (p["vacuum_goal"] - self.vacuum)
        self.fan_pub.publish(Float32(data=max(0.0, min(1.0, fan))))
        velocity = Twist()
        velocity.linear.x = across
        velocity.linear.y = down
        self.vel_pub.publish(velocity)
        self.brush_pub.publish(Float32(data=p["brush_duty"] if self.state == "down" else 0.0))
        self.brake_pub.publish(Bool(data=self.state == "halt"))
        self.state_pub.publish(String(data=self.state))


def main(args=None):
    rclpy.init(args=args)
    node = PaneWalker()
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == "__main__":
    main()
