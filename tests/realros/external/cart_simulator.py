"""The cart of examples/cart_mujoco as a simulator in a process of its own: real rclpy, physics by MuJoCo.

It publishes /clock and /odom, hears /cmd_vel, and serves /step and /reset. The environment variables X and Y (m) place
the cart, FRICTION and PAYLOAD (kg) set up its world. FAULT is one of

- `die STEP`: end with status 3 in this step;
- `hang STEP`: stop answering in this step;
- `slow SECONDS`: start this much later;
- `late SECONDS`: publish the odometry this much after the step has been answered.

With MARK, the name of a file, `die` and `hang` happen only if the file does not exist yet.
"""

import os
import signal
import sys
import time
from contextlib import suppress
from importlib import import_module
from pathlib import Path

import numpy as np
import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

sys.path.insert(0, str(Path(__file__).parents[3] / "examples" / "cart_mujoco"))
world = import_module("world")
FAULT, _, AT = os.environ.get("FAULT", "").partition(" ")


class Cart(Node):
    """The world as a node. It takes the place of the test's bus: the world publishes and reads through it."""

    def __init__(self):
        super().__init__("cart")
        self.ends = {
            "/clock": self.create_publisher(Clock, "/clock", 10),
            "/odom": self.create_publisher(Odometry, "/odom", 10),
        }
        self.create_subscription(Twist, "/cmd_vel", self.on_command, 10)
        self.create_service(Trigger, "/step", self.on_step)
        self.create_service(Trigger, "/reset", self.on_reset)
        self.restart()
        self.create_timer(0.02, self.show)

    def restart(self):
        """Place the cart at its start."""
        friction, payload = (
            float(os.environ.get(name, usual))
            for name, usual in (("FRICTION", world.FRICTION), ("PAYLOAD", world.PAYLOAD))
        )
        self.world = world.World(np.random.default_rng(0), friction, payload)
        cart = self.world.data.joint("cart")
        cart.qpos[0], cart.qpos[1] = float(os.environ.get("X", "0")), float(os.environ.get("Y", "0"))
        self.command, self.steps = None, 1

    def on_command(self, message):
        self.command = message

    def latest(self, _):
        return self.command

    def publish(self, topic, message):
        self.ends[topic].publish(message)

    def show(self):
        """Publish the initial state until the first command, so that a program that connects later has it, too.

        Between the request of a step and the step, the old state must not be published any more.
        """
        if self.steps == 1 and self.command is None:
            self.tell_time()
            self.world.publish(self)

    def tell_time(self):
        clock = Clock()
        clock.clock.sec, clock.clock.nanosec = divmod(round(self.steps * self.world.dt * 1e9), 10**9)
        self.publish("/clock", clock)

    def on_step(self, _, response):
        """Advance by one step of the world."""
        self.steps += 1
        if FAULT in ("die", "hang") and self.steps == int(AT) and once():
            print("the wheels came off", flush=True)
            os._exit(3) if FAULT == "die" else signal.pause()
        self.world.advance(self)
        self.tell_time()
        if FAULT == "late":
            later = self.create_timer(float(AT), lambda: (later.cancel(), self.world.publish(self)))
        else:
            self.world.publish(self)
        response.success = True
        return response

    def on_reset(self, _, response):
        """Start again."""
        self.restart()
        self.show()
        response.success = True
        return response


def once():
    """Return whether the fault is still to happen."""
    if "MARK" not in os.environ:
        return True
    mark = Path(os.environ["MARK"])
    happened = mark.exists()
    mark.touch()
    return not happened


if __name__ == "__main__":
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        if FAULT == "slow":
            time.sleep(float(AT))
        rclpy.init()
        rclpy.spin(Cart())
