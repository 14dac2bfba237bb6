"""Spaces of drifts: comparisons draw a value for each direction; other runs use the nominal values."""

from __future__ import annotations

import inspect
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl import Drift, faults
from pytest_tarl.design import faults as active_faults
from pytest_tarl.design import value
from pytest_tarl.drifts import drawn, drift, sizes
from pytest_tarl.errors import SettingsError
from pytest_tarl.rollout import EpisodePlan
from pytest_tarl.spaces import Space, Span
from pytest_tarl.workers.protocol import plan_message, planned
from tests.plugin.tank import ONLINE, RECORD, changed

ODOM = faults.bias("/odom", "pose.pose.position.x", 0.0, 0.5)
WORLD = drift(
    "t",
    "world",
    Drift.space(mud=Drift.range(0.05, 1.0, nominal=1.0), camera=Drift.choice("up", "down"), odom=ODOM),
)
seeds = st.integers(0, 2**63 - 1)


@given(seeds)
def test_episode_draws_all_directions(seed: int) -> None:
    found = drawn(WORLD, "world", seed)
    assert found.keys() == {"mud", "camera"}
    assert 0.05 <= found["mud"] <= 1.0
    assert found["camera"] in ("up", "down")
    ((name, (fault, size)),) = active_faults({"world": WORLD}, "world", seed).items()
    assert (name, fault) == ("odom", ODOM)
    assert 0.0 < size <= 0.5
    assert sizes(WORLD, "world", seed) == {"mud": found["mud"], "odom": size}


def test_each_direction_is_drawn_independently() -> None:
    alone = drift("t", "world", Drift.space(mud=Drift.range(0.05, 1.0, nominal=1.0)))
    assert [drawn(alone, "world", seed)["mud"] for seed in range(9)] == [
        drawn(WORLD, "world", seed)["mud"] for seed in range(9)
    ]
    downs = sum(drawn(WORLD, "world", seed)["camera"] == "down" for seed in range(2000))
    assert 900 < downs < 1100


def test_other_episodes_have_nominal_values() -> None:
    drifts = {"world": WORLD, "dusk": drift("t", "dusk", {"light": 0.3}), "rain": drift("t", "rain", 0.2)}
    assert value(drifts, (), None, 1) == {"mud": 1.0, "camera": "up"}
    assert value(drifts, (), "dusk", 1) == {"mud": 1.0, "camera": "up", "light": 0.3}
    assert value(drifts, (), "rain", 1) == 0.2
    assert active_faults(drifts, None, 1) == active_faults(drifts, "dusk", 1) == {}


def test_a_fixed_point_replaces_the_draw_in_workers_too() -> None:
    point = {"mud": 0.3, "camera": 1.0, "odom": 0.0}
    assert value({"world": WORLD}, (), "world", 1, point) == {"mud": 0.3, "camera": "down"}
    assert active_faults({"world": WORLD}, "world", 1, point) == {}
    plan = EpisodePlan(5, "world", point=point)
    assert planned(plan_message(plan)) == plan
    assert planned(plan_message(EpisodePlan(5))).point is None


