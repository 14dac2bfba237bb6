"""Positions of parts on the conveyor, from the ticks of its encoder."""

MM_PER_TICK = 0.82  # encoder wheel of 31.3 mm with 120 ticks


class BeltTracker:
    """Store the parts that the camera detected and move them with the belt."""

    def __init__(self, camera_to_robot):
        self.camera_to_robot = camera_to_robot
        self.parts = []

    def add(self, ticks, offset):
        """Store a part that lies `offset` mm behind the line of the camera."""
        self.parts.append((ticks, offset))

    def travelled(self, since, now):
        return (now - since) * MM_PER_TICK

    def ahead(self, part, ticks):
        """Return the distance in mm of a part from the line of the gripper, negative if the part has passed it."""
        seen, offset = part
        return self.camera_to_robot + offset - self.travelled(seen, ticks)
