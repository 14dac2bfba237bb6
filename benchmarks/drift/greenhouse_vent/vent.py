#!/usr/bin/env python3
"""Open and close the vent of a greenhouse so that the crop is neither scorched nor chilled."""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Illuminance, Temperature
from std_msgs.msg import Float32


class Vent(Node):
    """Switch with hysteresis and move the vent slowly."""

    def __init__(self):
        super().__init__("vent")
        self.temperature = None
        self.sun = 0.0
        self.smooth = None
        self.target = 0.0
        self.opening = 0.0
        self.create_subscription(Temperature, "/air", self.on_air, 10)
        self.create_subscription(Illuminance, "/light", self.on_light, 10)
        self.vent = self.create_publisher(Float32, "/vent", 10)
        self.lamp = self.create_publisher(Float32, "/lamp", 10)
        self.create_timer(60.0, self.on_minute)

    def on_air(self, msg):
        """Store the smoothed air temperature."""
        if self.smooth is None:
            self.smooth = msg.temperature
        self.smooth += 0.5 * (msg.temperature - self.smooth)
        self.temperature = self.smooth

    def on_light(self, msg):
        """Store the brightness, klx."""
        self.sun = msg.illuminance / 1000.0

    def on_minute(self):
        """Send the commands of this minute."""
        if self.temperature is None:
            return
        if self.temperature > 28.5:
            self.target = 1.0
        elif self.temperature < 24.0:
            self.target = 0.0
        step = self.target - self.opening
        step = max(-0.08, min(0.08, step))
        self.opening += step
        self.vent.publish(Float32(data=self.opening))
        missing = max(0.0, 12.0 - self.sun)
        self.lamp.publish(Float32(data=min(1.0, missing / 12.0)))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(Vent())


if __name__ == "__main__":
    main()
