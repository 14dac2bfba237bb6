"""Run the fans: idle, cooling, or defrosting for a fixed number of ticks."""

from enum import Enum, auto

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Temperature
from std_msgs.msg import Bool, Float64, String

DEFROST_TICKS = 40
DEFROST_SPEED = 0.2
GAIN = 0.15


class Mode(Enum):
    """What the fans are doing."""

    IDLE = auto()
    COOL = auto()
    DEFROST = auto()


class FanNode(Node):
    """State machine of the fans, stepped by a timer."""

    def __init__(self):
        super().__init__("fan_node")
        self.declare_parameter("setpoint", 5.0)
        self._setpoint = self.get_parameter("setpoint").value
        self._mode = Mode.IDLE
        self._ticks = 0
        self._celsius = self._setpoint
        self._frost = False
        self._speed_pub = self.create_publisher(Float64, "~/speed", 10)
        self._mode_pub = self.create_publisher(String, "~/mode", 10)
        self.create_subscription(Temperature, "air/temperature", self._on_air, 10)
        self.create_subscription(Bool, "frost_risk", self._on_frost, 10)
        self.create_timer(0.5, self._step)

    def _on_air(self, msg):
        self._celsius = msg.temperature

    def _on_frost(self, msg):
        self._frost = msg.data

    def _next_mode(self):
        if self._mode is Mode.DEFROST:
            self._ticks += 1
            return Mode.IDLE if self._ticks >= DEFROST_TICKS else Mode.DEFROST
        if self._frost:
            self._ticks = 0
            return Mode.DEFROST
        return Mode.COOL if self._celsius > self._setpoint else Mode.IDLE

    def _speed(self):
        if self._mode is Mode.COOL:
            return min(1.0, GAIN * (self._celsius - self._setpoint))
        return DEFROST_SPEED if self._mode is Mode.DEFROST else 0.0

    def _step(self):
        self._mode = self._next_mode()
        self._speed_pub.publish(Float64(data=self._speed()))
        self._mode_pub.publish(String(data=self._mode.name.lower()))


def main(args=None):
    """Run the node until it is shut down."""
    rclpy.init(args=args)
    rclpy.spin(FanNode())
    rclpy.shutdown()
