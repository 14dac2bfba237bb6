"""Subclasses of a base class that registers their endpoints; nothing in these files creates an instance."""

from std_msgs.msg import Float64

from robot_parts.base import Offering


class Gauge(Offering):
    def __init__(self):
        super().__init__("gauge")

    def offers(self):
        return [(Float64, "level", self.on_level)]

    def on_level(self, msg):
        self.level = msg.data
        self.out.publish(Float64(data=self.level))  # sink level
