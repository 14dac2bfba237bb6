"""Raise and lower the pallet on request."""

import rclpy
from std_msgs.msg import Float64
from std_srvs.srv import SetBool

from pallet_shuttle.stoppable import StoppableNode

HOLD_POWER = 0.1
STROKE_TICKS = 30


class LiftNode(StoppableNode):
    """Move the fork by a timed stroke, with more power under a heavier load."""

    def __init__(self):
        super().__init__("lift_node", 0.1)
        self.declare_parameter("max_load", 800.0)
        self._max_load = self.get_parameter("max_load").value
        self._load = 0.0
        self._want_up = False
        self._height = 0
        self._power_pub = self.create_publisher(Float64, "~/power", 10)
        self.create_subscription(Float64, "load", self._on_load, 10)
        self.create_service(SetBool, "~/raise", self._on_raise)

    def _on_load(self, msg):
        self._load = msg.data

    def _on_raise(self, request, response):
        if self._load > self._max_load:
            self.get_logger().warning(f"overloaded: {self._load:.0f} kg")
            response.success = False
        else:
            self._want_up = request.data
            response.success = True
        response.message = "noted"
        return response

    def halt(self):
        """Cut the power; the brake holds the fork."""
        self._power_pub.publish(Float64(data=0.0))

    def step(self):
        """Go one tick up or down, or hold."""
        power = HOLD_POWER
        if self._want_up and self._height < STROKE_TICKS:
            self._height += 1
            power = 0.3 + 0.7 * self._load / self._max_load
        elif not self._want_up and self._height > 0:
            self._height -= 1
            power = 0.05
        self._power_pub.publish(Float64(data=power))


def main(args=None):
    """Run the node until it is shut down."""
    rclpy.init(args=args)
    rclpy.spin(LiftNode())
    rclpy.shutdown()
