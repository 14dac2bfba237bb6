#!/usr/bin/env python3
"""Keep the nozzle of a welding torch at its stick-out above a plate that is not flat."""

from __future__ import annotations

from typing import Optional

import rclpy
from height import HeightTracker
from rclpy.node import Node
from settings import Procedure
from std_msgs.msg import Bool, Float64

PERIOD = 0.05


class TorchNode(Node):
    """Laser, carriage and arc of one torch."""

    def __init__(self, procedure: Optional[Procedure] = None) -> None:
        super().__init__("torch")
        self._procedure = procedure or Procedure()
        self._tracker = HeightTracker(self._procedure, PERIOD)
        self._plate: Optional[float] = None
        self._travelled = 0.0
        self._length = 0.0
        self._struck: Optional[float] = None

        self._height_pub = self.create_publisher(Float64, "torch/height", 10)
        self._speed_pub = self.create_publisher(Float64, "carriage/speed", 10)
        self._arc_pub = self.create_publisher(Bool, "torch/arc", 10)
        self.create_subscription(Float64, "laser/plate", self._on_plate, 10)
        self.create_subscription(Float64, "carriage/position", self._on_position, 10)
        self.create_subscription(Float64, "seam/length", self._on_length, 10)
        self.create_timer(PERIOD, self._on_timer)

    def _on_plate(self, msg: Float64) -> None:
        self._plate = msg.data

    def _on_position(self, msg: Float64) -> None:
        self._travelled = msg.data

    def _on_length(self, msg: Float64) -> None:
        self._length = msg.data

    def _now(self) -> float:
        return self.get_clock().now().nanoseconds / 1e9

    def _on_timer(self) -> None:
        if self._plate is None or self._length <= 0.0:
            return
        if self._struck is None:
            self._struck = self._now()
        arc = self._procedure.arc
        standing = self._now() - self._struck < arc.start_delay
        left = self._length - self._travelled
        speed = 0.0 if standing or left <= 0.0 else self._procedure.travel.speed

        height = self._tracker.update(self._plate)
        self._height_pub.publish(Float64(data=height))
        self._speed_pub.publish(Float64(data=speed))
        self._arc_pub.publish(Bool(data=left > -arc.crater_fill))


def main(args=None) -> None:
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    node = TorchNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()


if __name__ == "__main__":
    main()
