#!/usr/bin/env python3
"""Level a camera on a boat: complementary filter for roll, one servo."""

import math

import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Imu
from std_msgs.msg import Float32


class RollFilter:
    """Complementary filter: the gyroscope for fast changes, gravity for slow ones."""

    def __init__(self, alpha):
        self.alpha = alpha
        self.roll = 0.0

    def update(self, rate, gravity_roll, dt):
        predicted = self.roll + rate * dt
        self.roll = self.alpha * predicted + (1.0 - self.alpha) * gravity_roll
        return self.roll


class Gimbal(Node):
    def __init__(self):
        super().__init__("gimbal")
        self.declare_parameter("filter_alpha", 0.95)
        self.declare_parameter("servo_limit", 0.5)
        self.declare_parameter("lead", 0.08)
        alpha = self.get_parameter("filter_alpha").value
        self.limit = self.get_parameter("servo_limit").value
        self.lead = self.get_parameter("lead").value
        self.filter = RollFilter(alpha)
        self.last_stamp = None
        self.servo_pub = self.create_publisher(Float32, "gimbal/roll_servo", 1)
        self.create_subscription(Imu, "imu/data_raw", self.on_imu, qos_profile_sensor_data)

    def on_imu(self, msg):
        stamp = msg.header.stamp.sec + msg.header.stamp.nanosec * 1e-9
        if self.last_stamp is None:
            self.last_stamp = stamp
            return
        dt = stamp - self.last_stamp
        self.last_stamp = stamp
        acc = msg.linear_acceleration
        gravity_roll = math.atan2(acc.y, acc.z)
        rate = msg.angular_velocity.x
        roll = self.filter.update(rate, gravity_roll, dt)
        ahead = roll + self.lead * rate  # compensate the lag of the servo
        servo = max(-self.limit, min(self.limit, -ahead))
        self.servo_pub.publish(Float32(data=servo))


def main():
    rclpy.init()
    node = Gimbal()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
