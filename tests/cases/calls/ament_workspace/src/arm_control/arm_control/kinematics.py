import math


class Arm:
    def __init__(self, lengths):
        self.lengths = lengths

    def height(self, angles):
        return sum(l * math.sin(a) for l, a in zip(self.lengths, angles))


def reach(arm):
    return sum(arm.lengths)
