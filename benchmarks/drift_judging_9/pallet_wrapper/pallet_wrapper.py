#!/usr/bin/env python
"""Wrap a pallet on a turntable: up with stretched film, a few turns at the top, and down again."""

import rospy
from std_msgs.msg import Bool, Float32

# film
PULL = 150.0  # tension of the film (N)
PULL_GAIN = 0.0012  # brake per newton
TURNS = 8  # number of layers around the load
TOP_TURNS = 2.0

# turntable and carriage
TABLE_SPEED = 0.2  # turns/s
START_SPEED = 0.07
SOFT_TURNS = 0.5  # number of slow turns at the start, until the film is tucked in
CARRIAGE_TOP = 1.6  # m
CARRIAGE_SPEED = 0.15  # m/s
RATE = 10.0

WAITING, WRAPPING, CUTTING = "waiting", "wrapping", "cutting"


class PalletWrapper:
    def __init__(self):
        self.state = WAITING
        self.turns = 0.0
        self.pull = 0.0
        self.brake = 0.0
        self.loaded = False
        self.up = 1.0
        self.height = 0.0
        self.dwell = 0.0
        self.table = rospy.Publisher("table/speed", Float32, queue_size=1)
        self.film = rospy.Publisher("film/brake", Float32, queue_size=1)
        self.carriage = rospy.Publisher("carriage/speed", Float32, queue_size=1)
        self.cutter = rospy.Publisher("film/cut", Bool, queue_size=1)
        rospy.Subscriber("table/turns", Float32, self.on_turns)
        rospy.Subscriber("film/tension", Float32, self.on_tension)
        rospy.Subscriber("carriage/height", Float32, self.on_height)
        rospy.Subscriber("pallet/present", Bool, self.on_pallet)

    def on_turns(self, msg):
        self.turns = msg.data

    def on_tension(self, msg):
        self.pull = msg.data

    def on_height(self, msg):
        self.height = msg.data

    def on_pallet(self, msg):
        self.loaded = msg.data

    def tension_loop(self):
        """Move the brake of the film until the tension is right."""
        if self.turns < SOFT_TURNS:
            return 0.3 * PULL / 300.0
        self.brake += PULL_GAIN * (PULL - self.pull)
        return max(0.0, min(1.0, self.brake))

    def carriage_speed(self):
        if self.height >= CARRIAGE_TOP and self.dwell < TOP_TURNS / TABLE_SPEED:
            self.dwell += 1.0 / RATE
            self.up = -1.0
            return 0.0
        return self.up * CARRIAGE_SPEED

    def step(self):
        speed, brake, lift = 0.0, 0.0, 0.0
        if self.state == WAITING:
            if self.loaded:
                self.state, self.brake, self.dwell, self.up = WRAPPING, 0.15, 0.0, 1.0
        elif self.state == WRAPPING:
            speed = START_SPEED if self.turns < SOFT_TURNS else TABLE_SPEED
            brake = self.tension_loop()
            lift = self.carriage_speed()
            if self.turns >= TURNS:
                self.state = CUTTING
        elif not self.loaded:
            self.state = WAITING
        self.table.publish(speed)
        self.film.publish(brake)
        self.carriage.publish(lift)
        self.cutter.publish(self.state == CUTTING)


if __name__ == "__main__":
    rospy.init_node("pallet_wrapper")
    wrapper = PalletWrapper()
    rate = rospy.Rate(RATE)
    while not rospy.is_shutdown():
        wrapper.step()
        rate.sleep()
