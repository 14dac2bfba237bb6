"""Configuring creates the publishers; a helper class owns its subscription and returns results through a callback."""

from typing import Callable, Optional

from rclpy.lifecycle import Node, State, TransitionCallbackReturn
import rclpy
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Float32


class Watcher:
    def __init__(self, node: Node, topic: str, on_change: Callable[[float], None], threshold: float = 0.5):
        self.node = node
        self.on_change = on_change
        self.threshold = threshold
        self.subscription = node.create_subscription(Float32, topic, self._receive, 10)  # source watched

    def _receive(self, msg: Float32) -> None:
        if abs(msg.data) > self.threshold:
            self.on_change(msg.data)


class Mapper(Node):
    def __init__(self):
        super().__init__("mapper")
        self.pub = None
        self.level = 0.0
        self.changed: Optional[float] = None
        self.grid = OccupancyGrid()
        self.grid.info.width = 10
        self.watcher = Watcher(self, "level", self.changed_level)

    def on_configure(self, state: State) -> TransitionCallbackReturn:
        self.pub = self.create_lifecycle_publisher(OccupancyGrid, "map", 10)
        self.out = self.create_lifecycle_publisher(Float32, "level_out", 10)
        self.create_subscription(PointCloud2, "cloud", self.on_cloud, 10)  # source cloud
        self.timer = self.create_timer(1.0, self.publish_map)
        return TransitionCallbackReturn.SUCCESS

    def changed_level(self, value):
        self.changed = value

    def on_cloud(self, msg):
        for i, byte in enumerate(msg.data):
            self.grid.data[i] = byte
        self.grid.header.stamp = self.get_clock().now().to_msg()

    def publish_map(self):
        if self.pub is not None and self.pub.is_activated:
            self.pub.publish(self.grid)  # sink cloud
        if self.changed is not None:
            self.out.publish(Float32(data=self.changed))  # sink watched
            self.changed = None
        self.out.publish(Float32(data=float(self.grid.info.width)))  # clean


def main():
    rclpy.init()
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(Mapper())
    executor.spin()


if __name__ == "__main__":
    main()
