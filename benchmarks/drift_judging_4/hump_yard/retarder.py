#!/usr/bin/env python3
"""Retarder of a hump yard: brake each wagon so that it reaches the standing wagons gently."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Bool, Float64

G = 9.81


@dataclass
class Track:
    """The track behind the retarder."""

    rolling_resistance: float = 0.0022  # rolling resistance of summer-warm bearings, as a share of the weight
    gradient: float = 0.0006  # slope of the yard, downwards
    coupling_speed: float = 1.1  # speed at which buffers touch and the coupler closes (m/s)

    def release_speed(self, free: float) -> float:
        """Return the speed (m/s) at which a wagon has to leave the retarder to roll `free` metres."""
        loss = 2.0 * G * (self.rolling_resistance - self.gradient) * free
        return float(np.sqrt(max(0.0, self.coupling_speed**2 + loss)))


class Radar:
    """Return the median of the last speeds, because single echoes of the bogies are wrong."""

    def __init__(self, length: int = 3) -> None:
        self._speeds = np.full(length, np.nan)

    def add(self, speed: float) -> None:
        self._speeds = np.roll(self._speeds, -1)
        self._speeds[-1] = speed

    @property
    def speed(self) -> float:
        return float(np.nanmedian(self._speeds))


class Retarder(Node):
    """One retarder, one track."""

    def __init__(self) -> None:
        super().__init__("retarder")
        self._track = Track()
        self._radar = Radar()
        self._free: float | None = None
        self._open = False
        self._pressure = self.create_publisher(Float64, "retarder/pressure", 10)
        self._released = self.create_publisher(Bool, "retarder/released", 10)
        self.create_subscription(Float64, "track/free", self._on_free, 10)
        self.create_subscription(Float64, "radar/speed", self._on_speed, qos_profile_sensor_data)

    def _on_free(self, msg: Float64) -> None:
        self._free = msg.data

    def _pressure_for(self, excess: float) -> float:
        """Return the pressure (bar): full far above the wanted speed, less near it."""
        return float(np.clip(2.0 + 6.0 * excess, 2.0, 8.0))

    def _on_speed(self, msg: Float64) -> None:
        self._radar.add(msg.data)
        if self._free is None:
            return
        excess = self._radar.speed - self._track.release_speed(self._free)
        self._open = self._open or excess <= 0.0
        self._pressure.publish(Float64(data=0.0 if self._open else self._pressure_for(excess)))
        self._released.publish(Bool(data=self._open))


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    node = Retarder()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
