"""A thermistor in a voltage divider, read by a converter of 12 bits."""

import math

FULL = 4095
SERIES = 10000.0  # resistance between the thermistor and the supply (ohm)
NOMINAL = 10000.0  # resistance at 25 °C (ohm)
BETA = 3950.0  # K
KELVIN = 273.15


def resistance(counts):
    """Return the resistance of the thermistor in ohm; None if it is torn off or shorted."""
    if not 20 < counts < FULL - 20:
        return None
    return SERIES * counts / (FULL - counts)


def celsius(counts):
    """Return the temperature in °C, or None if the sensor is broken."""
    ohm = resistance(counts)
    if ohm is None:
        return None
    inverse = 1.0 / (25.0 + KELVIN) + math.log(ohm / NOMINAL) / BETA
    return 1.0 / inverse - KELVIN
