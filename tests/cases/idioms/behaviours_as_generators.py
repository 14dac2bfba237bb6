"""Behaviours as generators that a timer advances: `yield`, `yield from`, `next` with a default, and `send`."""

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String


class Patrol(Node):
    def __init__(self):
        super().__init__("patrol")
        self.x = None
        self.blocked = False
        self.cmd = self.create_publisher(Twist, "cmd_vel", 10)
        self.say = self.create_publisher(String, "say", 10)
        self.create_subscription(Odometry, "odom", self.on_odom, 10)  # source odom
        self.create_subscription(LaserScan, "scan", self.on_scan, 10)  # source scan
        self.behaviour = self.mission()
        self.create_timer(0.1, self.tick)

    def on_odom(self, msg):
        self.x = msg.pose.pose.position.x

    def on_scan(self, msg):
        self.blocked = min(msg.ranges) < 0.4

    def mission(self):
        yield from self.drive_to(2.0)
        yield from self.turn(16)
        yield from self.drive_to(0.0)
        yield from self.turn(16)

    def drive_to(self, goal):
        while self.x is None or abs(goal - self.x) > 0.1:
            twist = Twist()
            if self.x is not None and not self.blocked:
                twist.linear.x = 0.5 * (goal - self.x)
            yield twist

    def turn(self, ticks):
        for _ in range(ticks):
            twist = Twist()
            twist.angular.z = 0.8
            yield twist

    def tick(self):
        twist = next(self.behaviour, None)
        if twist is None:
            self.say.publish(String(data="mission over"))  # sink ~odom
            return
        self.cmd.publish(twist)  # sink odom ~scan


class Greeter(Node):
    def __init__(self):
        super().__init__("greeter")
        self.out = self.create_publisher(String, "greeting", 10)
        self.words = self.lines()
        self.create_timer(1.0, self.tick)

    def lines(self):
        for word in ("good", "morning"):
            yield word

    def tick(self):
        self.out.publish(String(data=next(self.words, "")))  # clean


def main():
    rclpy.init()
    executor = rclpy.executors.SingleThreadedExecutor()
    for node in (Patrol(), Greeter()):
        executor.add_node(node)
    executor.spin()


if __name__ == "__main__":
    main()
