#!/usr/bin/env python3
"""Lays a bead of sealant along a seam. The pump follows the speed of the robot's tool."""

import rclpy
from geometry_msgs.msg import Vector3
from pump import Pump
from rclpy.node import Node
from std_msgs.msg import Bool, Float64, String

RECIPES = {
    "door_panel": {"area": 12.0, "start_boost": 1.15, "boost_time": 0.2},
    "tailgate": {"area": 16.0, "start_boost": 1.25, "boost_time": 0.3},
}

# viscosity of the sealant as a function of the barrel's temperature
REFERENCE_TEMP = 25.0  # degC
LEAK_PER_DEGREE = 0.004
COLD = 18.0
HOT = 34.0


class GlueDispenser(Node):
    def __init__(self):
        super().__init__("glue_dispenser")
        self.declare_parameter("recipe", "door_panel")
        self.declare_parameter("rate", 20.0)
        self.declare_parameter("speed_filter", 0.7)
        self.declare_parameter("min_tool_speed", 0.02)
        self.declare_parameter("max_tool_speed", 0.6)
        self.recipe = RECIPES[self.get_parameter("recipe").value]
        self.dt = 1.0 / self.get_parameter("rate").value
        self.alpha = self.get_parameter("speed_filter").value
        self.slowest = self.get_parameter("min_tool_speed").value
        self.fastest = self.get_parameter("max_tool_speed").value

        self.pump = Pump()
        self.tool_speed = 0.0
        self.temperature = REFERENCE_TEMP
        self.on_path = False
        self.started = None

        self.rpm_pub = self.create_publisher(Float64, "pump/rpm", 10)
        self.state_pub = self.create_publisher(String, "dispenser/state", 10)
        self.create_subscription(Vector3, "tool/velocity", self.on_velocity, 10)
        self.create_subscription(Float64, "barrel/temperature", self.on_temperature, 10)
        self.create_subscription(Bool, "tool/on_path", self.on_path_flag, 10)
        self.timer = self.create_timer(self.dt, self.tick)

    def on_velocity(self, msg):
        speed = (msg.x**2 + msg.y**2 + msg.z**2) ** 0.5
        speed = min(speed, self.fastest)
        self.tool_speed = self.alpha * speed + (1.0 - self.alpha) * self.tool_speed

    def on_temperature(self, msg):
        self.temperature = msg.data
        if msg.data < COLD or msg.data > HOT:
            self.get_logger().warn("sealant at %.1f degC" % msg.data)

    def on_path_flag(self, msg):
        if msg.data and not self.on_path:
            self.started = self.get_clock().now()
        self.on_path = msg.data

    def slip(self):
        """Warm sealant slips back through the pump."""
        return 1.0 + LEAK_PER_DEGREE * (self.temperature - REFERENCE_TEMP)

    def boost(self):
        since = (self.get_clock().now() - self.started).nanoseconds * 1e-9
        return self.recipe["start_boost"] if since < self.recipe["boost_time"] else 1.0

    def tick(self):
        if not self.on_path or self.tool_speed < self.slowest:
            self.rpm_pub.publish(Float64(data=self.pump.stop()))
            return
        flow = self.recipe["area"] * self.tool_speed * self.slip() * self.boost()
        rpm = self.pump.command(flow, self.dt)
        self.rpm_pub.publish(Float64(data=rpm))
        self.state_pub.publish(String(data="bead"))


def main():
    rclpy.init()
    node = GlueDispenser()
    rclpy.spin(node)


if __name__ == "__main__":
    main()
