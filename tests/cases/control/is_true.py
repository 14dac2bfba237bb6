import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Int32, String


class Gate(Node):
    def __init__(self):
        super().__init__("gate")
        self.armed = False
        self.mode = 0
        self.last = None
        self.pub = self.create_publisher(String, "state", 1)
        self.create_subscription(Bool, "arm", self.on_arm, 1)  # source arm
        self.create_subscription(Int32, "mode", self.on_mode, 1)  # source mode
        self.create_subscription(Bool, "ping", self.on_ping, 1)  # source ping
        self.create_timer(0.1, self.tick)

    def on_arm(self, msg):
        self.armed = msg.data

    def on_mode(self, msg):
        self.mode = msg.data

    def on_ping(self, msg):
        if msg is self.last:
            self.pub.publish(String(data="again"))  # clean
        self.last = msg

    def tick(self):
        if self.armed is True:
            self.pub.publish(String(data="armed"))  # sink ~arm
        if self.armed is not False and self.mode is not None:
            self.pub.publish(String(data="not safe"))  # sink ~arm
        match self.mode:
            case True:
                self.pub.publish(String(data="on"))  # sink ~mode
        self.pub.publish(String(data="tick"))  # clean


rclpy.init()
rclpy.spin(Gate())
