"""The elastic head of the massage arm: a spring between the carriage and the pad, with an encoder across it."""

STIFFNESS = 4200.0  # N/m, compression spring in the head
PRELOAD = 0.8  # N, weight of the pad that the spring carries
SHARE = 0.5


class ElasticHead:
    def __init__(self):
        self.deflection = 0.0

    def measure(self, deflection):
        self.deflection += SHARE * (deflection - self.deflection)

    def force(self):
        """Force of the pad on the skin, in N."""
        return max(0.0, STIFFNESS * self.deflection - PRELOAD)
