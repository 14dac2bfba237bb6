#!/usr/bin/env python3
"""Street sweeper: follows a route along the kerb at the speed that the driver asks for, with its brush down."""

import math

import rclpy
from ackermann_msgs.msg import AckermannDrive
from nav_msgs.msg import Odometry, Path
from rclpy.node import Node
from route import Route
from std_msgs.msg import Bool, Float32

WHEELBASE = 1.6  # m
LOOKAHEAD = 1.1  # m
MAX_STEER = 0.7  # rad
BRUSH_UP_BELOW = 0.15  # m/s
END_POINTS = 8
ACCEL = 0.8  # m/s2
PERIOD = 0.1


def yaw_of(q):
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


class KerbSweeper(Node):
    def __init__(self):
        super().__init__("kerb_sweeper")
        self.route = None
        self.pose = None
        self.wish = 0.0
        self.speed = 0.0
        self.finished = False
        self.drive_pub = self.create_publisher(AckermannDrive, "drive", 10)
        self.brush_pub = self.create_publisher(Float32, "brush/duty", 10)
        self.done_pub = self.create_publisher(Bool, "sweeper/finished", 10)
        self.create_subscription(Path, "route", self.on_route, 10)
        self.create_subscription(Odometry, "odom", self.on_odom, 10)
        self.create_subscription(Float32, "sweep/speed", self.on_speed, 10)
        self.create_timer(PERIOD, self.step)

    def on_route(self, msg):
        if self.route is None:
            self.route = Route([(p.pose.position.x, p.pose.position.y) for p in msg.poses])
            self.get_logger().info(f"route with {len(self.route)} points")

    def on_odom(self, msg):
        self.pose = msg.pose.pose
        self.speed = msg.twist.twist.linear.x

    def on_speed(self, msg):
        self.wish = msg.data

    def curvature(self):
        """Pure pursuit: the arc to a point of the route ahead."""
        x, y = self.pose.position.x, self.pose.position.y
        self.route.advance(x, y)
        tx, ty = self.route.ahead(x, y, LOOKAHEAD)
        bearing = math.atan2(ty - y, tx - x) - yaw_of(self.pose.orientation)
        return 2.0 * math.sin(bearing) / max(0.1, math.hypot(tx - x, ty - y))

    def step(self):
        if self.route is None or self.pose is None:
            return
        steer = math.atan(WHEELBASE * self.curvature())
        self.finished = self.finished or self.route.left() < END_POINTS
        msg = AckermannDrive()
        msg.steering_angle = max(-MAX_STEER, min(MAX_STEER, steer))
        msg.acceleration = ACCEL
        msg.speed = 0.0 if self.finished else self.wish
        self.drive_pub.publish(msg)
        # worn bristles wear faster in turns
        turning = abs(msg.steering_angle) > 0.3
        duty = 0.0 if self.speed < BRUSH_UP_BELOW else 0.6 if turning else 0.8
        self.brush_pub.publish(Float32(data=duty))
        self.done_pub.publish(Bool(data=self.finished))


def main(args=None):
    rclpy.init(args=args)
    node = KerbSweeper()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
