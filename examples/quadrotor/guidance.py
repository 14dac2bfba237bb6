#!/usr/bin/env python3
"""Guide a planar quadrotor along its mission: take-off, two waypoints, landing."""

import rclpy
from geometry_msgs.msg import PoseStamped, TwistStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64

PERIOD = 0.04  # of the control loop: s
WAYPOINTS = ((0.0, 2.0), (3.0, 3.0), (6.0, 2.0))  # along and up: m
NEAR = 0.3  # a waypoint is reached this close to it: m
HOVER = 9.81  # thrust that carries the quadrotor as it was built: N
MAX_PITCH = 0.25  # rad
MAX_CLIMB = 1.2  # m/s
MAX_THRUST = 18.0  # N
DESCENT = 0.35  # sinking speed when landing: m/s


def clamp(value, limit):
    """Keep a value between -limit and limit."""
    return max(-limit, min(limit, value))


class Guidance(Node):
    """Turn position and velocity into the pitch and thrust that lead to the next waypoint."""

    def __init__(self):
        super().__init__("guidance")
        self.declare_parameter("forward_gain", 0.12)
        self.forward_gain = self.get_parameter("forward_gain").value
        self.x = self.z = 0.0
        self.vx = self.vz = 0.0
        self.leg = 0
        self.create_subscription(PoseStamped, "/pose", self.on_pose, 10)
        self.create_subscription(TwistStamped, "/velocity", self.on_velocity, 10)
        self.pitch = self.create_publisher(Float64, "/pitch", 10)
        self.thrust = self.create_publisher(Float64, "/thrust", 10)
        self.create_timer(PERIOD, self.on_timer)

    def on_pose(self, msg):
        """Remember where the quadrotor is, and go on to the next leg where this one ends."""
        self.x = msg.pose.position.x
        self.z = msg.pose.position.z
        if self.leg < len(WAYPOINTS):
            goal_x, goal_z = WAYPOINTS[self.leg]
            if abs(goal_x - self.x) < NEAR and abs(goal_z - self.z) < NEAR:
                self.leg += 1

    def on_velocity(self, msg):
        """Remember how fast it is."""
        self.vx = msg.twist.linear.x
        self.vz = msg.twist.linear.z

    def on_timer(self):
        """Send one command to the attitude loop."""
        goal_x, goal_z = WAYPOINTS[min(self.leg, len(WAYPOINTS) - 1)]
        ahead = goal_x - self.x
        lean = self.forward_gain * ahead - 0.2 * self.vx
        climb = clamp(1.5 * (goal_z - self.z), MAX_CLIMB)
        if self.leg == len(WAYPOINTS):
            climb = -DESCENT
        lift = HOVER + 4.0 * (climb - self.vz)
        self.pitch.publish(Float64(data=clamp(lean, MAX_PITCH)))
        self.thrust.publish(Float64(data=max(0.0, min(MAX_THRUST, lift))))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    node = Guidance()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
