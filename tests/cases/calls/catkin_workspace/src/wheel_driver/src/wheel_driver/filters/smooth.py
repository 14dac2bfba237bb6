class Smooth:
    def __init__(self, gain):
        self.gain = gain
        self.value = 0.0

    def add(self, value):
        self.value += self.gain * (value - self.value)
        return self.value
