"""Filters for the view of the furrow, and a steering law."""

OFFSET_GAIN = 0.35  # rad per m
ANGLE_GAIN = 0.8  # rad per rad
CHANGE_GAIN = 0.3  # rad per m/s
MOST_STEERING = 0.7  # rad
SLOW = 0.4  # speed below which steering is gentle (m/s)


class FurrowGuide:
    """Store the filtered view of the furrow and steer along it."""

    def __init__(self, trust=0.6):
        self.trust = trust
        self.offset = 0.0
        self.angle = 0.0
        self.before = 0.0

    def see(self, offset, angle):
        """Update the filters with one view of the furrow."""
        self.before = self.offset
        self.offset += self.trust * (offset - self.offset)
        self.angle += self.trust * (angle - self.angle)

    def steering(self, speed):
        """Return the angle of the wheels, rad."""
        change = (self.offset - self.before) / 0.1
        angle = OFFSET_GAIN * self.offset
        angle += ANGLE_GAIN * self.angle
        angle += CHANGE_GAIN * change
        if speed < SLOW:
            angle = 0.7 * angle
        if angle > MOST_STEERING:
            return MOST_STEERING
        if angle < -MOST_STEERING:
            return -MOST_STEERING
        return angle
