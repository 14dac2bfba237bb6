#!/usr/bin/env python3
"""Fly a row at constant height and sow. Throttle by a PD controller around the throttle of hovering."""

import rclpy
from geometry_msgs.msg import Vector3
from rclpy.node import Node
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, Float32, String


class SeedDrone(Node):
    def __init__(self):
        super().__init__("seed_drone")
        self.declare_parameters(
            "",
            [
                ("height", 3.0),  # height above the ground, on which the swath depends (m)
                ("climb_rate", 0.8),  # m/s
                ("hover_throttle", 0.49),
                ("kp", 0.24),
                ("kd", 0.20),
                ("row_speed", 4.0),  # m/s
                ("row_length", 56.0),  # m
            ],
        )
        self.height = self.get_parameter("height").value
        self.climb_rate = self.get_parameter("climb_rate").value
        self.hover_throttle = self.get_parameter("hover_throttle").value
        self.kp = self.get_parameter("kp").value
        self.kd = self.get_parameter("kd").value
        self.row_speed = self.get_parameter("row_speed").value
        self.row_length = self.get_parameter("row_length").value

        self.altitude = None
        self.climb = 0.0
        self.setpoint = 0.2
        self.flown = 0.0
        self.seeds = 0.0
        self.state = "TAKEOFF"
        self.throttle_pub = self.create_publisher(Float32, "fcu/throttle", 10)
        self.speed_pub = self.create_publisher(Float32, "fcu/forward", 10)
        self.gate_pub = self.create_publisher(Bool, "hopper/gate", 10)
        self.state_pub = self.create_publisher(String, "mission/state", 10)
        self.create_subscription(Range, "altimeter", self.on_range, 10)
        self.create_subscription(Vector3, "fcu/velocity", self.on_velocity, 10)
        self.create_subscription(Float32, "hopper/weight", self.on_weight, 10)
        self.dt = 0.1
        self.timer = self.create_timer(self.dt, self.loop)

    def on_range(self, msg):
        if msg.min_range <= msg.range <= msg.max_range:
            self.altitude = msg.range

    def on_velocity(self, msg):
        self.climb = msg.z
        self.flown += max(0.0, msg.x) * self.dt

    def on_weight(self, msg):
        if msg.data < 0.1 <= self.seeds:
            self.get_logger().warn("hopper is empty")
        self.seeds = msg.data

    def throttle(self):
        error = self.setpoint - self.altitude
        output = self.hover_throttle + self.kp * error - self.kd * self.climb
        return min(0.95, max(0.15, output))

    def forward(self):
        if self.state != "SOW":
            return 0.0
        left = self.row_length - self.flown
        return min(self.row_speed, max(0.5, 0.8 * left))

    def loop(self):
        if self.altitude is None:
            return
        if self.state == "TAKEOFF":
            self.setpoint = min(self.height, self.setpoint + self.climb_rate * self.dt)
            if self.setpoint >= self.height and abs(self.climb) < 0.15:
                self.state = "SOW"
        elif self.state == "SOW" and self.flown >= self.row_length:
            self.state = "HOVER"
            self.get_logger().info(f"row done, {self.seeds:.1f} kg of seeds left")
        self.throttle_pub.publish(Float32(data=self.throttle()))
        self.speed_pub.publish(Float32(data=self.forward()))
        self.gate_pub.publish(Bool(data=self.state == "SOW"))
        self.state_pub.publish(String(data=self.state))


def main(args=None):
    rclpy.init(args=args)
    drone = SeedDrone()
    try:
        rclpy.spin(drone)
    except KeyboardInterrupt:
        pass
    drone.destroy_node()


if __name__ == "__main__":
    main()
