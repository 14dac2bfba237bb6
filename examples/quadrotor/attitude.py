#!/usr/bin/env python3
"""Hold the attitude that guidance asks for: one thrust for each of the two rotors."""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import Imu
from std_msgs.msg import Float32MultiArray, Float64

STIFFNESS = 2.5  # difference in thrust per error in pitch: N/rad
DAMPING = 0.55  # ... per rate of it: N s/rad
MOST = 10.0  # of one rotor: N


class Attitude(Node):
    """Turn the wanted pitch and thrust into rotor thrusts, whenever the inertial unit reports."""

    def __init__(self):
        super().__init__("attitude")
        self.wanted = 0.0
        self.total = 0.0
        self.create_subscription(Float64, "/pitch", self.on_pitch, 10)
        self.create_subscription(Float64, "/thrust", self.on_thrust, 10)
        self.create_subscription(Imu, "/imu", self.on_imu, 10)
        self.rotors = self.create_publisher(Float32MultiArray, "/rotors", 10)

    def on_pitch(self, msg):
        """Take the pitch that is wanted."""
        self.wanted = msg.data

    def on_thrust(self, msg):
        """Take the thrust of both rotors together."""
        self.total = msg.data

    def on_imu(self, msg):
        """Answer what the inertial unit reports."""
        pitch = 2.0 * math.atan2(msg.orientation.y, msg.orientation.w)
        error = self.wanted - pitch
        moment = STIFFNESS * error - DAMPING * msg.angular_velocity.y
        level = 0.5 * self.total / math.cos(pitch)
        rear = max(0.0, min(MOST, level + moment))
        front = max(0.0, min(MOST, level - moment))
        self.rotors.publish(Float32MultiArray(data=[rear, front]))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    node = Attitude()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
