"""Humid air: the dew point, and a first-order filter for noisy probes."""

import math

MAGNUS_A = 17.62
MAGNUS_B = 243.12  # deg C


def dew_point(celsius, relative_humidity):
    """Return the dew point in deg C (Magnus formula), for a relative humidity between 0 and 1."""
    gamma = math.log(max(relative_humidity, 0.01)) + MAGNUS_A * celsius / (MAGNUS_B + celsius)
    return MAGNUS_B * gamma / (MAGNUS_A - gamma)


class LowPass:
    """First-order low-pass filter; the first sample sets its state."""

    def __init__(self, weight):
        self._weight = weight
        self._value = None

    def update(self, sample):
        """Take one sample and return the filtered value."""
        if self._value is None:
            self._value = sample
        self._value += self._weight * (sample - self._value)
        return self._value
