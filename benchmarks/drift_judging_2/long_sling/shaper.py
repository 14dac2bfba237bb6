"""Zero-vibration input shaping: two half steps, half a period apart, cancel each other's sway."""

import math
from collections import deque

GRAVITY = 9.81


class ZeroVibration:
    """Delay line of commands for a pendulum of variable length."""

    def __init__(self, period, longest=3.0):
        self.period = period
        self.line = deque([0.0], maxlen=int(longest / period))

    @staticmethod
    def half_swing(length):
        """Return half the natural period of a pendulum in s."""
        return math.pi * math.sqrt(length / GRAVITY)

    def shape(self, command, length):
        """Return the shaped command."""
        self.line.append(command)
        back = round(self.half_swing(length) / self.period)
        old = self.line[-1 - back] if back < len(self.line) else 0.0
        return 0.5 * command + 0.5 * old

    def settled(self, command):
        """Return whether the delay line contains only the current command."""
        return all(abs(value - command) < 1e-6 for value in self.line)
