"""PID loop of the winches, with a limited integral and a filtered derivative."""


class PID:
    def __init__(self, kp, ki, kd, i_limit, out_limit, d_filter=0.3):
        self.kp, self.ki, self.kd = kp, ki, kd
        self.i_limit = i_limit
        self.out_limit = out_limit
        self.d_filter = d_filter
        self.integral = 0.0
        self.derivative = 0.0
        self.last = None

    def __call__(self, error, dt):
        if self.last is not None:
            slope = (error - self.last) / dt
            self.derivative += self.d_filter * (slope - self.derivative)
        self.last = error
        self.integral += self.ki * error * dt
        self.integral = min(max(self.integral, -self.i_limit), self.i_limit)
        out = self.kp * error + self.integral + self.kd * self.derivative
        return min(max(out, -self.out_limit), self.out_limit)
