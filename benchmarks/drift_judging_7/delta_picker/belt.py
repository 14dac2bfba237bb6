"""Where things on the conveyor are, from the ticks of its encoder."""

MM_PER_TICK = 0.82  # encoder wheel of 31.3 mm with 120 ticks


class BeltTracker:
    """Remember parts that the camera saw and move them along."""

    def __init__(self, camera_to_robot):
        self.camera_to_robot = camera_to_robot
        self.parts = []

    def add(self, ticks, offset):
        """Take a part that lies `offset` mm behind the line of the camera."""
        self.parts.append((ticks, offset))

    def travelled(self, since, now):
        return (now - since) * MM_PER_TICK

    def ahead(self, part, ticks):
        """Distance in mm to the line of the gripper, negative if it has passed."""
        seen, offset = part
        return self.camera_to_robot + offset - self.travelled(seen, ticks)
