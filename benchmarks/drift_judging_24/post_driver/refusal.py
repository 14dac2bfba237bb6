"""Tell posts that stand on rock from posts that go down slowly."""

from collections import deque

REFUSAL_SET = 9.0  # mm per blow
BLOWS = 4


class RefusalGauge:
    """Watch how far a post goes down with each blow."""

    def __init__(self, blows=BLOWS):
        self.sets = deque(maxlen=blows)

    def reset(self):
        """Forget the last post."""
        self.sets.clear()

    def add(self, millimetres):
        """Note how far one blow drove the post."""
        self.sets.append(millimetres)

    def mean(self):
        """Return the mean of the last blows."""
        return sum(self.sets) / len(self.sets) if self.sets else float("inf")

    def refused(self):
        """Return whether the post no longer goes down."""
        return len(self.sets) == self.sets.maxlen and self.mean() < REFUSAL_SET
