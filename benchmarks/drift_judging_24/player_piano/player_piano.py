#!/usr/bin/env python3
"""Plays a grand piano with solenoids: notes arrive some time before they are due, and each key is hit early enough."""

import heapq
from dataclasses import dataclass, field

import rclpy
from action import clip_force, travel_time
from geometry_msgs.msg import Vector3
from rclpy.node import Node
from std_msgs.msg import Float32, String

KEYS = range(21, 109)  # MIDI numbers


@dataclass(order=True)
class Strike:
    at: float  # s, when the current begins
    key: int = field(compare=False)
    force: float = field(compare=False)


class PlayerPiano(Node):
    def __init__(self):
        super().__init__("player_piano")
        self.rest = self.declare_parameter("key_rest", 0.08).value  # s between two strikes of a key
        self.loudness = self.declare_parameter("loudness", 1.0).value
        self.late_limit = self.declare_parameter("late_limit", 0.15).value
        self.queue = []
        self.last = {}  # of each key, the time of its last strike
        self.begun = None  # clock at the first note of the score
        self.humidity = None
        self.dropped = 0
        self.solenoid = self.create_publisher(Vector3, "piano/solenoid", 20)
        self.status = self.create_publisher(String, "piano/status", 1)
        self.create_subscription(Vector3, "score/note", self.note_cb, 50)
        self.create_subscription(Float32, "hall/humidity", self.humidity_cb, 1)
        self.create_timer(0.02, self.play)
        self.create_timer(2.0, self.report)

    def now(self):
        return self.get_clock().now().nanoseconds / 1e9

    def humidity_cb(self, msg):
        self.humidity = msg.data

    def note_cb(self, msg):
        """Plan a note: x is its key, y is when it must sound after the first message, z is its force."""
        if self.begun is None:
            self.begun = self.now()
        key = int(msg.x)
        if key not in KEYS:
            self.dropped += 1
            return
        force = clip_force(self.loudness * msg.z)
        heapq.heappush(self.queue, Strike(msg.y - travel_time(key, force), key, force))

    def play(self):
        if self.begun is None:
            return
        # half a period ahead, so that strikes are early as often as late
        score_time = self.now() - self.begun + 0.01
        while self.queue and self.queue[0].at <= score_time:
            strike = heapq.heappop(self.queue)
            if score_time - strike.at > self.late_limit:
                self.dropped += 1
                continue
            if score_time - self.last.get(strike.key, -1.0) < self.rest:
                continue
            self.last[strike.key] = score_time
            self.solenoid.publish(Vector3(x=float(strike.key), y=strike.force, z=0.0))

    def report(self):
        humidity = "unknown" if self.humidity is None else f"{self.humidity:.0f} %"
        text = f"{len(self.queue)} notes waiting, {self.dropped} dropped, humidity {humidity}"
        self.status.publish(String(data=text))


def main(args=None):
    rclpy.init(args=args)
    piano = PlayerPiano()
    rclpy.spin(piano)
    piano.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
