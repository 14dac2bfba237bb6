#!/usr/bin/env python3
"""Set the fence of a band saw so that each board of a log has its thickness."""

from dataclasses import dataclass

import rclpy
from geometry_msgs.msg import Point
from rclpy.node import Node
from std_msgs.msg import Float64, Int32

SAW_KERF = 2.8  # width of the cut, including the set of the teeth (mm)


@dataclass
class Cut:
    board: float = 27.0  # thickness of a green board (mm)
    slab: float = 18.0  # thickness of the first slab, with the bark (mm)
    least: float = 40.0  # minimum thickness left on the carriage (mm)
    feed: float = 22.0  # m/min
    hard_feed: float = 15.0  # feed above hard_current (m/min)
    hard_current: float = 34.0  # A


class Saw(Node):
    def __init__(self):
        super().__init__("saw")
        defaults = Cut()
        self.cut = Cut(
            board=self.declare_parameter("board", defaults.board).value,
            slab=self.declare_parameter("slab", defaults.slab).value,
            least=self.declare_parameter("least", defaults.least).value,
            feed=self.declare_parameter("feed", defaults.feed).value,
        )
        self.current = 0.0
        self.boards = 0
        self.fence = self.create_publisher(Point, "carriage/setting", 10)
        self.create_subscription(Float64, "band/current", self.current_callback, 10)
        self.create_subscription(Float64, "log/face", self.face_callback, 10)
        self.create_subscription(Int32, "log/new", self.log_callback, 10)

    def log_callback(self, _msg):
        self.boards = 0

    def current_callback(self, msg):
        self.current += 0.5 * (msg.data - self.current)

    def speed(self):
        return self.cut.hard_feed if self.current > self.cut.hard_current else self.cut.feed

    def advance(self, thickness):
        """Return the travel of the carriage: the thickness of the piece plus the saw kerf."""
        return thickness + SAW_KERF

    def face_callback(self, msg):
        setting = Point()
        if msg.data < self.cut.least:
            setting.z = 1.0  # remove the remaining piece
        elif self.boards == 0:
            setting.x = self.advance(self.cut.slab)
        else:
            setting.x = self.advance(self.cut.board)
        setting.y = self.speed()
        self.boards += 1
        self.fence.publish(setting)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Saw())


if __name__ == "__main__":
    main()
