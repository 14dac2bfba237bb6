"""Saturated steam: its temperature and pressure."""

import math

# Antoine's equation for water from 99 to 374 degrees, pressure in mmHg
A, B, C = 8.14019, 1810.94, 244.485
MMHG_PER_BAR = 750.062


def pressure_at(celsius: float) -> float:
    """Return the absolute pressure in bar of saturated steam."""
    return 10.0 ** (A - B / (C + celsius)) / MMHG_PER_BAR


def temperature_at(bar: float) -> float:
    """Return the temperature of saturated steam of some absolute pressure in bar."""
    return B / (A - math.log10(bar * MMHG_PER_BAR)) - C
