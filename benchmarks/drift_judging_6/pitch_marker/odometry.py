"""Dead reckoning of a robot with four driven wheels."""

from math import cos, pi, sin

TICKS = 1024.0  # ticks per turn of a wheel
WHEEL = 0.105  # radius (m)
TRACK = 0.52  # distance between the points about which the two sides turn (m)


class Odometry(object):
    def __init__(self):
        self.x = 0.0
        self.y = 0.0
        self.heading = 0.0
        self.last = None

    def update(self, left, right):
        """Add the counts of the encoders since the last update."""
        if self.last is None:
            self.last = (left, right)
            return
        ticks_left = left - self.last[0]
        ticks_right = right - self.last[1]
        self.last = (left, right)
        roll_left = 2.0 * pi * ticks_left / TICKS
        roll_right = 2.0 * pi * ticks_right / TICKS
        forward = WHEEL * (roll_left + roll_right) / 2.0
        turn = WHEEL * (roll_right - roll_left) / TRACK
        middle = self.heading + turn / 2.0
        self.x += forward * cos(middle)
        self.y += forward * sin(middle)
        self.heading += turn
