#!/usr/bin/env python3
"""Push a barge alongside: velocity profile to the quay, PI control of the thruster."""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Range
from std_msgs.msg import Float32


class Tug(Node):
    FAR_SPEED = 0.35  # m/s
    TOUCH_SPEED = 0.08  # m/s
    SLOW_ZONE = 3.0  # m
    KP = 3.0
    KI = 0.8
    INTEGRAL_LIMIT = 0.8

    def __init__(self):
        super().__init__("tug")
        self.distance = None
        self.stamp = None
        self.speed = 0.0
        self.integral = 0.0
        self.create_subscription(Range, "quay/range", self.range_cb, 10)
        self.thrust = self.create_publisher(Float32, "thruster", 10)

    def range_cb(self, msg):
        now = self.get_clock().now().nanoseconds / 1e9
        if self.distance is not None and now > self.stamp:
            dt = now - self.stamp
            raw = (self.distance - msg.range) / dt
            self.speed += 0.3 * (raw - self.speed)
            self.thrust.publish(Float32(data=self.control(msg.range, dt)))
        self.distance, self.stamp = msg.range, now

    def profile(self, distance):
        if distance >= self.SLOW_ZONE:
            return self.FAR_SPEED
        share = max(0.0, distance) / self.SLOW_ZONE
        return self.TOUCH_SPEED + share * (self.FAR_SPEED - self.TOUCH_SPEED)

    def control(self, distance, dt):
        error = self.profile(distance) - self.speed
        self.integral += self.KI * error * dt
        self.integral = max(-self.INTEGRAL_LIMIT, min(self.INTEGRAL_LIMIT, self.integral))
        thrust = self.KP * error + self.integral
        return max(-1.0, min(1.0, thrust))


def main():
    rclpy.init()
    rclpy.spin(Tug())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
