from dataclasses import dataclass

import rclpy
from geometry_msgs.msg import Point, PoseStamped
from rclpy.node import Node
from std_msgs.msg import Float64


@dataclass
class Robot:
    name: str
    place: tuple = (0.0, 0.0)


class Fleet(Node):
    def __init__(self):
        super().__init__("fleet")
        self.robots = {name: Robot(name) for name in ("a", "b", "c", "d", "e")}
        self.seen = {}
        self.other = {}
        self.centre = self.create_publisher(Point, "centre", 1)
        self.pub = self.create_publisher(Float64, "out", 1)
        self.create_subscription(PoseStamped, "pose", self.on_pose, 1)  # source pose
        self.create_subscription(Float64, "x", lambda m: self.seen.__setitem__("x", m.data), 1)  # source x
        self.create_timer(0.1, self.tick)

    def on_pose(self, msg):
        self.robots[msg.header.frame_id].place = (msg.pose.position.x, 0.0)

    def tick(self):
        xs, ys = zip(*(r.place for r in self.robots.values()))
        self.centre.publish(Point(x=sum(xs) / len(xs)))  # sink pose
        self.pub.publish(Float64(data=self.seen.__getitem__("x")))  # sink x
        self.pub.publish(Float64(data=self.other.get("x", 0.0)))  # clean
        ones, twos = zip(*[(1, 2), (3, 4)])
        self.pub.publish(Float64(data=float(sum(ones))))  # clean


rclpy.init()
rclpy.spin(Fleet())
