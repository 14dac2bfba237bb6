"""Trot of the walker: turns a speed and a yaw rate into the settings that the leg controllers take."""

STEP_HEIGHT = 0.05  # m, lift of a foot in its swing
MAX_CADENCE = 2.2  # steps per second
STRIDE = 0.22  # m


class Trot:
    def __init__(self):
        self.height = STEP_HEIGHT
        self.cadence = 0.0

    def set_speed(self, speed):
        self.cadence = max(0.0, min(MAX_CADENCE, abs(speed) / STRIDE))

    def values(self, yaw_rate):
        """[cadence, step height, yaw rate], as the legs expect them."""
        return [self.cadence, self.height, yaw_rate]
