"""Write each change of mode to the logbook from a thread of its own."""

import queue
import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class LogbookNode(Node):
    """Number the entries in a worker, so that a slow disk never holds up the callbacks."""

    def __init__(self):
        super().__init__("logbook_node")
        self.declare_parameter("site", "north")
        self._site = self.get_parameter("site").value
        self._entries = queue.Queue()
        self._entry_pub = self.create_publisher(String, "logbook/entry", 10)
        self.create_subscription(String, "mode", self._on_mode, 10)
        self._worker = threading.Thread(target=self._work, daemon=True)
        self._worker.start()

    def _on_mode(self, msg):
        self._entries.put(msg.data)

    def _work(self):
        number = 0
        while rclpy.ok():
            try:
                mode = self._entries.get(timeout=0.2)
            except queue.Empty:
                continue
            number += 1
            self._entry_pub.publish(String(data=f"{self._site} {number}: {mode}"))


def main(args=None):
    """Run the node until it is shut down."""
    rclpy.init(args=args)
    rclpy.spin(LogbookNode())
    rclpy.shutdown()
