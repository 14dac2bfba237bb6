"""Carry a golf bag along the path to the next tee: pure pursuit of the path, slower in bends and near people."""

import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry, Path
from rclpy.node import Node
from sensor_msgs.msg import Range
from steering import curvature_to, heading_of, point_ahead


class GolfCaddy(Node):
    def __init__(self):
        super().__init__("golf_caddy")
        self.lookahead = self.declare_parameter("lookahead", 1.0).value  # m
        self.cruise = self.declare_parameter("cruise", 1.2).value  # m/s
        self.lateral = self.declare_parameter("lateral", 1.5).value  # lateral acceleration in bends (m/s²)
        self.turn_max = self.declare_parameter("turn_max", 1.5).value  # rad/s
        self.keep_off = self.declare_parameter("keep_off", 1.5).value  # distance to people (m)
        self.slow_from = self.declare_parameter("slow_from", 4.0).value  # distance to people (m)
        self.path = []
        self.pose = None
        self.index = 0
        self.free = 10.0
        self.create_subscription(Path, "plan", self.on_path, 1)
        self.create_subscription(Odometry, "odom", self.on_odom, 10)
        self.create_subscription(Range, "sonar", self.on_sonar, 10)
        self.drive = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_timer(0.1, self.tick)

    def on_path(self, msg):
        self.path = [(pose.pose.position.x, pose.pose.position.y) for pose in msg.poses]
        self.index = 0

    def on_odom(self, msg):
        position = msg.pose.pose.position
        self.pose = position.x, position.y, heading_of(msg.pose.pose.orientation)

    def on_sonar(self, msg):
        self.free = msg.range if msg.range < msg.max_range else 10.0

    def arrived(self):
        x, y, _ = self.pose
        return math.hypot(self.path[-1][0] - x, self.path[-1][1] - y) < 0.8

    def speed_for(self, curvature):
        """Return the speed that bends and people in front allow."""
        speed = self.cruise
        if abs(curvature) > 1e-3:
            speed = min(speed, math.sqrt(self.lateral / abs(curvature)))
        room = (self.free - self.keep_off) / (self.slow_from - self.keep_off)
        return speed * max(0.0, min(1.0, room))

    def tick(self):
        cmd = Twist()
        if self.pose is not None and self.path and not self.arrived():
            self.index, aim = point_ahead(self.path, self.index, self.pose, self.lookahead)
            curvature = curvature_to(aim, self.pose)
            speed = self.speed_for(curvature)
            turn = max(-self.turn_max, min(self.turn_max, speed * curvature))
            cmd.linear.x = float(speed)
            cmd.angular.z = float(turn)
        self.drive.publish(cmd)


def main():
    rclpy.init()
    rclpy.spin(GolfCaddy())


if __name__ == "__main__":
    main()
