#!/usr/bin/env python3
"""Balances a steel ball on a tilting plate and carries it to goals. Exhibit of a science museum."""

import sys

import rclpy
from axis_pd import AxisPD
from geometry_msgs.msg import Point, Vector3
from rclpy.node import Node
from std_msgs.msg import Bool

PIXELS_PER_METRE = 1180.0
CENTRE = (320.0, 240.0)  # middle of the plate in the image (px)
EDGE = {"x": 0.19, "y": 0.14}  # distances from the middle to the rim (m)
GAINS = {"x": {"kp": 1.05, "kd": 0.62}, "y": {"kp": 1.15, "kd": 0.66}}


class BallPlate(Node):
    def __init__(self):
        super().__init__("ball_plate")
        limit = self.declare_parameter("max_tilt", 0.16).value
        self.period = self.declare_parameter("period", 0.04).value
        self.lost_after = self.declare_parameter("lost_after", 0.3).value
        self.goal_step = self.declare_parameter("goal_step", 0.006).value
        self.x_axis = AxisPD(GAINS["x"]["kp"], GAINS["x"]["kd"], limit)
        self.y_axis = AxisPD(GAINS["y"]["kp"], GAINS["y"]["kd"], limit)
        self.ball = None
        self.seen = 0.0
        self.goal = [0.0, 0.0]
        self.wanted = [0.0, 0.0]
        self.servos = self.create_publisher(Vector3, "plate/tilt", 10)
        self.lamp = self.create_publisher(Bool, "plate/lamp", 10)
        self.create_subscription(Point, "camera/ball", self.image, 10)
        self.create_subscription(Point, "exhibit/goal", self.pressed, 10)
        self.create_timer(self.period, self.balance)

    def clock(self):
        return self.get_clock().now().nanoseconds * 1e-9

    def image(self, pixel):
        self.ball = (
            (pixel.x - CENTRE[0]) / PIXELS_PER_METRE,
            (CENTRE[1] - pixel.y) / PIXELS_PER_METRE,
        )
        self.seen = self.clock()

    def pressed(self, button):
        self.wanted[0] = max(-EDGE["x"] + 0.03, min(EDGE["x"] - 0.03, button.x))
        self.wanted[1] = max(-EDGE["y"] + 0.03, min(EDGE["y"] - 0.03, button.y))

    def balance(self):
        command = Vector3()
        if self.ball is None or self.clock() - self.seen > self.lost_after:
            self.servos.publish(command)
            return
        for i in (0, 1):
            step = self.wanted[i] - self.goal[i]
            self.goal[i] += max(-self.goal_step, min(self.goal_step, step))
        along = self.x_axis.tilt(self.goal[0], self.ball[0], self.period)
        across = self.y_axis.tilt(self.goal[1], self.ball[1], self.period)
        command.x = along
        command.y = across
        self.servos.publish(command)
        off = abs(self.ball[0] - self.wanted[0]) + abs(self.ball[1] - self.wanted[1])
        self.lamp.publish(Bool(data=bool(off < 0.02)))


def main():
    rclpy.init(args=sys.argv)
    plate = BallPlate()
    rclpy.spin(plate)
    rclpy.shutdown()


if __name__ == "__main__":
    main()
