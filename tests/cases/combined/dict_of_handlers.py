import enum
import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String


class Mode(enum.Enum):
    SEARCH = 0
    APPROACH = 1
    AVOID = 2


class Fsm(Node):
    def __init__(self):
        super().__init__("fsm")
        self.mode = Mode.SEARCH
        self.front = None
        self.yaw = 0.0
        self.handlers = {
            Mode.SEARCH: self.search,
            Mode.APPROACH: self.approach,
            Mode.AVOID: self.avoid,
        }
        self.cmd = self.create_publisher(Twist, "cmd_vel", 10)
        self.status = self.create_publisher(String, "mode", 10)
        self.create_subscription(LaserScan, "scan", self.on_scan, 10)  # source scan
        self.create_subscription(Odometry, "odom", self.on_odom, 10)  # source odom
        self.create_timer(0.1, self.step)

    def on_scan(self, msg):
        self.front = min(msg.ranges[0:10])  # step scan

    def on_odom(self, msg):
        q = msg.pose.pose.orientation  # step odom
        self.yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))  # step odom

    def search(self):
        t = Twist()
        t.angular.z = 0.5
        if self.front is not None and self.front < 2.0:  # step ~scan
            self.mode = Mode.APPROACH  # step ~scan
        return t

    def approach(self):
        t = Twist()
        t.linear.x = 0.3 * self.front  # step scan
        t.angular.z = -self.yaw  # step odom
        if self.front < 0.3:  # step ~scan
            self.mode = Mode.AVOID  # step ~scan
        return t  # step scan odom

    def avoid(self):
        t = Twist()
        t.linear.x = -0.1
        if self.front > 1.0:  # step ~scan
            self.mode = Mode.SEARCH  # step ~scan
        return t

    def step(self):
        cmd = self.handlers[self.mode]()  # step scan odom
        self.cmd.publish(cmd)  # sink scan odom
        self.status.publish(String(data="step"))  # clean
        self.status.publish(String(data=self.mode.name))  # sink ~scan


def main(args=None):
    rclpy.init(args=args)
    node = Fsm()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
