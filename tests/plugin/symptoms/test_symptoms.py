"""On synthetic series, each symptom is strong for its cause, and weak for other causes or if the design has it, too."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.instrumentation.trace import Floats
from pytest_tarl.symptoms.series import Pair, Series, scale
from pytest_tarl.symptoms.symptoms import SYMPTOMS, losses

STEPS = 120
TIME = np.arange(STEPS) * 0.1
NEARING = 3.0 * np.exp(-TIME / 2.0)  # an error that a controller brings to zero


def draws(seed: int = 5) -> np.random.Generator:
    return np.random.default_rng(seed)


def series(values: Floats, reward: Floats | None = None) -> Series:
    steps = np.arange(len(values), dtype=np.int32)
    return Series(
        np.asarray(values, np.float64), steps, np.full(len(values), 0.1) if reward is None else reward
    )


def echoes() -> Floats:
    values = 3.0 + draws().normal(0.0, 0.02, STEPS)
    values[[12, 40, 71, 72 + 20, 110]] = 0.4
    return values


def wandering() -> Floats:
    return np.asarray(3.0 + 0.4 * np.sin(TIME), np.float64)


def relay(period: int) -> Floats:
    return ((np.arange(STEPS) // period) % 2).astype(np.float64)


CASES: dict[str, tuple[Floats, Floats]] = {
    "spikes": (3.0 + draws(1).normal(0.0, 0.02, STEPS), echoes()),
    "noise": (wandering(), wandering() + draws().normal(0.0, 0.2, STEPS)),
    "chatter": (relay(30), relay(2)),
    "hunting": (NEARING, NEARING + draws().normal(0.0, 0.6, STEPS)),
    "offset": (NEARING, NEARING + 1.5),
    "swing": (NEARING, NEARING + 0.8 * np.sin(TIME * 3.0)),
    "runaway": (NEARING, 3.0 * np.exp(TIME / 12.0)),
    "lag": (0.1 * relay(30) - 0.05, 0.8 * relay(30) - 0.4),
}


@pytest.mark.parametrize("name", CASES)
def test_a_symptom_is_strong_where_its_cause_is(name: str) -> None:
    designed, drifted = map(series, CASES[name])
    assert SYMPTOMS[name]([Pair(designed, drifted)]) > 0.7


@pytest.mark.parametrize("name", SYMPTOMS)
@pytest.mark.parametrize("case", CASES)
def test_designed_behaviour_is_no_symptom(name: str, case: str) -> None:
    both = series(CASES[case][1])
    assert SYMPTOMS[name]([Pair(both, both)]) == 0.0


OTHERS = [
    ("spikes", "offset"),
    ("spikes", "swing"),
    ("noise", "spikes"),
    ("noise", "offset"),
    ("chatter", "offset"),
    ("chatter", "runaway"),
    ("offset", "swing"),
    ("offset", "spikes"),
    ("swing", "offset"),
    ("swing", "noise"),
    ("runaway", "swing"),
    ("runaway", "spikes"),
    ("hunting", "noise"),
    ("hunting", "spikes"),
    ("hunting", "offset"),
    ("lag", "noise"),
    ("lag", "spikes"),
    ("lag", "chatter"),
]


@pytest.mark.parametrize(("name", "case"), OTHERS)
def test_a_symptom_is_weak_for_another_cause(name: str, case: str) -> None:
    designed, drifted = map(series, CASES[case])
    assert SYMPTOMS[name]([Pair(designed, drifted)]) < 0.5


def failing(steps: int, at: int) -> Floats:
    reward = np.full(steps, 0.1)
    reward[at] = -3.0
    return reward


def test_losses_after_jumps_differ_from_other_losses() -> None:
    speed = np.zeros(STEPS)
    speed[30:] = 1.0
    designed = series(speed)
    soon = Pair(designed, series(speed[:34], failing(34, 33)))
    late = Pair(designed, series(speed, failing(STEPS, 90)))
    assert losses(soon) == [33]
    assert SYMPTOMS["jumps"]([soon]) > 0.8
    assert SYMPTOMS["jumps"]([late]) == 0.0
    assert SYMPTOMS["jumps"]([Pair(designed, designed)]) == 0.0


def test_a_first_command_is_a_jump_from_rest() -> None:
    designed = series(np.full(STEPS, 0.9))
    assert SYMPTOMS["jumps"]([Pair(designed, series(np.array([0.9, 0.9]), failing(2, 1)))]) > 0.8


def test_constantly_jumping_value_causes_no_loss() -> None:
    pair = Pair(series(relay(2)), series(relay(2)[:50], failing(50, 49)))
    assert SYMPTOMS["jumps"]([pair]) < 0.1


def test_an_error_that_vanishes_early_is_not_an_offset() -> None:
    assert SYMPTOMS["offset"]([Pair(series(NEARING), series(NEARING[:20], failing(20, 19)))]) < 0.1


def test_value_far_from_zero_has_no_offset() -> None:
    assert SYMPTOMS["offset"]([Pair(series(wandering()), series(wandering() + 0.9))]) < 0.3


def test_the_scale_leaves_out_single_values() -> None:
    values = np.zeros(STEPS)
    values[3] = 100.0
    assert scale([Pair(series(values), series(values))]) == 0.0
    assert scale([]) == 0.0


NUMBERS = st.lists(st.floats(-1e6, 1e6), max_size=30)
Change = Callable[[Floats], Floats]


@given(NUMBERS, NUMBERS, st.sampled_from(sorted(SYMPTOMS)))
def test_every_strength_is_between_zero_and_one(one: list[float], other: list[float], name: str) -> None:
    pair = Pair(series(np.array(one)), series(np.array(other), -np.arange(float(len(other)))))
    assert 0.0 <= SYMPTOMS[name]([pair]) <= 1.0


@given(st.sampled_from(sorted(CASES)), st.sampled_from(sorted(SYMPTOMS)), st.floats(1e-3, 1e3))
def test_a_strength_does_not_depend_on_the_unit(case: str, name: str, unit: float) -> None:
    plain, scaled = ([Pair(*(series(each * by) for each in CASES[case]))] for by in (1.0, unit))
    assert SYMPTOMS[name](scaled) == pytest.approx(SYMPTOMS[name](plain), abs=1e-6)


@pytest.mark.parametrize(
    ("drifted", "expected"),
    [
        (np.linspace(3.0, 0.0, 30), 0.0),  # as designed
        (np.linspace(3.0, -0.25, 30), 0.48),
        (np.linspace(3.0, -1.0, 30), 1.0),
        (np.linspace(-3.0, 1.0, 30), 1.0),  # from the other side
        (np.where(np.arange(30) == 20, -3.0, np.linspace(3.0, 0.0, 30)), 0.0),  # a single value
        (np.zeros(30), 0.0),
        (np.linspace(3.0, -1.0, 5), 0.0),  # too few values
    ],
)
def test_an_overshoot_passes_zero_farther_than_designed(drifted: np.ndarray, expected: float) -> None:
    def series(values: np.ndarray) -> Series:
        return Series(values, np.arange(values.size, dtype=np.int32), np.zeros(values.size))

    designed = series(np.linspace(3.0, 0.0, 30))
    found = SYMPTOMS["overshoot"]([Pair(designed, series(drifted))] * 2)
    assert found == pytest.approx(expected, abs=0.05)
    late = Pair(designed, designed)
    assert SYMPTOMS["overshoot"]([Pair(designed, series(drifted)), late]) == 0.0  # in one mission only
