#!/usr/bin/env python3
"""A tank in a process of its own, on a real ROS 2: it publishes /clock and /level, and has services to step and reset.

The environment variables START (m) and PUMP (the share of the commanded inflow that arrives) set up an episode.
"""

import os
from contextlib import suppress

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

DT = 0.1  # s


class Tank(Node):
    """Level in m, inflow in m/s."""

    def __init__(self):
        super().__init__("tank")
        self.clock = self.create_publisher(Clock, "/clock", 10)
        self.gauge = self.create_publisher(Float64, "/level", 10)
        self.create_subscription(Float64, "/valve", self.on_valve, 10)
        self.create_service(Trigger, "/step", self.on_step)
        self.create_timer(0.05, self.show)
        self.level, self.inflow, self.steps = float(os.environ["START"]), None, 1

    def on_valve(self, message):
        """Keep the newest command."""
        self.inflow = message.data

    def show(self):
        """Publish the initial state until the first command, so that nodes that start later receive it, too."""
        if self.inflow is None:
            self.publish()

    def publish(self):
        """Publish time and level."""
        clock = Clock()
        clock.clock.sec, clock.clock.nanosec = divmod(round(self.steps * DT * 1e9), 10**9)
        self.clock.publish(clock)
        self.gauge.publish(Float64(data=self.level))

    def on_step(self, _, response):
        """Advance by DT."""
        self.level += DT * float(os.environ["PUMP"]) * (self.inflow or 0.0)
        self.steps += 1
        self.publish()
        response.success = True
        return response


if __name__ == "__main__":
    rclpy.init()
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(Tank())
