"""The models and formulas of ARCH-COMP in benchmarks/arch_comp."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).resolve().parents[1] / "benchmarks" / "arch_comp"


@pytest.fixture(autouse=True)
def importable(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.syspath_prepend(str(HERE))
    yield
    for name in ("arch_formulas", "arch_models", "falsify"):
        sys.modules.pop(name, None)


def test_a_sliding_maximum_is_the_maximum_of_each_window() -> None:
    from arch_formulas import always, eventually

    values = np.random.default_rng(0).normal(size=40)
    for low, high in ((0.0, 0.0), (0.0, 0.7), (0.2, 1.5), (0.1, 9.0)):
        first, last = round(low / 0.1), round(high / 0.1)
        windows = [values[at + first : at + last + 1] for at in range(40)]
        naive = [one.max() if one.size else -np.inf for one in windows]
        assert eventually(values, low, high, 0.1).tolist() == naive
        assert always(values, low, high, 0.1).tolist() == [-one for one in _greatest(-values, first, last)]


def _greatest(values: np.ndarray, first: int, last: int) -> list[float]:
    windows = [values[at + first : at + last + 1] for at in range(len(values))]
    return [one.max() if one.size else -np.inf for one in windows]


def test_full_throttle_reaches_the_speeds_that_falstar_published_for_the_transmission() -> None:
    from arch_formulas import AUTOMATIC_TRANSMISSION
    from arch_models import AT_STEP, automatic_transmission

    out = automatic_transmission(np.tile([100.0, 0.0], (round(30 / AT_STEP) + 1, 1)))
    assert [*dict.fromkeys(out["gear"].tolist())] == [1.0, 2.0, 3.0, 4.0]
    assert AUTOMATIC_TRANSMISSION["AT1"](out) == pytest.approx(-0.2133, abs=0.01)
    assert out["speed"].max() == pytest.approx(135.0 + 2.9802, abs=0.01)
    assert -25.0 < AUTOMATIC_TRANSMISSION["AT2"](out) < -10.0


def test_the_cars_violate_their_requirements_as_the_published_inputs_do() -> None:
    from arch_formulas import CHASING_CARS
    from arch_models import CC_STEP, chasing_cars

    def run(*inputs: tuple[float, float]) -> dict[str, float]:
        """Return the robustness of each formula; each input lasts equally long, 100 s in all."""
        steps = round(100 / CC_STEP)
        out = chasing_cars(np.repeat(inputs, steps // len(inputs), axis=0)[[*range(steps), -1]])
        return {name: robustness(out) for name, robustness in CHASING_CARS.items()}

    # FalStar, results/quest2019-journal/instance1/cc.csv
    assert run((0.5, 0.0), (1.0, 1.0))["CC1"] == pytest.approx(-44.1251, rel=0.01)
    assert run((0.0, 1.0), (0.5, 0.0))["CC2"] == pytest.approx(-5.0)
    assert min(run((0.5, 0.5)).values()) > 0.0


def test_turbine_keeps_its_rated_speed() -> None:
    from arch_formulas import WIND_TURBINE
    from arch_models import WT_STEP, wind_turbine

    out = wind_turbine(np.full((round(630 / WT_STEP) + 1, 1), 14.0))
    assert out["rotor"][-1] == pytest.approx(12.1, abs=0.01)
    assert out["torque"][-1] == pytest.approx(
        43093.55, rel=1e-3
    )  # 5 MW over the efficiency, at the rated speed
    assert all(robustness(out) > 0.0 for robustness in WIND_TURBINE.values())


def test_a_search_counts_distinct_simulations_until_the_first_violation() -> None:
    from falsify import MODELS, by_chance, stressed

    cars = MODELS[1]
    assert by_chance(cars, lambda _: 1.0, 0, 6) is None
    calls = 0

    def robustness(out: object) -> float:
        nonlocal calls
        calls += 1
        return -1.0 if calls == 5 else 1.0

    assert stressed(cars, robustness, 0, 20) == 5
    assert calls == 5
