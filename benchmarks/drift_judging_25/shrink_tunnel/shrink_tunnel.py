#!/usr/bin/env python3
"""Shrink tunnel of a packing line: holds the temperature of its air, and carries packs through at one speed."""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Temperature
from std_msgs.msg import Bool, Float32, Int32
from std_srvs.srv import SetBool


class HeaterBank:
    """Heaters with a proportional band and a slow integral, as a duty from 0 to 1."""

    SETPOINT = 160.0  # C
    BAND = 12.0
    INTEGRAL = 0.004
    TRIP = 195.0

    def __init__(self):
        self.windup = 0.5
        self.tripped = False

    def duty(self, air):
        if air > self.TRIP:
            self.tripped = True
        if self.tripped:
            return 0.0
        error = self.SETPOINT - air
        self.windup = min(1.0, max(0.0, self.windup + self.INTEGRAL * error))
        return min(1.0, max(0.0, error / self.BAND + self.windup))


class Mains:
    """Running mean of the voltage, with its extremes since the last report."""

    def __init__(self):
        self.mean = None
        self.low = 999.0
        self.high = 0.0

    def add(self, volts):
        self.mean = volts if self.mean is None else self.mean + 0.2 * (volts - self.mean)
        self.low = min(self.low, volts)
        self.high = max(self.high, volts)

    def text(self):
        text = "unknown" if self.mean is None else f"{self.mean:.0f} V ({self.low:.0f} to {self.high:.0f})"
        self.low, self.high = 999.0, 0.0
        return text


class ShrinkTunnel(Node):
    BELT = 0.32  # m/s
    READY = 152.0  # C
    COOL_DOWN = 80.0
    JAM = 12.0  # s that the exit may be blocked

    def __init__(self):
        super().__init__("shrink_tunnel")
        self.heaters = HeaterBank()
        self.mains = Mains()
        self.air = None
        self.ready = False
        self.wanted = True
        self.blocked_since = None
        self.packs = 0
        self.belt_pub = self.create_publisher(Float32, "tunnel/belt", 1)
        self.heat_pub = self.create_publisher(Float32, "tunnel/heat", 1)
        self.ready_pub = self.create_publisher(Bool, "tunnel/ready", 1)
        self.packs_pub = self.create_publisher(Int32, "tunnel/packs", 1)
        self.create_subscription(Temperature, "tunnel/air", self.on_air, 5)
        self.create_subscription(Float32, "cabinet/mains", self.on_mains, 5)
        self.create_subscription(Bool, "exit/blocked", self.on_exit, 5)
        self.create_service(SetBool, "tunnel/run", self.on_run)
        self.create_timer(0.5, self.control)
        self.create_timer(10.0, self.report)

    def on_air(self, msg):
        self.air = msg.temperature

    def on_mains(self, msg):
        self.mains.add(msg.data)

    def on_exit(self, msg):
        now = self.get_clock().now()
        if not msg.data:
            if self.blocked_since is not None:
                self.packs += 1
            self.blocked_since = None
        elif self.blocked_since is None:
            self.blocked_since = now

    def on_run(self, request, response):
        self.wanted = request.data
        response.success = not self.heaters.tripped
        response.message = "tripped" if self.heaters.tripped else "ok"
        return response

    def jammed(self):
        if self.blocked_since is None:
            return False
        return (self.get_clock().now() - self.blocked_since).nanoseconds * 1e-9 > self.JAM

    def belt_speed(self):
        """Return the speed of the belt in m/s; it also turns while the tunnel cools down, or it would warp."""
        if self.jammed():
            return 0.0
        if not self.wanted:
            return 0.1 if self.air > self.COOL_DOWN else 0.0
        if not self.ready:
            self.ready = self.air >= self.READY
            return 0.05
        return self.BELT

    def control(self):
        if self.air is None:
            return
        duty = self.heaters.duty(self.air) if self.wanted else 0.0
        belt = self.belt_speed()
        self.heat_pub.publish(Float32(data=float(duty)))
        self.belt_pub.publish(Float32(data=float(belt)))
        self.ready_pub.publish(Bool(data=self.ready))
        self.packs_pub.publish(Int32(data=self.packs))

    def report(self):
        air = -1.0 if self.air is None else self.air
        self.get_logger().info(f"air {air:.0f} C, {self.packs} packs, mains {self.mains.text()}")
        if self.heaters.tripped:
            self.get_logger().error("heaters tripped")


def main(args=None):
    rclpy.init(args=args)
    node = ShrinkTunnel()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
