#!/usr/bin/env python3
"""Governor of a small hydro plant that feeds a valley: starts the turbine, holds the frequency, and survives a trip.

The gate is a part of its full opening, frequencies are in Hz.
"""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, String


class TurbineGate(Node):
    STOP, START, GOVERN, TRIP = "stop", "start", "govern", "trip"
    NOMINAL = 50.0

    def __init__(self):
        super().__init__("turbine_gate")
        declare = self.declare_parameter
        self.kp = declare("governor.kp", 0.04).value  # gate per Hz
        self.ki = declare("governor.ki", 0.007).value  # gate per Hz and s
        self.start_gate = declare("start_gate", 0.28).value
        self.no_load_gate = declare("no_load_gate", 0.06).value
        self.run_up_to = declare("run_up_to", 47.5).value
        self.overspeed = declare("overspeed", 64.0).value
        self.state = self.STOP
        self.permitted = False
        self.breaker = False
        self.frequency = 0.0
        self.head = 1.0
        self.integral = 0.0
        self.period = 0.2
        self.gate_pub = self.create_publisher(Float32, "gate/opening", 1)
        self.state_pub = self.create_publisher(String, "governor/state", 1)
        self.create_subscription(Float32, "generator/frequency", self.frequency_cb, 5)
        self.create_subscription(Float32, "penstock/head", self.head_cb, 5)
        self.create_subscription(Bool, "plant/permit", self.permit_cb, 1)
        self.create_subscription(Bool, "breaker/closed", self.breaker_cb, 5)
        self.create_timer(self.period, self.govern)

    def frequency_cb(self, msg):
        self.frequency = msg.data

    def head_cb(self, msg):
        self.head = max(msg.data, 0.98 * self.head)  # the peak, for the log

    def permit_cb(self, msg):
        self.permitted = msg.data
        if not msg.data:
            self.state = self.STOP

    def breaker_cb(self, msg):
        if self.breaker and not msg.data and self.state == self.GOVERN:
            self.get_logger().warning(f"trip at {self.frequency:.1f} Hz")
            self.state = self.TRIP
        self.breaker = msg.data

    def hold(self):
        """Return the gate of a PI governor."""
        error = self.NOMINAL - self.frequency
        self.integral = max(0.0, min(1.0, self.integral + self.ki * error * self.period))
        return self.integral + self.kp * error

    def opening(self):
        if self.state == self.START:
            if self.frequency > self.run_up_to:
                self.integral = self.no_load_gate
                self.state = self.GOVERN
            return self.start_gate
        if self.state == self.GOVERN:
            return self.hold()
        if self.state == self.TRIP:
            if self.frequency < self.NOMINAL + 1.0:
                self.integral = self.no_load_gate
                self.state = self.GOVERN
            return self.no_load_gate
        if self.permitted:
            self.state = self.START
        return 0.0

    def govern(self):
        opening = self.opening()
        if self.frequency > self.overspeed:
            self.get_logger().error(f"overspeed: {self.frequency:.1f} Hz, head peaked at {self.head:.2f}")
            self.permitted = False
            self.state = self.STOP
            opening = 0.0
        opening = max(0.0, min(1.0, opening))
        self.gate_pub.publish(Float32(data=opening))
        self.state_pub.publish(String(data=self.state))


def main(args=None):
    rclpy.init(args=args)
    governor = TurbineGate()
    rclpy.spin(governor)
    governor.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
