#!/usr/bin/env python3
"""Plants seedlings behind a tractor: a carriage holds the cup over a hole in the ground while the seedling drops."""

from __future__ import annotations

from collections import deque
from typing import Optional

import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Bool, Float32, Int32

REACH = 0.32  # m, of the carriage to either side of the middle
HOME = 0.2  # m before the middle, where the carriage waits for a hole
IN_SIGHT = 0.3  # m


class Odometer:
    """Integrates the speed of the tractor, for the spacing and the display."""

    def __init__(self):
        self.speed = 0.0
        self.way = 0.0
        self.last = None

    def add(self, speed: float, now: float) -> None:
        if self.last is not None:
            self.way += speed * (now - self.last)
        self.last = now
        self.speed += 0.3 * (speed - self.speed)


class SeedlingPlanter(Node):
    def __init__(self):
        super().__init__("seedling_planter")
        self.declare_parameters(
            "",
            [
                ("gain", 3.0),  # 1/s
                ("max_speed", 1.2),  # m/s
                ("over_hole", 0.035),  # m
                ("hold_for", 0.3),  # s over the hole until the seedling drops
                ("rate", 20.0),  # Hz
            ],
        )
        rate = self.get_parameter("rate").value
        self.needed = int(self.get_parameter("hold_for").value * rate)
        self.odometer = Odometer()
        self.carriage: Optional[float] = None
        self.offset: Optional[float] = None
        self.offset_at = -1.0
        self.over: deque[bool] = deque(maxlen=self.needed)
        self.loaded = False
        self.planted = 0
        self.follow = False
        self.speed_pub = self.create_publisher(Float32, "carriage/speed", 1)
        self.drop_pub = self.create_publisher(Bool, "cup/drop", 1)
        self.planted_pub = self.create_publisher(Int32, "planter/planted", 1)
        self.spacing_pub = self.create_publisher(Float32, "planter/spacing", 1)
        self.create_subscription(Float32, "tractor/speed", self.on_tractor, qos_profile_sensor_data)
        self.create_subscription(Float32, "carriage/position", self.on_carriage, qos_profile_sensor_data)
        self.create_subscription(Float32, "camera/hole", self.on_hole, qos_profile_sensor_data)
        self.create_subscription(Bool, "cup/loaded", self.on_loaded, 5)
        self.create_timer(1.0 / rate, self.control)
        self.create_timer(2.0, self.display)

    def now(self) -> float:
        return self.get_clock().now().nanoseconds * 1e-9

    def on_tractor(self, msg: Float32) -> None:
        self.odometer.add(msg.data, self.now())

    def on_carriage(self, msg: Float32) -> None:
        self.carriage = msg.data

    def on_hole(self, msg: Float32) -> None:
        """Take the distance in m of the nearest hole in front of the cup (positive: towards the tractor)."""
        self.offset = msg.data
        self.offset_at = self.now()

    def on_loaded(self, msg: Bool) -> None:
        self.loaded = msg.data
        if not msg.data:
            self.follow = False

    def hole(self) -> Optional[float]:
        """Return the offset of the hole if the camera has seen it just now."""
        if self.offset is None or self.now() - self.offset_at > 0.2:
            return None
        return self.offset

    def carriage_speed(self, hole: float) -> float:
        """Return the speed that brings the cup over the hole."""
        gain = self.get_parameter("gain").value
        return gain * hole

    def control(self) -> None:
        if self.carriage is None:
            return
        hole = self.hole()
        if self.loaded and hole is not None and abs(hole) < IN_SIGHT:
            self.follow = True
        if self.follow and hole is not None:
            speed = self.carriage_speed(hole)
            self.over.append(abs(hole) < self.get_parameter("over_hole").value)
        else:
            speed = 2.0 * (HOME - self.carriage)
            self.over.clear()
        if self.loaded and len(self.over) == self.needed and all(self.over):
            self.drop_pub.publish(Bool(data=True))
            self.planted += 1
            self.follow = False
            self.over.clear()
            self.planted_pub.publish(Int32(data=self.planted))
        limit = self.get_parameter("max_speed").value
        if abs(self.carriage) > REACH and speed * self.carriage > 0.0:
            speed = 0.0
        self.speed_pub.publish(Float32(data=max(-limit, min(limit, speed))))

    def display(self) -> None:
        if self.planted > 0:
            self.spacing_pub.publish(Float32(data=self.odometer.way / self.planted))


def main(args=None):
    rclpy.init(args=args)
    node = SeedlingPlanter()
    rclpy.spin(node)
    node.destroy_node()


if __name__ == "__main__":
    main()
