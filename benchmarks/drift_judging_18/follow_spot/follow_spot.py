#!/usr/bin/env python3
"""Follow spot: turns a stage light towards the actor with the tracking tag, and sets its iris and its dimmer."""

import math

import rclpy
from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from std_msgs.msg import Float32, String, UInt8


class FollowSpot(Node):
    LIGHT_HEIGHT = 5.5  # m above the stage
    CHEST = 1.3
    SPOT_RADIUS = 0.9  # m around the actor
    IRIS_MIN, IRIS_MAX = 2.5, 12.0  # degrees
    FULL = 0.55  # share of the lamp for a face in full light
    FADE = 1.5  # s
    PAN_SPEED = 1.2  # rad/s
    LOST_AFTER = 1.0  # s

    def __init__(self):
        super().__init__("follow_spot")
        self.lead = self.declare_parameter("lead", 0.15).value
        self.gain = self.declare_parameter("gain", 5.0).value
        self.smooth = self.declare_parameter("smooth", 0.4).value
        self.actor = None
        self.velocity = (0.0, 0.0)
        self.seen = None
        self.desk = 0.0
        self.shown = 0.0
        self.pan = 0.0
        self.tilt = 0.4
        self.pan_pub = self.create_publisher(Float32, "spot/pan", 1)
        self.tilt_pub = self.create_publisher(Float32, "spot/tilt", 1)
        self.iris_pub = self.create_publisher(Float32, "spot/iris", 1)
        self.dimmer_pub = self.create_publisher(UInt8, "spot/dimmer", 1)
        self.status_pub = self.create_publisher(String, "spot/status", 1)
        self.create_subscription(PointStamped, "tracker/actor", self.on_actor, 5)
        self.create_subscription(Float32, "desk/fader", self.on_fader, 5)
        self.period = 0.05
        self.create_timer(self.period, self.update)

    def seconds(self):
        return self.get_clock().now().nanoseconds / 1e9

    def on_actor(self, msg):
        now = self.seconds()
        place = (msg.point.x, msg.point.y)
        if self.actor is not None and now - self.seen > 1e-3:
            step = now - self.seen
            self.velocity = tuple(
                v + self.smooth * ((new - old) / step - v)
                for v, new, old in zip(self.velocity, place, self.actor)
            )
        self.actor = place
        self.seen = now

    def on_fader(self, msg):
        self.desk = max(0.0, min(1.0, msg.data))

    def follow(self, angle, goal):
        most = self.PAN_SPEED * self.period
        return angle + max(-most, min(most, self.gain * self.period * (goal - angle)))

    def update(self):
        if self.actor is None:
            return
        lost = self.seconds() - self.seen > self.LOST_AFTER
        x = self.actor[0] + self.lead * self.velocity[0]
        y = self.actor[1] + self.lead * self.velocity[1]
        floor = math.hypot(x, y)
        distance = math.hypot(floor, self.LIGHT_HEIGHT - self.CHEST)
        self.pan = self.follow(self.pan, math.atan2(y, x))
        self.tilt = self.follow(self.tilt, math.atan2(self.LIGHT_HEIGHT - self.CHEST, floor))
        iris = math.degrees(math.atan2(self.SPOT_RADIUS, distance))
        iris = max(self.IRIS_MIN, min(self.IRIS_MAX, iris))
        wish = 0.0 if lost else self.FULL * self.desk
        most = self.period / self.FADE
        self.shown += max(-most, min(most, wish - self.shown))
        self.pan_pub.publish(Float32(data=self.pan))
        self.tilt_pub.publish(Float32(data=self.tilt))
        self.iris_pub.publish(Float32(data=iris))
        self.dimmer_pub.publish(UInt8(data=round(255 * self.shown)))
        self.status_pub.publish(String(data="lost" if lost else f"{distance:.1f} m"))


def main(args=None):
    rclpy.init(args=args)
    spot = FollowSpot()
    try:
        rclpy.spin(spot)
    except KeyboardInterrupt:
        spot.get_logger().info("blackout")
    rclpy.shutdown()


if __name__ == "__main__":
    main()
