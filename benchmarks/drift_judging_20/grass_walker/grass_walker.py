#!/usr/bin/env python3
"""Four-legged walker that patrols the posts of a solar park: walks from post to post and looks at each for a moment."""

import math

import rclpy
from gait import Trot
from geometry_msgs.msg import PoseArray, PoseStamped
from rclpy.node import Node
from std_msgs.msg import Float32MultiArray, String, UInt8

CRUISE = 0.4  # m/s
TURN_GAIN = 1.5
MAX_YAW_RATE = 0.8
POST_RADIUS = 0.3  # m
LOOK_TICKS = 8
FACE_FIRST = 0.9  # rad, turn on the spot above

TERRAIN = {0: "unknown", 1: "gravel", 2: "short grass", 3: "tall grass", 4: "mud"}
WATER = 5


def wrap(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


class GrassWalker(Node):
    def __init__(self):
        super().__init__("grass_walker")
        self.trot = Trot()
        self.posts = []
        self.next = 0
        self.look = 0
        self.pose = None
        self.yaw = 0.0
        self.terrain = 0
        self.gait_pub = self.create_publisher(Float32MultiArray, "legs/gait", 10)
        self.status_pub = self.create_publisher(String, "patrol/status", 10)
        self.create_subscription(PoseStamped, "pose", self.on_pose, 10)
        self.create_subscription(PoseArray, "patrol/posts", self.on_posts, 10)
        self.create_subscription(UInt8, "terrain/class", self.on_terrain, 10)
        self.create_timer(0.2, self.walk)

    def on_pose(self, msg):
        self.pose = msg.pose.position
        q = msg.pose.orientation
        self.yaw = 2.0 * math.atan2(q.z, q.w)

    def on_posts(self, msg):
        if not self.posts:
            self.posts = [(pose.position.x, pose.position.y) for pose in msg.poses]

    def on_terrain(self, msg):
        if msg.data != self.terrain:
            self.get_logger().info(f"terrain: {TERRAIN.get(msg.data, 'other')}")
        self.terrain = msg.data

    def steer(self):
        """Return speed and yaw rate towards the next post."""
        x, y = self.posts[self.next]
        dx, dy = x - self.pose.x, y - self.pose.y
        bearing = wrap(math.atan2(dy, dx) - self.yaw)
        rate = max(-MAX_YAW_RATE, min(MAX_YAW_RATE, TURN_GAIN * bearing))
        if math.hypot(dx, dy) < POST_RADIUS:
            self.look = LOOK_TICKS
            self.next += 1
            return 0.0, 0.0
        return (0.0 if abs(bearing) > FACE_FIRST else CRUISE), rate

    def walk(self):
        if self.pose is None or not self.posts:
            return
        speed, rate = 0.0, 0.0
        if self.terrain == WATER:
            status = "blocked"
        elif self.look > 0:
            self.look -= 1
            status = "look"
        elif self.next >= len(self.posts):
            status = "done"
        else:
            speed, rate = self.steer()
            status = "walk"
        self.trot.set_speed(speed)
        self.gait_pub.publish(Float32MultiArray(data=self.trot.values(rate)))
        self.status_pub.publish(String(data=status))


def main(args=None):
    rclpy.init(args=args)
    walker = GrassWalker()
    try:
        rclpy.spin(walker)
    finally:
        walker.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
