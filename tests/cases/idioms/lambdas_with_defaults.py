"""Subscriptions in a loop with lambdas: values bound early by default arguments."""

import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Range
from std_msgs.msg import Float32, Int32


class Ring(Node):
    SIDES = ("left", "right", "front")

    def __init__(self):
        super().__init__("ring")
        self.latest = {}
        self.scale = self.declare_parameter("scale", 100.0).value
        self.worst = self.create_publisher(Float32, "worst", 10)
        self.index = self.create_publisher(Int32, "index", 10)
        for i, side in enumerate(self.SIDES):
            out = self.create_publisher(Float32, f"{side}/cm", 10)
            self.create_subscription(Range, f"{side}/range", lambda msg, key=side, pub=out: self.take(key, pub, msg), qos_profile_sensor_data)  # source range
            self.create_subscription(Float32, f"{side}/offset", lambda _, n=i: self.index.publish(Int32(data=n)), 10)
        self.create_timer(0.2, lambda: self.tick())

    def take(self, key, pub, msg):
        self.latest[key] = msg.range
        pub.publish(Float32(data=msg.range * self.scale))  # sink range

    def tick(self):
        if len(self.latest) < len(self.SIDES):
            return
        side, distance = min(self.latest.items(), key=lambda item: item[1])
        self.worst.publish(Float32(data=distance))  # sink range
        self.index.publish(Int32(data=self.SIDES.index(side)))  # sink ~range
        self.index.publish(Int32(data=len(self.SIDES)))  # clean


def main(args=None):
    rclpy.init(args=args)
    node = Ring()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()


if __name__ == "__main__":
    main()
