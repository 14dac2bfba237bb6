"""Units in which messages may arrive, by their names and types."""

from __future__ import annotations

from math import log, pi

import numpy as np
import pytest

from pytest_tarl.repairing.message_units import QUANTITIES, TENS, ratios
from pytest_tarl.repairing.rescaled_messages import CLOSE, LARGE


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("mast_angle", (180 / pi, 2 * pi)),
        ("sensor_msgs/FluidPressure", (6.8948, 14.504)),
        ("self.kPa", (6.8948, 14.504)),
        ("math.sin(msg.data)", (180 / pi, 2 * pi)),
        ("LaserScan", (3.2808, 39.37)),
        ("gyroRate", (180 / pi, 2 * pi, 30 / pi)),
        ("/cmd/speed", (3.6, 1.9438, 2.2369, 3.2808)),
        ("drive_time", (60.0, 3600.0)),
        ("WrenchStamped", (9.80665, 4.4482)),
        ("payload", (2.2046,)),
        ("/ball", ()),
        ("Float64", ()),
        ("singular_barrel", ()),  # only whole words count
    ],
)
def test_words_suggest_the_units(text: str, expected: tuple[float, ...]) -> None:
    assert set(ratios([text])) == {each for one in (*TENS, *expected) for each in (one, 1.0 / one)}


def test_a_message_may_have_several_quantities() -> None:
    assert {14.504, 1.0 / 60.0} <= set(ratios(["pressure", "time"]))


@pytest.mark.parametrize(("quantity", "most"), [("", 0.1), *((name, 0.2) for name in QUANTITIES)])
def test_random_factor_is_rarely_a_unit_ratio(quantity: str, most: float) -> None:
    # every factor between LARGE and 1000, in equal logarithmic steps
    sizes = np.linspace(LARGE, log(1e3), 2001)
    units = np.log(ratios([QUANTITIES[quantity].words.split()[0]] if quantity else []))
    hits = (abs(sizes[:, None] - units) <= CLOSE).any(axis=1)
    assert 0.0 < hits.mean() <= most
