"""Turn orders into targets of the drive and requests to the lift."""

from functools import partial

import rclpy
from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool

from pallet_shuttle.orders import parse_order


class MissionNode(Node):
    """Pass on each order and report what the lift answered."""

    def __init__(self):
        super().__init__("mission_node")
        self._target_pub = self.create_publisher(PointStamped, "~/target", 10)
        self._report_pub = self.create_publisher(String, "~/report", 10)
        self._lift = self.create_client(SetBool, "lift/raise")
        self.create_subscription(String, "orders", self._on_order, 10)

    def _on_order(self, msg):
        try:
            order = parse_order(msg.data)
        except ValueError as error:
            self.get_logger().error(f"order left out: {error}")
            return
        target = PointStamped()
        target.header.stamp = self.get_clock().now().to_msg()
        target.point.x = order.position
        self._target_pub.publish(target)
        future = self._lift.call_async(SetBool.Request(data=order.up))
        future.add_done_callback(partial(self._on_lifted, order.label))

    def _on_lifted(self, label, future):
        verdict = "done" if future.result().success else "refused"
        self._report_pub.publish(String(data=f"{label} {verdict}"))


def main(args=None):
    """Run the node until it is shut down."""
    rclpy.init(args=args)
    rclpy.spin(MissionNode())
    rclpy.shutdown()
