"""Pure helpers, and one with state."""

import math

MAX = 1.0


def clamp(value, limit=MAX):
    return max(-limit, min(limit, value))


def heading(pose):
    q = pose.orientation
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y**2 + q.z**2))


class Pid:
    def __init__(self, kp, ki=0.0):
        self.kp, self.ki = kp, ki
        self.sum = 0.0

    def __call__(self, error, dt=0.1):
        self.sum += error * dt
        return self.kp * error + self.ki * self.sum

    def reset(self):
        self.sum = 0.0


from .names import join_names
