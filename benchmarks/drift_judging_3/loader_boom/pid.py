"""PID controller with a clamped integral; derivative on the measurement."""


class PID:
    def __init__(self, p, i, d, i_limit):
        self.p = p
        self.i = i
        self.d = d
        self.i_limit = i_limit
        self.reset()

    def reset(self):
        self.integral = 0.0
        self.last = None

    def __call__(self, error, measured, dt):
        step = self.i * error * dt
        self.integral = min(self.i_limit, max(-self.i_limit, self.integral + step))
        slope = 0.0 if self.last is None else (measured - self.last) / dt
        self.last = measured
        return self.p * error + self.integral - self.d * slope
