"""A simulator of a water tank in a separate process, on real rclpy; environment variables request faults.

It publishes /clock and /level, hears /valve, and serves /step and /reset. With OWN_TIME it runs by itself.
"""

import fcntl
import os
import subprocess
import sys
import time
from pathlib import Path

import rclpy
from diagnostic_msgs.srv import SelfTest
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64

DT = 0.1  # s
FAULT, _, AT = os.environ.get("FAULT", "").partition(" ")


class Tank(Node):
    """Level in m, valve in m/s at full pump."""

    def __init__(self):
        super().__init__("tank")
        self.clock_end = self.create_publisher(Clock, "/clock", 10)
        self.level_end = self.create_publisher(Float64, "/level", 10)
        self.create_subscription(Float64, "/valve", self.on_valve, 10)
        self.create_service(SelfTest, "/step", self.on_step)
        self.create_service(SelfTest, "/reset", self.on_reset)
        self.restart()
        own = "OWN_TIME" in os.environ
        self.create_timer(0.01, self.tick if own else self.repeat)

    def restart(self):
        self.level, self.valve, self.steps = float(os.environ.get("START", "0.1")), 0.0, 1
        self.touched, self.moves = False, 0  # whether the test has done anything, and the steps since then

    def on_valve(self, message):
        self.valve, self.touched = message.data, True

    def repeat(self):
        """Show the initial state until the first step."""
        if not self.touched:
            self.publish()

    def tick(self):
        if FAULT == "jump" and self.moves == int(AT):
            self.steps = 0
        self.advance()

    def advance(self):
        self.level += DT * float(os.environ.get("PUMP", "1")) * self.valve
        self.steps += 1
        self.moves += self.touched
        if FAULT == "die" and self.moves == int(AT) and once():
            print("out of water", flush=True)
            os._exit(3)
        if FAULT == "hang" and self.moves == int(AT) and once():
            time.sleep(600)
        self.publish()

    def publish(self):
        if FAULT == "late" and self.touched:
            time.sleep(0.05)
        now = self.steps * 100_000_000
        clock = Clock()
        clock.clock.sec, clock.clock.nanosec = divmod(now, 10**9)
        self.clock_end.publish(clock)
        if FAULT == "late" and self.touched:
            time.sleep(0.05)
        if FAULT != "silent":
            self.level_end.publish(Float64(data=self.level))

    def on_step(self, _, response):
        self.touched = True
        self.advance()
        return response

    def on_reset(self, _, response):
        self.restart()
        self.publish()
        return response


def once():
    """Return whether the fault is still to happen; with MARK it happens only once."""
    if "MARK" not in os.environ:
        return True
    mark = Path(os.environ["MARK"])
    happened = mark.exists()
    mark.touch()
    return not happened


if FAULT == "refuse":
    sys.exit("no such world")
if FAULT == "slow":
    time.sleep(float(AT))
if "HELD" in os.environ:  # a lock that is held until this process and its child have ended
    lock = Path(os.environ["HELD"]).open("w")  # noqa: SIM115
    fcntl.flock(lock, fcntl.LOCK_EX)
    print(os.getpid(), file=lock, flush=True)
    subprocess.Popen(["sleep", "600"], pass_fds=[lock.fileno()])
print("filling", flush=True)
rclpy.init()
rclpy.spin(Tank())
