"""Data stored inside the elements of a container does not affect the number of elements."""

import rclpy
from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
from std_msgs.msg import Float64, Int32, String


class Robot:
    def __init__(self, name):
        self.name = name
        self.task = None
        self.battery = 1.0


class Fleet(Node):
    def __init__(self):
        super().__init__("fleet")
        self.names = self.declare_parameter("robots", ["a", "b"]).value
        self.robots = {name: Robot(name) for name in self.names}
        self.idle = []
        self.pub = self.create_publisher(String, "names", 1)
        self.count = self.create_publisher(Int32, "count", 1)
        for name in self.names:
            level = lambda m, n=name: self.on_level(n, m)
            self.create_subscription(Float64, f"{name}/battery", level, 1)  # source level
        self.create_subscription(PoseStamped, "task", self.on_task, 1)  # source task
        self.create_timer(0.1, self.tick)

    def on_level(self, name, msg):
        self.robots[name].battery = msg.data

    def on_task(self, msg):
        for robot in self.robots.values():
            if robot.battery > 0.3:
                robot.task = msg.pose
                self.idle.append(robot)

    def tick(self):
        for robot in self.robots.values():
            self.pub.publish(String(data=robot.name))  # clean
        self.count.publish(Int32(data=len(self.robots)))  # clean
        self.count.publish(Int32(data=len(self.idle)))  # sink ~level
        tasks = [r.task for r in self.robots.values()]
        self.pub.publish(String(data=str(tasks)))  # sink task ~level


rclpy.init()
rclpy.spin(Fleet())
