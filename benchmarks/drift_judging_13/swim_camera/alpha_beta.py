"""An alpha-beta filter: position and speed of something that is seen at a steady rate."""


class AlphaBeta:
    def __init__(self, alpha, beta, dt):
        self.alpha, self.beta, self.dt = alpha, beta, dt
        self.x = None
        self.v = 0.0

    def update(self, measured):
        """Add a measurement; a jump restarts the filter."""
        if self.x is None or abs(measured - self.x) > 5.0:
            self.x, self.v = measured, 0.0
            return
        self.x += self.v * self.dt
        residual = measured - self.x
        self.x += self.alpha * residual
        self.v += self.beta * residual / self.dt

    def ahead(self, seconds):
        """Position at a later time, if the speed stays."""
        return self.x + self.v * seconds
