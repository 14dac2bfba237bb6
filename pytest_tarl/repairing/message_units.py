"""Find the ratios between the units that a message's names, type and use suggest.

For example, a topic `/tank/pressure` may change from bar to psi, but nothing would explain the same ratio on a topic
`/ball`. Powers of ten occur with every quantity: millimetres, percent, thousandths.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import pi
from typing import Final

from tarl_lint.name_words import words

TENS: Final = (10.0, 100.0, 1e3, 1e6)  # powers of ten by which any unit may be divided


@dataclass(frozen=True, slots=True)
class Quantity:
    """A quantity: the ratios between its usual units, and the words that suggest it, separated by spaces."""

    ratios: tuple[float, ...]
    words: str


QUANTITIES: Final = {
    "angle": Quantity(  # degrees, turns
        (180 / pi, 2 * pi),
        "angle angles azimuth bearing compass course deg degree degrees heading joint orientation pitch rad radians"
        " roll rotation sin cos tan steering theta tilt vane yaw",
    ),
    "angular speed": Quantity(  # degrees, turns and turns per minute
        (180 / pi, 2 * pi, 30 / pi), "angular gyro imu omega rotor rpm spin"
    ),
    "length": Quantity(  # feet, inches
        (3.2808, 39.37),
        "altitude depth dist distance gap height length level odometry point pose position radius range ranges scan"
        " sonar width",
    ),
    "speed": Quantity(  # km/h, knots, miles per hour, feet per second
        (3.6, 1.9438, 2.2369, 3.2808), "odometry speed twist velocity wind"
    ),
    "time": Quantity(  # minutes, hours
        (60.0, 3600.0), "delay duration elapsed eta interval period time timeout"
    ),
    "force": Quantity(  # kilogram-force, pound-force
        (9.80665, 4.4482), "force grip load pull push tension thrust wrench"
    ),
    "pressure": Quantity(  # kPa and bar per psi
        (6.8948, 14.504), "bar barometer hpa kpa pa pressure psi vacuum"
    ),
    "mass": Quantity((2.2046,), "kg load mass payload scale weight"),  # pounds
}


def ratios(texts: Iterable[str]) -> tuple[float, ...]:
    """Return the ratios (and inverses) between units that a number's names, type and use allow."""
    known = {word for text in texts for word in words(text)}
    fitting = [
        each for one in QUANTITIES.values() if not known.isdisjoint(one.words.split()) for each in one.ratios
    ]
    return tuple(ratio for each in dict.fromkeys((*TENS, *fitting)) for ratio in (each, 1.0 / each))
