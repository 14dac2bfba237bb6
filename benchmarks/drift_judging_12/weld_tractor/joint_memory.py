"""What the tracker has seen of a joint that the torch has yet to reach."""

from collections import deque

LENGTH = 400  # points
MIN_STEP = 0.5  # mm


class JointMemory:
    """Offsets of the joint by the place along the seam, in mm."""

    def __init__(self, lead):
        self.lead = lead
        self.points = deque(maxlen=LENGTH)

    def add(self, travelled, offset):
        """Remember the offset that the tracker sees when the tractor has travelled so far."""
        place = travelled + self.lead
        if self.points and place - self.points[-1][0] < MIN_STEP:
            return
        self.points.append((place, offset))

    def offset(self, place):
        """Return the offset at a place of the seam, between the two nearest points; None if unseen."""
        while len(self.points) > 2 and self.points[1][0] < place:
            self.points.popleft()
        if len(self.points) < 2 or self.points[0][0] > place:
            return None
        (a, left), (b, right) = self.points[0], self.points[1]
        share = min(1.0, (place - a) / (b - a))
        return left + share * (right - left)
