"""A PID with a smoothed slope."""


class Pid:
    """PID with gains by keyword; `update` takes the error and the time since the last update."""

    def __init__(self, kp, ki, kd, smooth=0.5, most=1.0):
        self.kp, self.ki, self.kd = kp, ki, kd
        self.smooth, self.most = smooth, most
        self.total = 0.0
        self.slope = 0.0
        self.last = None

    def update(self, error, dt):
        if self.last is not None:
            raw = (error - self.last) / dt
            self.slope += self.smooth * (raw - self.slope)
        self.last = error
        self.total = max(-self.most, min(self.most, self.total + error * self.ki * dt))
        return self.kp * error + self.total + self.kd * self.slope
