#!/usr/bin/env python3
"""Keeps an unmanned hot-air balloon at the altitudes of a flight plan with short burns and, if need be, the vent."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, String


class BalloonPilot(Node):
    def __init__(self):
        super().__init__("balloon_pilot")
        self.declare_parameters(
            "",
            [
                ("burn_time", 3.0),
                ("burn_pause", 6.0),
                ("vent_time", 1.0),
                ("vent_pause", 10.0),
                ("climb_band", 0.2),
                ("approach", 0.1),
                ("max_climb", 2.5),
                ("max_sink", 2.0),
                ("vario_filter", 0.5),
                ("low_fuel", 4.0),
            ],
        )
        self.altitude = None
        self.climb = 0.0
        self.wanted = None
        self.fuel = float("inf")
        self.burning_until = 0.0
        self.venting_until = 0.0
        self.quiet_until = 0.0

        self.burner = self.create_publisher(Bool, "burner/open", 1)
        self.vent = self.create_publisher(Bool, "vent/open", 1)
        self.status = self.create_publisher(String, "pilot/status", 1)
        self.create_subscription(Float32, "altimeter", self.altitude_cb, 5)
        self.create_subscription(Float32, "vario", self.vario_cb, 5)
        self.create_subscription(Float32, "fuel", self.fuel_cb, 1)
        self.create_subscription(Float32, "plan/altitude", self.plan_cb, 1)
        self.create_timer(0.5, self.control)

    def param(self, name):
        return self.get_parameter(name).value

    def now(self):
        return self.get_clock().now().nanoseconds * 1e-9

    def altitude_cb(self, msg):
        self.altitude = msg.data

    def vario_cb(self, msg):
        self.climb += self.param("vario_filter") * (msg.data - self.climb)

    def fuel_cb(self, msg):
        self.fuel = msg.data

    def plan_cb(self, msg):
        if self.wanted != msg.data:
            self.get_logger().info(f"new altitude {msg.data:.0f} m, {self.fuel:.1f} kg left")
        self.wanted = msg.data

    def wanted_climb(self):
        """Return the climb in m/s that leads to the wanted altitude without overshoot."""
        missing = self.wanted - self.altitude
        return max(-self.param("max_sink"), min(self.param("max_climb"), self.param("approach") * missing))

    def control(self):
        if self.altitude is None or self.wanted is None:
            return
        now = self.now()
        if now >= self.quiet_until:
            error = self.wanted_climb() - self.climb
            if error > self.param("climb_band"):
                self.burning_until = now + self.param("burn_time")
                self.quiet_until = self.burning_until + self.param("burn_pause")
            elif error < -2.0 * self.param("climb_band"):
                self.venting_until = now + self.param("vent_time")
                self.quiet_until = self.venting_until + self.param("vent_pause")
        if self.fuel < self.param("low_fuel"):
            self.status.publish(String(data="land"))
        else:
            self.status.publish(String(data="burn" if now < self.burning_until else "drift"))
        self.burner.publish(Bool(data=now < self.burning_until))
        self.vent.publish(Bool(data=now < self.venting_until))


def main():
    rclpy.init()
    node = BalloonPilot()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()


if __name__ == "__main__":
    main()
