#!/usr/bin/env python3
"""Water the pots along a rail: drive to a pot, pump its dose, wait until the hose has stopped dripping."""

from enum import Enum

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float64, Float64MultiArray


class State(Enum):
    """The states of the cart."""

    WAIT_FOR_JOB = 0
    DRIVE = 1
    PUMP = 2
    DRIP = 3
    DONE = 4


class Waterer(Node):
    """State machine on a 10 Hz timer."""

    def __init__(self):
        super().__init__("waterer")
        self.travel_speed = self.declare_parameter("travel_speed", 0.4).value
        self.arrive_within = self.declare_parameter("arrive_within", 0.02).value
        self.ml_per_second = self.declare_parameter("ml_per_second", 20.0).value
        self.prime_time = self.declare_parameter("prime_time", 0.3).value
        self.drip_time = self.declare_parameter("drip_time", 0.4).value
        self.max_dose = self.declare_parameter("max_dose_ml", 200.0).value
        self.state = State.WAIT_FOR_JOB
        self.pots = []
        self.doses = []
        self.current = 0
        self.position = 0.0
        self.pump_until = 0.0
        self.create_subscription(Float64, "rail/position", self.position_cb, 10)
        self.create_subscription(Float64MultiArray, "job/pots", self.pots_cb, 10)
        self.create_subscription(Float64MultiArray, "job/doses", self.doses_cb, 10)
        self.speed_pub = self.create_publisher(Float64, "rail/speed", 10)
        self.pump_pub = self.create_publisher(Bool, "pump", 10)
        self.done_pub = self.create_publisher(Bool, "job/done", 10)
        self.timer = self.create_timer(0.1, self.tick)

    def now(self):
        """Return the time in s."""
        return self.get_clock().now().nanoseconds * 1e-9

    def position_cb(self, msg):
        """Store the position on the rail."""
        self.position = msg.data

    def pots_cb(self, msg):
        """Store the positions of the pots."""
        self.pots = list(msg.data)

    def doses_cb(self, msg):
        """Store the dose of each pot in ml."""
        self.doses = list(msg.data)

    def pump_time(self, dose):
        """Return how long the pump must run for a dose."""
        return self.prime_time + min(dose, self.max_dose) / self.ml_per_second

    def tick(self):
        """Run one step of the state machine."""
        if self.state == State.WAIT_FOR_JOB:
            if self.pots and len(self.pots) == len(self.doses):
                self.state = State.DRIVE
        elif self.state == State.DRIVE:
            self.drive()
        elif self.state == State.PUMP and self.now() >= self.pump_until:
            self.pump_pub.publish(Bool(data=False))
            self.pump_until += self.drip_time
            self.state = State.DRIP
        elif self.state == State.DRIP and self.now() >= self.pump_until:
            self.current += 1
            self.state = State.DRIVE if self.current < len(self.pots) else State.DONE
        elif self.state == State.DONE:
            self.done_pub.publish(Bool(data=True))

    def drive(self):
        """Go to the current pot; start the pump once the cart is there."""
        left = self.pots[self.current] - self.position
        if abs(left) > self.arrive_within:
            speed = max(-self.travel_speed, min(self.travel_speed, 3.0 * left))
            self.speed_pub.publish(Float64(data=speed))
            return
        self.speed_pub.publish(Float64(data=0.0))
        self.pump_until = self.now() + self.pump_time(self.doses[self.current])
        self.pump_pub.publish(Bool(data=True))
        self.state = State.PUMP


def main(args=None):
    """Run the node."""
    rclpy.init(args=args)
    node = Waterer()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()


if __name__ == "__main__":
    main()
