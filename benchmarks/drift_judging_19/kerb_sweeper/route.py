"""The route of the sweeper: points along the kerb, 0.2 m apart."""

import math


class Route:
    def __init__(self, points):
        self.points = points
        self.index = 0

    def __len__(self):
        return len(self.points)

    def distance(self, index, x, y):
        return math.hypot(self.points[index][0] - x, self.points[index][1] - y)

    def advance(self, x, y, window=40):
        """Go on to the point nearest to the sweeper, never back."""
        last = min(len(self.points), self.index + window)
        self.index = min(range(self.index, last), key=lambda i: self.distance(i, x, y))
        return self.index

    def ahead(self, x, y, reach):
        """Return the first point that is farther than the reach."""
        index = self.index
        while index < len(self.points) - 1 and self.distance(index, x, y) < reach:
            index += 1
        return self.points[index]

    def left(self):
        return len(self.points) - 1 - self.index
