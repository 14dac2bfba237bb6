#!/usr/bin/env python3
"""Drum sander for wooden floors: sands a strip from wall to wall, with a pressure that suits the grit of this pass."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import Range
from std_msgs.msg import Float32, String, UInt8

PRESSURE = [(24, 95.0), (40, 80.0), (60, 60.0), (100, 38.0)]  # N on the drum, by grit
SPECIES = ["?", "oak", "beech", "pine", "larch", "cork"]
WALL = 0.3  # m


class ParquetSander(Node):
    def __init__(self):
        super().__init__("parquet_sander")
        self.declare_parameters("", [("grit", 60), ("feed", 0.25), ("soft_start", 25.0)])
        self.grit = self.get_parameter("grit").value
        self.feed = self.get_parameter("feed").value
        self.soft_start = self.get_parameter("soft_start").value  # N per tick
        self.mode = "wait"
        self.species = 0
        self.ahead = None
        self.force = 0.0
        self.drive = self.create_publisher(Twist, "cmd_vel", 1)
        self.drum = self.create_publisher(Float32, "drum/force", 1)
        self.mode_pub = self.create_publisher(String, "sander/mode", 1)
        self.create_subscription(Range, "front/range", self.on_range, 1)
        self.create_subscription(UInt8, "floor/species", self.on_species, 1)
        self.create_timer(0.2, self.on_timer)

    def on_range(self, msg):
        self.ahead = msg.range

    def on_species(self, msg):
        if msg.data != self.species and msg.data < len(SPECIES):
            self.get_logger().info("now on %s" % SPECIES[msg.data])
        self.species = msg.data

    def pressure(self):
        for grit, force in PRESSURE:
            if self.grit <= grit:
                return force
        return 30.0

    def next_mode(self):
        if self.ahead is None:
            return "wait"
        if self.mode == "sand" and self.ahead < WALL or self.mode == "lift":
            return "lift"
        return "sand"

    def on_timer(self):
        self.mode = self.next_mode()
        twist = Twist()
        if self.mode == "sand":
            twist.linear.x = self.feed
            self.force = min(self.pressure(), self.force + self.soft_start)
        else:
            self.force = 0.0
        self.drive.publish(twist)
        self.drum.publish(Float32(data=self.force))
        self.mode_pub.publish(String(data=self.mode))


def main(args=None):
    rclpy.init(args=args)
    node = ParquetSander()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
