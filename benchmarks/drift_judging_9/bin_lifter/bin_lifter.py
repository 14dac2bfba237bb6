"""Clamp a bin at the kerb, lift it over the hopper, tip it and put it back."""

import enum

import gripping
import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32


class Phase(enum.Enum):
    WAIT = 0
    CLAMP = 1
    LIFT = 2
    TIP = 3
    LOWER = 4


class BinLifter(Node):
    LIFTED = 2.4  # m
    LIFT_SPEED = 0.8  # m/s
    LOWER_SPEED = 0.6
    SLOW_BELOW = 0.3  # m
    TIP_TICKS = 12
    SETTLE = 3  # number of ticks with the full force

    def __init__(self):
        super().__init__("bin_lifter")
        self.clamp = gripping.ClampConfig()
        self.phase = Phase.WAIT
        self.present = False
        self.height = 0.0
        self.mass = gripping.FULL_BIN
        self.force = 0.0
        self.ticks = 0
        self.create_subscription(Bool, "bin/present", self.on_present, 10)
        self.create_subscription(Float32, "bin/scale", self.on_scale, 10)
        self.create_subscription(Float32, "arm/height", self.on_height, 10)
        self.clamp_pub = self.create_publisher(Float32, "clamp/force", 10)
        self.speed_pub = self.create_publisher(Float32, "arm/speed", 10)
        self.tip_pub = self.create_publisher(Bool, "arm/tip", 10)
        self.create_timer(0.1, self.tick)

    def on_present(self, msg):
        self.present = msg.data

    def on_scale(self, msg):
        self.mass = msg.data

    def on_height(self, msg):
        self.height = msg.data

    def enter(self, phase):
        self.get_logger().debug(f"{self.phase.name} -> {phase.name}")
        self.phase = phase
        self.ticks = 0

    def tick(self):
        self.ticks += 1
        speed, wanted = 0.0, gripping.holding_force(self.clamp, self.mass)
        if self.phase is Phase.WAIT:
            wanted = 0.0
            if self.present and self.mass < gripping.FULL_BIN:
                self.enter(Phase.CLAMP)
        elif self.phase is Phase.CLAMP:
            if self.force < 0.97 * wanted:
                self.ticks = 0
            elif self.ticks > self.SETTLE:
                self.enter(Phase.LIFT)
        elif self.phase is Phase.LIFT:
            speed = self.LIFT_SPEED * (0.5 if self.height < self.SLOW_BELOW else 1.0)
            if self.height >= self.LIFTED:
                self.enter(Phase.TIP)
        elif self.phase is Phase.TIP:
            if self.ticks > self.TIP_TICKS:
                self.enter(Phase.LOWER)
        elif self.phase is Phase.LOWER:
            speed = -self.LOWER_SPEED * (0.5 if self.height < self.SLOW_BELOW else 1.0)
            if self.height <= 0.0:
                self.enter(Phase.WAIT)
        self.force = gripping.squeeze(self.clamp, self.force, wanted)
        self.clamp_pub.publish(Float32(data=self.force))
        self.speed_pub.publish(Float32(data=speed))
        self.tip_pub.publish(Bool(data=self.phase is Phase.TIP))


def main(args=None):
    rclpy.init(args=args)
    node = BinLifter()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
