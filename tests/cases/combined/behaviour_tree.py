import abc
import enum
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan, BatteryState
from std_msgs.msg import String


class Status(enum.Enum):
    SUCCESS = 1
    FAILURE = 2
    RUNNING = 3


class Blackboard(dict):
    pass


class Behaviour(abc.ABC):
    def __init__(self, name):
        self.name = name

    @abc.abstractmethod
    def tick(self, bb):
        ...


class Sequence(Behaviour):
    def __init__(self, name, *children):
        super().__init__(name)
        self.children = children

    def tick(self, bb):
        for child in self.children:
            status = child.tick(bb)
            if status is not Status.SUCCESS:
                return status
        return Status.SUCCESS


class Selector(Behaviour):
    def __init__(self, name, children):
        super().__init__(name)
        self.children = list(children)

    def tick(self, bb):
        for child in self.children:
            status = child.tick(bb)
            if status != Status.FAILURE:
                return status
        return Status.FAILURE


class BatteryOk(Behaviour):
    def tick(self, bb):
        return Status.SUCCESS if bb.get("battery", 1.0) > 0.2 else Status.FAILURE


class Cruise(Behaviour):
    def __init__(self, speed):
        super().__init__("cruise")
        self.speed = speed

    def tick(self, bb):
        cmd = Twist()
        cmd.linear.x = min(self.speed, 0.5 * bb["clearance"])
        bb["cmd"] = cmd
        return Status.RUNNING


class Dock(Behaviour):
    def tick(self, bb):
        bb["cmd"] = Twist()
        return Status.SUCCESS


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.bb = Blackboard()
        self.tree = Selector("root", [Sequence("work", BatteryOk("ok"), Cruise(0.4)), Dock("dock")])
        self.pub = self.create_publisher(Twist, "cmd_vel", 1)
        self.log_pub = self.create_publisher(String, "tree", 1)
        self.create_subscription(LaserScan, "scan", self._scan, 10)  # source scan
        self.create_subscription(BatteryState, "battery", self._battery, 10)  # source battery
        self.timer = self.create_timer(0.1, self._tick)

    def _scan(self, m):
        self.bb["clearance"] = min(m.ranges)

    def _battery(self, m):
        self.bb.update(battery=m.percentage)

    def _tick(self):
        self.log_pub.publish(String(data=self.tree.name))  # clean
        status = self.tree.tick(self.bb)
        cmd = self.bb.pop("cmd", None)
        if cmd:
            self.pub.publish(cmd)  # sink scan ~battery
        self.log_pub.publish(String(data=status.name))  # sink ~battery


def main():
    rclpy.init()
    rclpy.spin(Robot())
