"""PD control of one axis with a filtered speed."""


class AxisPD:
    def __init__(self, kp, kd, limit, smoothing=0.5):
        self.kp = kp
        self.kd = kd
        self.limit = limit
        self.smoothing = smoothing
        self.before = None
        self.speed = 0.0

    def tilt(self, goal, place, dt):
        if self.before is not None and dt > 0.0:
            raw = (place - self.before) / dt
            self.speed = self.smoothing * raw + (1.0 - self.smoothing) * self.speed
        self.before = place
        out = self.kp * (goal - place) - self.kd * self.speed
        return max(-self.limit, min(self.limit, out))
