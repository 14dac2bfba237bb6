#!/usr/bin/env python3
"""Deposits rows of macaron batter on a tray: a piston presses the batter through eight nozzles, row by row."""

import math
from dataclasses import dataclass
from enum import Enum

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Int32, String


class State(Enum):
    EMPTY = "empty"
    MOVE = "move"
    PRESS = "press"
    REFILL = "refill"
    FINISHED = "finished"


@dataclass(frozen=True)
class Recipe:
    """One recipe and the cylinder for it."""

    portion: float = 14.0  # g
    nozzles: int = 8
    rows: int = 7
    density: float = 1.12  # g/ml, of the batter
    bore: float = 60.0  # mm
    length: float = 130.0  # mm, the way of the piston
    reserve: float = 4.0  # mm, left in front of the piston

    @property
    def area(self) -> float:
        """Return the area of the piston in cm2."""
        return math.pi * (self.bore / 20.0) ** 2

    def stroke(self) -> float:
        """Return the stroke in mm that presses one row out."""
        volume = self.portion * self.nozzles / self.density
        return 10.0 * volume / self.area


class MacaronDepositor(Node):
    def __init__(self) -> None:
        super().__init__("macaron_depositor")
        self.recipe = Recipe()
        self.press_speed = self.declare_parameter("press_speed", 18.0).value  # mm/s
        self.settled = self.declare_parameter("settled", 0.25).value  # mm
        self.state = State.EMPTY
        self.piston = None
        self.goal = 0.0
        self.row = 0
        self.gantry = -1
        self.overrun = None
        self.pressing_since = None
        self.piston_pub = self.create_publisher(Float32, "piston/speed", 1)
        self.row_pub = self.create_publisher(Int32, "gantry/row", 1)
        self.refill_pub = self.create_publisher(Bool, "hopper/valve", 1)
        self.state_pub = self.create_publisher(String, "depositor/state", 1)
        self.record_pub = self.create_publisher(String, "depositor/record", 1)
        self.create_subscription(Float32, "piston/position", self.on_piston, 5)
        self.create_subscription(Int32, "gantry/at", self.on_gantry, 5)
        self.create_subscription(Bool, "tray/present", self.on_tray, 5)
        self.create_subscription(Float32, "mixer/overrun", self.on_overrun, 5)
        self.create_timer(0.1, self.tick)

    def on_piston(self, msg: Float32) -> None:
        self.piston = msg.data

    def on_gantry(self, msg: Int32) -> None:
        self.gantry = msg.data

    def on_overrun(self, msg: Float32) -> None:
        """Keep the share of air in the batter, for the record of the batch."""
        if self.overrun is None or abs(self.overrun - msg.data) > 5.0:
            self.record_pub.publish(String(data=f"overrun {msg.data:.0f} %"))
        self.overrun = msg.data

    def on_tray(self, msg: Bool) -> None:
        if msg.data and self.state is State.EMPTY:
            self.row = 0
            self.state = State.MOVE
        elif not msg.data and self.state is State.FINISHED:
            self.state = State.EMPTY

    def begin_row(self) -> None:
        """Press the next row, or refill the cylinder if too little is left."""
        goal = self.piston + self.recipe.stroke()
        if goal > self.recipe.length - self.recipe.reserve:
            self.state = State.REFILL
            return
        self.goal = goal
        self.pressing_since = self.get_clock().now()
        self.state = State.PRESS

    def approach(self) -> float:
        """Return the speed of the piston towards its goal; it does not draw batter back."""
        rest = self.goal - self.piston
        return max(0.0, min(self.press_speed, 4.0 * rest))

    def tick(self) -> None:
        speed = 0.0
        if self.piston is None:
            return
        if self.state is State.MOVE:
            self.row_pub.publish(Int32(data=self.row))
            if self.gantry == self.row:
                self.begin_row()
        elif self.state is State.PRESS:
            if self.goal - self.piston < self.settled:
                self.row += 1
                self.state = State.FINISHED if self.row >= self.recipe.rows else State.MOVE
            elif (self.get_clock().now() - self.pressing_since).nanoseconds > 15e9:
                self.get_logger().error(f"piston is stuck at {self.piston:.1f} mm, overrun {self.overrun}")
                self.state = State.FINISHED
            else:
                speed = self.approach()
        elif self.state is State.REFILL:
            if self.piston < 1.0:
                self.begin_row()
            else:
                speed = -2.5 * self.press_speed
        self.refill_pub.publish(Bool(data=self.state is State.REFILL))
        self.piston_pub.publish(Float32(data=float(speed)))
        self.state_pub.publish(String(data=self.state.value))


def main(args=None) -> None:
    rclpy.init(args=args)
    node = MacaronDepositor()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
