#!/usr/bin/env python3
"""Spray boards on a gantry. The film gets thinner the faster the gun moves."""

import rospy
from std_msgs.msg import Bool, Float64

GUN = {
    "flow": 12.0,  # ml/s
    "overspray": 0.25,  # share of the paint that misses the board
    "width": 0.30,  # m
}
GANTRY = {
    "slowest": 0.08,  # m/s
    "fastest": 0.60,
    "return": 0.50,
    "lead_in": 0.10,  # distance before the board at which the gun opens, m
}


class Sprayer:
    """Paint each board in one pass."""

    def __init__(self):
        self.film = None
        self.board = None
        self.x = None
        self.spraying = False
        self.finished = False
        self.speed_pub = rospy.Publisher("gantry/speed", Float64, queue_size=1)
        self.gun_pub = rospy.Publisher("gun/open", Bool, queue_size=1)
        rospy.Subscriber("order/film", Float64, self.on_film)
        rospy.Subscriber("order/length", Float64, self.on_length)
        rospy.Subscriber("gantry/position", Float64, self.on_position)

    def on_film(self, msg):
        """Store the wanted thickness of the wet film in micrometres."""
        self.film = msg.data

    def on_length(self, msg):
        """Store the length of the board in metres."""
        self.board = msg.data

    def on_position(self, msg):
        """Store the position of the gun; 0 is the near edge of the board."""
        self.x = msg.data

    def traverse_speed(self):
        """Return the speed in m/s that gives the wanted film: volume flow divided by cross section."""
        volume = GUN["flow"] * (1.0 - GUN["overspray"])  # ml/s
        section = GUN["width"] * self.film  # ml/m, since 1 um * 1 m * 1 m is 1 ml
        speed = volume / section
        return min(GANTRY["fastest"], max(GANTRY["slowest"], speed))

    def update(self):
        """Open the gun ahead of the board and close it behind."""
        self.spraying = -GANTRY["lead_in"] <= self.x <= self.board
        self.gun_pub.publish(self.spraying)
        if self.x > self.board + 0.05:
            self.finished = True
        if self.finished:
            self.speed_pub.publish(-GANTRY["return"] if self.x > 0.0 else 0.0)
        elif self.spraying:
            self.speed_pub.publish(self.traverse_speed())
        else:
            self.speed_pub.publish(GANTRY["return"])

    def run(self):
        """Main loop, 20 Hz."""
        rate = rospy.Rate(20)
        while not rospy.is_shutdown():
            if None not in (self.film, self.board, self.x):
                self.update()
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("sprayer")
    Sprayer().run()
