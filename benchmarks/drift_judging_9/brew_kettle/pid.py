"""A small PID controller."""


class PID:
    """Proportional, integral and derivative of the measurement, with a limited output."""

    def __init__(self, kp, ki=0.0, kd=0.0, low=0.0, high=1.0):
        self.kp, self.ki, self.kd = kp, ki, kd
        self.low, self.high = low, high
        self.sum = 0.0
        self.last = None

    def reset(self):
        """Forget what was summed up, for a new target."""
        self.sum = 0.0
        self.last = None

    def update(self, error, measured, base, dt):
        """Return the output: `base` holds the target, and the other terms correct the error."""
        self.sum = max(-200.0, min(200.0, self.sum + error * dt))
        slope = 0.0 if self.last is None else (measured - self.last) / dt
        self.last = measured
        out = base + self.kp * error + self.ki * self.sum - self.kd * slope
        return max(self.low, min(self.high, out))
