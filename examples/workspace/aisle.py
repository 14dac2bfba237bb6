"""A warehouse aisle with a shelf at its end; rails keep the scout straight."""

import numpy as np

from pytest_tarl.ros import message_type

STEP = 0.1  # s
BEAMS = 31
HALF = 0.3  # rad, half of the scanner's field of view
LAG = 0.2  # s, time constant of the wheels
LENGTH = 15.0  # s, time for the mission


class Aisle:
    """The scout and its distance to the shelf in metres; worn tyres reach only the share `grip` of the speed."""

    def __init__(self, rng, grip=1.0):
        self.distance = rng.uniform(0.5, 1.0)
        self.noise = rng
        self.grip = grip
        self.speed = 0.0
        self.time = 0.0

    @property
    def hit(self):
        """Return whether the scout ran into the shelf."""
        return self.distance <= 0.0

    @property
    def over(self):
        """Return whether the mission has ended."""
        return self.hit or self.time >= LENGTH

    def scan(self):
        """Return what the laser scanner sees: a flat shelf."""
        angles = np.linspace(-HALF, HALF, BEAMS)
        ranges = self.distance / np.cos(angles) + self.noise.normal(0.0, 0.002, BEAMS)
        scan = message_type("sensor_msgs/msg/LaserScan")(
            angle_min=-HALF, angle_max=HALF, angle_increment=2 * HALF / (BEAMS - 1)
        )
        scan.header.frame_id = "laser"
        scan.ranges = [float(one) for one in ranges]
        return scan

    def advance(self, command):
        """Move for one step with the newest command, or None before the first command."""
        wanted = self.grip * command.linear.x if command is not None else 0.0
        self.speed += (wanted - self.speed) * STEP / LAG
        self.distance -= self.speed * STEP
        self.time += STEP

    def judge(self):
        """Return the rewards of this step: the robot should come near the shelf, but not too near."""
        return {"waiting": -max(0.0, self.distance) * STEP, "shelf": -20.0 if self.hit else 0.0}
