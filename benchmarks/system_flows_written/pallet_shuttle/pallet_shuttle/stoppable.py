"""Base class of the nodes that obey the emergency stop."""

from rclpy.node import Node
from std_msgs.msg import Bool, String


class StoppableNode(Node):
    """Step a subclass at a fixed rate while the stop is released, and publish what it does."""

    def __init__(self, name, period):
        super().__init__(name)
        self.stopped = False
        self._status_pub = self.create_publisher(String, "~/status", 10)
        self.create_subscription(Bool, "estop", self._on_estop, 10)
        self.create_timer(period, self._tick)

    def _on_estop(self, msg):
        self.stopped = msg.data

    def _tick(self):
        if self.stopped:
            self.halt()
            status = "stopped"
        else:
            self.step()
            status = self.activity()
        self._status_pub.publish(String(data=status))

    def halt(self):
        """Command zero."""
        raise NotImplementedError

    def step(self):
        """Command the next step."""
        raise NotImplementedError

    def activity(self):
        """Return what the node is doing."""
        return "running"
