import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64, Int32, String


class Modes(Node):
    def __init__(self):
        super().__init__("modes")
        self.mode = "idle"
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(String, "mode", self.on_mode, 10)  # source mode
        self.create_subscription(Int32, "gear", self.on_gear, 10)  # source gear
        self.create_timer(0.1, self.tick)

    def on_mode(self, msg):
        self.mode = msg.data

    def on_gear(self, msg):
        match msg.data:
            case 0:
                speed = 0.0
            case 1 | 2:
                speed = 0.5
            case n if n > 5:
                speed = 2.0
            case _:
                speed = 1.0
        self.pub.publish(Float64(data=speed))  # sink ~gear

    def tick(self):
        match self.mode:
            case "go":
                self.pub.publish(Float64(data=1.0))  # sink ~mode
            case "stop" | "idle":
                self.pub.publish(Float64(data=0.0))  # sink ~mode
        match 3:
            case 3:
                self.pub.publish(Float64(data=3.0))  # clean
            case _:
                self.pub.publish(Float64(data=4.0))  # clean
        self.pub.publish(Float64(data=2.0))  # clean


def main():
    rclpy.init()
    rclpy.spin(Modes())
