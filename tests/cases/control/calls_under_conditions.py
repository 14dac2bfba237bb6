import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Joy
from std_msgs.msg import Int32


class Gears(Node):
    def __init__(self):
        super().__init__("gears")
        self.gear = 1
        self.lamp = 0
        self.horn = 0
        self.actions = {0: self.up, 1: self.down}
        self.pub = self.create_publisher(Int32, "gear", 1)
        self.create_subscription(Joy, "joy", self.on_joy, 1)  # source joy
        self.create_timer(0.1, self.tick)

    def up(self):
        self.set(2)  # step ~joy

    def set(self, gear):
        self.gear = gear  # step ~joy

    def down(self):
        self.lamp = 1

    def honk(self):
        self.horn = 2

    def on_joy(self, msg):
        for button, action in self.actions.items():
            if msg.buttons[button]:  # step ~joy
                action()  # step ~joy
        self.honk()

    def tick(self):
        self.pub.publish(Int32(data=self.gear))  # sink ~joy
        self.pub.publish(Int32(data=self.horn))  # clean


rclpy.init()
rclpy.spin(Gears())
