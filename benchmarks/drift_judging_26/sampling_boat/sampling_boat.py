#!/usr/bin/env python3
"""Takes water samples on a lake: drives to a station, lets the boat coast to a halt there, and lowers the bottle."""

import math

import hull
import rclpy
from geometry_msgs.msg import Point, Pose2D
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Float64, Int32, String


class SamplingBoat(Node):
    def __init__(self):
        super().__init__("sampling_boat")
        self.cruise = self.declare_parameter("cruise", 0.9).value  # share of the throttle
        self.rudder_gain = self.declare_parameter("rudder_gain", 1.4).value
        self.near = self.declare_parameter("near", 1.6).value  # m, from which a sample counts
        self.halt = self.declare_parameter("halt", 0.15).value  # m/s
        self.sample_time = self.declare_parameter("sample_time", 4.0).value  # s
        self.hull = hull.Hull()
        self.pose = None
        self.speed = 0.0
        self.station = None
        self.number = 0
        self.state = "idle"
        self.since = self.seconds()
        self.draught = 0.0
        self.retries = 0
        self.throttle_pub = self.create_publisher(Float32, "motor/throttle", 1)
        self.rudder_pub = self.create_publisher(Float32, "motor/rudder", 1)
        self.winch_pub = self.create_publisher(Bool, "winch/down", 1)
        self.taken_pub = self.create_publisher(Int32, "sampler/taken", 1)
        self.log_pub = self.create_publisher(String, "sampler/log", 1)
        self.create_subscription(Pose2D, "gps/pose", self.on_pose, 5)
        self.create_subscription(Float64, "gps/speed", self.on_speed, 5)
        self.create_subscription(Point, "mission/station", self.on_station, 5)
        self.create_subscription(Float32, "hull/draught", self.on_draught, 5)
        self.create_timer(0.2, self.tick)

    def seconds(self):
        return self.get_clock().now().nanoseconds * 1e-9

    def on_pose(self, msg):
        self.pose = (msg.x, msg.y, msg.theta)

    def on_speed(self, msg):
        self.speed += 0.6 * (msg.data - self.speed)

    def on_draught(self, msg):
        """Keep the draught in m, for the log."""
        self.draught = msg.data

    def on_station(self, msg):
        """Take the place of the next station, and its number as z."""
        if self.station is None or round(msg.z) != self.number:
            self.number = round(msg.z)
            self.station = (msg.x, msg.y)
            self.enter("drive")

    def enter(self, state):
        self.state = state
        self.since = self.seconds()

    def bearing(self):
        """Return the distance of the station in m, and the turn towards it in rad."""
        dx = self.station[0] - self.pose[0]
        dy = self.station[1] - self.pose[1]
        return math.hypot(dx, dy), hull.wrap(math.atan2(dy, dx) - self.pose[2])

    def tick(self):
        throttle, rudder = 0.0, 0.0
        if self.pose is not None and self.station is not None:
            away, turn = self.bearing()
            spent = self.seconds() - self.since
            if self.state == "drive":
                rudder = max(-1.0, min(1.0, self.rudder_gain * turn))
                throttle = self.cruise if abs(turn) < 1.0 else 0.4 * self.cruise
                if away <= self.hull.coast(self.speed):
                    self.enter("coast")
            elif self.state == "coast":
                rudder = max(-1.0, min(1.0, self.rudder_gain * turn)) if abs(turn) < 1.2 else 0.0
                if self.speed < self.halt:
                    if away < self.near:
                        self.enter("sample")
                    else:
                        self.retries += 1
                        self.enter("drive")
            elif self.state == "sample" and spent > self.sample_time:
                self.taken_pub.publish(Int32(data=self.number))
                text = f"{self.number} at {away:.1f} m, draught {self.draught:.2f} m, {self.retries} retries"
                self.log_pub.publish(String(data=text))
                self.enter("idle")
        self.throttle_pub.publish(Float32(data=throttle))
        self.rudder_pub.publish(Float32(data=float(rudder)))
        self.winch_pub.publish(Bool(data=self.state == "sample"))


def main():
    rclpy.init()
    rclpy.spin(SamplingBoat())


if __name__ == "__main__":
    main()
