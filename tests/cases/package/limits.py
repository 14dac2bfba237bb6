TOP = 1.5


def clip(value, low=-TOP, high=TOP):
    if value < low:
        return low
    if value > high:
        return high
    return value


class Controller:
    def __init__(self, gain):
        self.gain = gain

    def command(self, error):
        return clip(self.gain * error)