def test_the_nominal_option_is_the_first_unless_stated() -> None:
    assert Drift.choice(1, 2, 3).value.usual == 0
    assert Drift.choice(1, 2, 3, nominal=2).value.usual == 1
    assert Drift.choice(None, 2).value.usual == 0
    assert drawn(drift("t", "camera", Drift.choice("up", "down")), "camera", 3) in ("up", "down")


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: Drift.space(), "has no direction"),
        (lambda: Drift.space(mud=Drift.range(0, 1)), "'mud' has no nominal value"),
        (lambda: Drift.range(0, 1, nominal=2), "nominal value must be a number from 0 to 1, got 2"),
        (lambda: Drift.range(0, 1, nominal=float("nan")), "nominal value must be"),
        (lambda: Drift.choice("up"), "at least two options, got 1"),
        (lambda: Drift.choice(), "at least two options, got 0"),
        (lambda: Drift.choice("up", "down", nominal="left"), "'left' is not one of"),
        (lambda: Drift.step(0, 1, nominal=1, at=-1), "at must be a moment"),
        (lambda: Drift.step(0, 1, nominal=2, at=1), "nominal value must be"),
        (lambda: Drift.step(0, 1, nominal=None, at=1), "give nominal="),  # type: ignore[arg-type]
        (lambda: Drift.ramp(0, 1, nominal=1, at=1, over=0), "over must be a duration"),
        (lambda: Drift.burst(0, 1, nominal=1, at=1, lasts=float("inf")), "lasts must be a duration"),
        (lambda: Drift.space(mud=0.15), "'mud' must be"),
        (lambda: Drift.space(mud=Drift.range(0, 1, nominal=1, permanent=True)), "'mud' is permanent"),
        (lambda: drift("t", "world", Drift(WORLD.value, permanent=True)), "cannot be permanent"),
        (lambda: drift("t", "world", {"a": Drift(WORLD.value)}), "inside a dictionary"),
    ],
)
def test_an_invalid_space_is_reported_in_one_sentence(make: Any, told: str) -> None:
    with pytest.raises(SettingsError, match=told):
        make()


def test_direction_over_time_has_a_drawn_size() -> None:
    space = Drift.space(
        step=Drift.step(0.0, 1.0, nominal=1.0, at=2.0),
        ramp=Drift.ramp(0.0, 1.0, nominal=1.0, at=2.0, over=4.0),
        burst=Drift.burst(0.0, 1.0, nominal=1.0, at=2.0, lasts=1.0),
    ).value
    world = space.world({"step": 0.2, "ramp": 0.2, "burst": 0.2})
    times = (0.0, 1.99, 2.0, 2.5, 3.0, 4.0, 6.0, 9.0)
    assert [world["step"](t) for t in times] == pytest.approx([1, 1, 0.2, 0.2, 0.2, 0.2, 0.2, 0.2])
    assert [world["ramp"](t) for t in times] == pytest.approx([1, 1, 1, 0.9, 0.8, 0.6, 0.2, 0.2])
    assert [world["burst"](t) for t in times] == pytest.approx([1, 1, 0.2, 0.2, 1, 1, 1, 1])
    nominal = space.world(space.nominal)
    assert {nominal[name](t) for name in nominal for t in times} == {1.0}
    whole = drift("t", "world", Drift(space))
    drawn_step = drawn(whole, "world", 5)["step"]
    assert drawn_step(3.0) == pytest.approx(sizes(whole, "world", 5)["step"])


@given(st.dictionaries(st.text(min_size=1), st.tuples(st.floats(0, 1), st.floats(0, 1)), min_size=1))
def test_nominal_points_lie_inside_their_space(parts: dict[str, tuple[float, float]]) -> None:
    ranges = {
        name: Drift.range(0.0, high + 1.0, nominal=share * high) for name, (share, high) in parts.items()
    }
    space = Drift.space(**ranges).value
    assert isinstance(space, Space)
    for name, extent in space.extents.items():
        assert extent.low <= space.nominal[name] <= extent.high  # type: ignore[union-attr]
    assert space.world(space.nominal) == dict(space.nominal)


@pytest.fixture
def spaced(tank: pytest.Pytester) -> pytest.Pytester:
    """A tank whose pump may be clogged, and whose gauge may be wrong."""
    changed(tank, "test_tank", "import Sensor", "import Drift, Sensor, faults")
    changed(
        tank,
        "test_tank",
        '{"clogged": 0.25}',
        '{"world": Drift.space(pump=Drift.range(0.1, 1.0, nominal=1.0),'
        ' gauge=faults.bias("/level", "data", -0.5, 0.5))}',
    )
    changed(tank, "test_tank", "1.0 if tarl_drift is None else tarl_drift", 'tarl_drift["pump"]')
    return tank


