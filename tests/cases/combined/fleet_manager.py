"""A loop makes callbacks with partial, which fill a dict of deques; a thread averages these and a helper publishes."""

import collections
import functools
import threading

import rclpy
from geometry_msgs.msg import PoseStamped, Twist
from rclpy.node import Node
from std_msgs.msg import Float64, String

ROBOTS = ("red", "blue")


def mean(values, default=0.0):
    return sum(values) / len(values) if values else default


class Fleet(Node):
    def __init__(self):
        super().__init__("fleet")
        self.lock = threading.Lock()
        self.history = {name: collections.deque(maxlen=10) for name in ROBOTS}
        self.targets = {name: 1.0 for name in ROBOTS}
        self.publishers_by_name = {}
        self.subs = []
        for name in ROBOTS:
            self.publishers_by_name[name] = self.create_publisher(Twist, f"/{name}/cmd_vel", 10)
            callback = functools.partial(self.on_pose, name)
            self.subs.append(self.create_subscription(PoseStamped, f"/{name}/pose", callback, 10))  # source pose
        self.status = self.create_publisher(String, "status", 10)
        self.create_subscription(Float64, "/target", self.on_target, 10)  # source target
        threading.Thread(target=self.loop, daemon=True).start()

    def on_pose(self, name, msg):
        with self.lock:
            self.history[name].append(msg.pose.position.x)

    def on_target(self, msg):
        self.targets.update({name: msg.data for name in ROBOTS})

    def loop(self):
        while rclpy.ok():
            for name, pub in self.publishers_by_name.items():
                with self.lock:
                    x = mean(self.history[name])
                self.send(pub, self.targets[name] - x)
            self.status.publish(String(data="running"))  # clean
            self.status.publish(String(data=f"{mean([1.0, 2.0])}"))  # clean

    def send(self, pub, speed):
        cmd = Twist()
        cmd.linear.x = speed
        pub.publish(cmd)  # sink pose target


def main():
    rclpy.init()
    rclpy.spin(Fleet())
