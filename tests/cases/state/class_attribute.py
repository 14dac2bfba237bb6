import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32


class Shared:
    speed = 0.0
    limits = [0.0, 1.0]
    name = "shared"


class Writer(Node):
    count = 0
    last = 0.0
    peak = 0.0

    def __init__(self):
        super().__init__("writer")
        self.create_subscription(Float32, "speed", self.on_speed, 10)  # source speed

    def on_speed(self, msg):
        Shared.speed = msg.data
        Shared.limits[0] = msg.data
        type(self).count += 1
        type(self).last = msg.data
        self.__class__.peak = 2.0 * msg.data


class Reader(Node):
    def __init__(self):
        super().__init__("reader")
        self.shared = Shared()
        self.pub = self.create_publisher(Float32, "out", 10)
        self.create_timer(0.5, self.on_timer)

    def on_timer(self):
        self.pub.publish(Float32(data=Shared.speed))  # sink speed
        self.pub.publish(Float32(data=self.shared.speed))  # sink speed
        self.pub.publish(Float32(data=Shared.limits[0]))  # sink speed
        self.pub.publish(Float32(data=float(len(Shared.name))))  # clean
        self.pub.publish(Float32(data=float(Writer.count)))  # clean
        self.pub.publish(Float32(data=Writer.last))  # sink speed
        self.pub.publish(Float32(data=Writer.peak))  # sink speed


def main():
    rclpy.init()
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(Writer())
    executor.add_node(Reader())
    executor.spin()


if __name__ == "__main__":
    main()
