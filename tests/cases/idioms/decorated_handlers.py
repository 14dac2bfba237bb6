"""Handlers behind decorators: logging of exceptions, locks, rate limits, registration in a table."""

import functools
import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import Joy
from std_msgs.msg import Bool, String

HANDLERS = {}


def handles(command):
    def register(function):
        HANDLERS[command] = function
        return function

    return register


def logged(function):
    @functools.wraps(function)
    def wrapper(self, *args, **kwargs):
        try:
            return function(self, *args, **kwargs)
        except Exception as error:  # noqa: BLE001
            self.get_logger().error(f"{function.__name__}: {error}")
            return None

    return wrapper


def locked(function):
    @functools.wraps(function)
    def wrapper(self, *args):
        with self.lock:
            return function(self, *args)

    return wrapper


def at_most(hertz):
    def decorate(function):
        last = [0.0]

        @functools.wraps(function)
        def wrapper(*args):
            now = time.monotonic()
            if now - last[0] < 1.0 / hertz:
                return None
            last[0] = now
            return function(*args)

        return wrapper

    return decorate


class Teleop(Node):
    def __init__(self):
        super().__init__("teleop")
        self.lock = threading.RLock()
        self.speed = 0.0
        self.enabled = False
        self.cmd = self.create_publisher(Twist, "cmd_vel", 10)
        self.status = self.create_publisher(String, "status", 10)
        self.create_subscription(Joy, "joy", self.on_joy, 10)  # source joy
        self.create_subscription(Bool, "enable", self.on_enable, 10)  # source enable
        self.create_subscription(String, "command", self.on_command, 10)  # source command
        self.create_timer(0.05, self.send)

    @logged
    @locked
    def on_joy(self, msg):
        self.speed = msg.axes[1] * 0.8

    @locked
    def on_enable(self, msg):
        self.enabled = msg.data

    def on_command(self, msg):
        handler = HANDLERS.get(msg.data)
        if handler is not None:
            handler(self)

    @handles("stop")
    def stop(self):
        self.cmd.publish(Twist())  # sink ~command

    @handles("hello")
    def hello(self):
        self.status.publish(String(data="hello"))  # sink ~command

    @at_most(20.0)
    @locked
    def send(self):
        twist = Twist()
        if self.enabled:
            twist.linear.x = self.speed
        self.cmd.publish(twist)  # sink joy ~enable
        self.report()

    @at_most(1.0)
    def report(self):
        self.status.publish(String(data="running"))  # clean


def main():
    rclpy.init()
    rclpy.spin(Teleop())


if __name__ == "__main__":
    main()
