#!/usr/bin/env python3
"""Release a first-aid parcel upwind of its addressee.

The autopilot flies at constant height and speed and takes a course; this node steers to the release point and drops.
"""

import numpy as np
import rclpy
from ballistics import drift, throw
from geometry_msgs.msg import Point, Vector3
from rclpy.node import Node
from std_msgs.msg import Bool, Float64

AIR_SPEED = 15.0
WIND_WEIGHT = 0.15
CLOSE = 0.5  # average delay of the release, in steps


class Dropper(Node):
    def __init__(self):
        super().__init__("dropper")
        self.dt = 0.2
        self.position = self.target = self.wind = None
        self.released = False
        self.course_pub = self.create_publisher(Float64, "autopilot/course", 10)
        self.release_pub = self.create_publisher(Bool, "hook/release", 10)
        self.create_subscription(Point, "gps", self.gps, 10)
        self.create_subscription(Point, "mission/target", self.mission, 10)
        self.create_subscription(Vector3, "autopilot/wind", self.wind_estimate, 10)
        self.create_timer(self.dt, self.loop)

    def gps(self, msg):
        self.position = np.array([msg.x, msg.y, msg.z])

    def mission(self, msg):
        self.target = np.array([msg.x, msg.y])

    def wind_estimate(self, msg):
        new = np.array([msg.x, msg.y])
        self.wind = new if self.wind is None else (1 - WIND_WEIGHT) * self.wind + WIND_WEIGHT * new

    def ground_velocity(self, towards):
        """Return the ground velocity of a flight whose track has the direction `towards`."""
        ahead = towards / max(1e-6, np.linalg.norm(towards))
        aside = np.array([-ahead[1], ahead[0]])
        across = float(self.wind @ aside)
        along = np.sqrt(max(0.0, AIR_SPEED**2 - across**2)) + float(self.wind @ ahead)
        return ahead * along

    def loop(self):
        if self.position is None or self.target is None or self.wind is None or self.released:
            return
        xy, height = self.position[:2], self.position[2]
        away = self.target - drift(height, self.wind) - xy  # release upwind of the target
        velocity = self.ground_velocity(away)
        air = velocity - self.wind
        self.course_pub.publish(Float64(data=float(np.arctan2(air[1], air[0]))))
        if np.linalg.norm(away) < throw(velocity) + CLOSE * self.dt * np.linalg.norm(velocity):
            self.release_pub.publish(Bool(data=True))
            self.released = True


def main():
    rclpy.init()
    rclpy.spin(Dropper())


if __name__ == "__main__":
    main()
