#!/usr/bin/env python3
"""Keep the tension of the film by the brake of the roll that it comes from."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32

K_BRAKE = 14.0  # torque of the powder brake per current (Nm/A)
BEARING = 0.4  # Nm
TENSION = 80.0  # N
DANCER_MIDDLE = 0.50
KP = 0.35  # current per unit of the dancer's position (A)
KD = 0.08
INERTIA = 26.0  # torque per acceleration and radius of a full roll (Nm per m/s2 and m)
START_CURRENT = 0.25  # current while the line stands (A)
MAX_CURRENT = 4.0
DT = 0.1


class BrakeControl(Node):
    def __init__(self):
        super().__init__("brake_control")
        self.radius = None
        self.dancer, self.dancer_rate = DANCER_MIDDLE, 0.0
        self.speed, self.acceleration = 0.0, 0.0
        self.pub = self.create_publisher(Float32, "brake/current", 10)
        self.create_subscription(Float32, "roll/radius", self.on_radius, 10)
        self.create_subscription(Float32, "dancer/position", self.on_dancer, 10)
        self.create_subscription(Float32, "line/speed", self.on_speed, 10)
        self.create_timer(DT, self.control)

    def on_radius(self, msg):
        self.radius = msg.data

    def on_dancer(self, msg):
        rate = (msg.data - self.dancer) / DT
        self.dancer_rate += 0.3 * (rate - self.dancer_rate)
        self.dancer = msg.data

    def on_speed(self, msg):
        self.acceleration += 0.2 * ((msg.data - self.speed) / DT - self.acceleration)
        self.speed = msg.data

    def torque(self):
        """Return the torque of the brake for the tension that is wanted."""
        needed = TENSION * self.radius - BEARING
        return needed - INERTIA * self.radius * self.acceleration

    def trim(self):
        """Return the correction of the current: the dancer rises above its middle when the film is too tight."""
        return -KP * (self.dancer - DANCER_MIDDLE) - KD * self.dancer_rate

    def control(self):
        if self.radius is None:
            return
        if self.speed < 0.05:
            current = START_CURRENT
        else:
            current = self.torque() / K_BRAKE + self.trim()
        self.pub.publish(Float32(data=max(0.0, min(MAX_CURRENT, current))))


def main():
    rclpy.init()
    rclpy.spin(BrakeControl())


if __name__ == "__main__":
    main()
