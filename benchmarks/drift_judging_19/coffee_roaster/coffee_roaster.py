#!/usr/bin/env python3
"""Drum roaster: charges green coffee, dries it, browns it, develops it after the first crack, and drops it."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, String

PERIOD = 1.0  # s
CHARGE, DRY, BROWN, DEVELOP, DROPPED = "charge", "dry", "brown", "develop", "dropped"


class CoffeeRoaster(Node):
    def __init__(self):
        super().__init__("coffee_roaster")
        self.dry_power = self.declare_parameter("dry_power", 0.49).value  # share of the burner
        self.brown_power = self.declare_parameter("brown_power", 0.5).value
        self.develop_power = self.declare_parameter("develop_power", 0.52).value
        self.dry_end = self.declare_parameter("dry_end", 150.0).value  # degrees
        self.crack = self.declare_parameter("crack", 196.0).value
        self.drop_temp = self.declare_parameter("drop_temp", 211.0).value
        self.brown_rise = self.declare_parameter("brown_rise", 0.23).value  # degrees per second
        self.rise_gain = self.declare_parameter("rise_gain", 1.2).value
        self.rise_share = self.declare_parameter("rise_share", 0.1).value
        self.dry_fan = self.declare_parameter("dry_fan", 0.35).value
        self.brown_fan = self.declare_parameter("brown_fan", 0.5).value
        self.develop_fan = self.declare_parameter("develop_fan", 0.7).value
        self.wet_above = self.declare_parameter("wet_above", 18.0).value  # %, beans that would mould
        self.phase = CHARGE
        self.bean = None
        self.rise = 0.0
        self.charged = False
        self.moisture = 10.5
        self.started = None
        self.burner_pub = self.create_publisher(Float32, "burner/power", 10)
        self.fan_pub = self.create_publisher(Float32, "fan/speed", 10)
        self.door_pub = self.create_publisher(Bool, "door/open", 10)
        self.phase_pub = self.create_publisher(String, "roaster/phase", 10)
        self.create_subscription(Float32, "bean/temperature", self.on_bean, 10)
        self.create_subscription(Float32, "green/moisture", self.on_moisture, 10)
        self.create_subscription(Bool, "drum/charged", self.on_charged, 10)
        self.create_timer(PERIOD, self.tick)

    def on_bean(self, msg):
        if self.bean is not None:
            self.rise += self.rise_share * ((msg.data - self.bean) / PERIOD - self.rise)
        self.bean = msg.data

    def on_moisture(self, msg):
        self.moisture = msg.data
        if self.moisture > self.wet_above:
            self.get_logger().warn(f"beans have {self.moisture:.1f} % of water, do not store them")

    def on_charged(self, msg):
        self.charged = msg.data

    def to(self, phase):
        self.get_logger().info(f"{self.phase} -> {phase} at {self.bean:.1f} degrees")
        self.phase = phase

    def tick(self):
        if self.bean is None:
            return
        power, fan = 0.1, self.dry_fan
        if self.phase == CHARGE:
            if self.charged:
                self.to(DRY)
        elif self.phase == DRY:
            power = self.dry_power
            if self.bean >= self.dry_end:
                self.to(BROWN)
        elif self.phase == BROWN:
            power = self.brown_power + self.rise_gain * (self.brown_rise - self.rise)
            fan = self.brown_fan
            if self.bean >= self.crack:
                self.to(DEVELOP)
        elif self.phase == DEVELOP:
            power = self.develop_power
            fan = self.develop_fan
            if self.bean >= self.drop_temp:
                self.to(DROPPED)
        else:
            power, fan = 0.0, 1.0
        self.burner_pub.publish(Float32(data=max(0.0, min(1.0, power))))
        self.fan_pub.publish(Float32(data=fan))
        self.door_pub.publish(Bool(data=self.phase == DROPPED))
        self.phase_pub.publish(String(data=self.phase))


def main():
    rclpy.init()
    node = CoffeeRoaster()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