def test_recording_is_nominal_and_comparing_draws(
    spaced: pytest.Pytester,
) -> None:
    changed(spaced, "test_tank", "    tarl.start", '    print("PUMP", pump == 1.0)\n    tarl.start')
    plain = spaced.runpytest("-s")
    plain.assert_outcomes(passed=2)
    plain.stdout.fnmatch_lines(["*PUMP True*"])
    recorded = spaced.runpytest(*RECORD, "-s")
    recorded.assert_outcomes(passed=1, deselected=1)
    assert "PUMP False" not in recorded.stdout.str()
    done = spaced.runpytest(*ONLINE, "-s")
    assert "PUMP True" not in done.stdout.str()
    done.stdout.fnmatch_lines(["*degraded*"])


def test_misspelt_fault_target_is_reported(spaced: pytest.Pytester) -> None:
    changed(spaced, "test_tank", 'faults.bias("/level"', 'faults.bias("/levle"')
    told = " ".join(spaced.runpytest(*RECORD).stdout.str().split())
    assert "no message was published on /levle; the topics with messages are /level, /valve" in told
    changed(spaced, "test_tank", 'faults.bias("/levle", "data"', 'faults.bias("/level", "deta"')
    spaced.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    told = " ".join(spaced.runpytest(*ONLINE).stdout.str().split())
    assert "faults.bias of 'gauge': a message on /level (Float64) has no number 'deta'" in told


ANY: tuple[Any, ...] = (
    0, 1, -1, 0.5, -0.5, math.nan, math.inf, -math.inf, 10**400, 1e308, -1e308, 1e300, 5e-324, True, None, 1 + 2j,
    "x", "", "/a", "a b", "/a//b", "\x1b[31m", b"x", [], (1, 2), {}, object, np.float64(0.5), np.nan, np.ones(2),
)  # fmt: skip
MAKERS = {
    **{f"faults.{name}": getattr(faults, name) for name in faults.__all__},
    **{f"Drift.{name}": getattr(Drift, name) for name in ("range", "choice", "step", "ramp", "burst")},
}


@pytest.mark.parametrize("name", MAKERS)
@given(data=st.data())
@settings(max_examples=40)
def test_any_value_gives_a_usable_direction_or_a_message(name: str, data: st.DataObject) -> None:
    values, named = [], {}
    for parameter in inspect.signature(MAKERS[name]).parameters.values():
        if parameter.kind is parameter.VAR_POSITIONAL:
            values += data.draw(st.lists(st.sampled_from(ANY), max_size=3))
        elif parameter.kind is parameter.KEYWORD_ONLY:
            named[parameter.name] = data.draw(st.sampled_from(ANY))
        else:
            values.append(data.draw(st.sampled_from(ANY)))
    try:
        made = drift("t", "world", Drift.space(one=MAKERS[name](*values, **named))).value
    except SettingsError as refused:
        message = str(refused)
    else:
        message = ""
        (extent,) = made.extents.values()
        if isinstance(extent, Span):
            assert extent.low <= made.nominal["one"] <= extent.high
            assert math.isfinite(extent.high - extent.low)
    assert "\x1b" not in message


@pytest.mark.parametrize("name", ["latency", "jitter", "freeze"])
def test_a_delay_longer_than_the_clock_counts_is_refused(name: str) -> None:
    assert getattr(faults, name)("/odom", 1e9).extent.high == 1e9
    with pytest.raises(SettingsError, match=r"above 0, at most 1e\+09, got 1e\+300"):
        getattr(faults, name)("/odom", 1e300)


def test_options_can_be_arrays() -> None:
    calm, windy = np.zeros(2), np.ones(2)
    made = drift("t", "world", Drift.space(wind=Drift.choice(calm, windy, nominal=windy))).value
    assert made.nominal == {"wind": 1.0}
