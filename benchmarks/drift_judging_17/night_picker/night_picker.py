#!/usr/bin/env python3
"""Picks biscuits from a moving belt: predicts when each passes the suction cup, and fires the valve in time."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32, Int32


class Track:
    """One part on the belt."""

    def __init__(self, number, x):
        self.number = number
        self.x = x
        self.hits = 1
        self.fired = False


class BeltPicker(Node):
    def __init__(self):
        super().__init__("belt_picker")
        self.latency = self.declare_parameter("camera_latency", 0.09).value  # from shutter to message (s)
        self.valve = self.declare_parameter("valve_delay", 0.045).value
        self.horizon = self.declare_parameter("horizon", 0.25).value
        self.min_hits = self.declare_parameter("min_hits", 3).value
        self.gate = self.declare_parameter("gate", 0.05).value
        self.blend = self.declare_parameter("blend", 0.5).value
        self.max_speed = self.declare_parameter("max_speed", 0.6).value
        self.speed = 0.0
        self.tracks = []
        self.counter = 0
        self.last = None
        self.fire = self.create_publisher(Float32, "cup/fire_in", 10)
        self.count = self.create_publisher(Int32, "picker/count", 10)
        self.create_subscription(Float32, "belt/encoder_speed", self.on_speed, 10)
        self.create_subscription(Float32, "camera/biscuit", self.on_biscuit, 10)
        self.create_subscription(Float32, "camera/exposure_ms", self.on_exposure, 10)

    def now(self):
        return self.get_clock().now().nanoseconds / 1e9

    def on_speed(self, msg):
        self.speed += 0.2 * (min(msg.data, self.max_speed) - self.speed) if self.speed else msg.data

    def on_exposure(self, msg):
        if msg.data > 60.0:
            self.get_logger().warn("picture too dark, clean the lamps")

    def on_biscuit(self, msg):
        """Position of the biscuit before the cup, in m, when the shutter opened."""
        now = self.now()
        if self.last is not None:
            for track in self.tracks:
                track.x -= self.speed * (now - self.last)
        self.last = now
        track = self.match(msg.data)
        if track.fired or track.hits < self.min_hits or self.speed < 0.02:
            return
        ahead = track.x - self.speed * self.latency
        wait = ahead / self.speed - self.valve
        if wait < self.horizon:
            track.fired = True
            self.counter += 1
            self.fire.publish(Float32(data=max(0.0, wait)))
            self.count.publish(Int32(data=self.counter))

    def match(self, x):
        self.tracks = [t for t in self.tracks if t.x > -0.3]
        for track in self.tracks:
            if abs(track.x - x) < self.gate:
                track.x += self.blend * (x - track.x)
                track.hits += 1
                return track
        self.tracks.append(Track(len(self.tracks), x))
        return self.tracks[-1]


def main():
    rclpy.init()
    node = BeltPicker()
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == "__main__":
    main()
