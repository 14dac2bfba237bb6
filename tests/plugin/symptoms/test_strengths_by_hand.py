"""The strength of each symptom, compared with values that are worked out by hand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from pytest_tarl.instrumentation.trace import Floats
from pytest_tarl.symptoms.series import Pair, Series, scale
from pytest_tarl.symptoms.symptoms import SYMPTOMS, losses


def array(*parts: float | Sequence[float] | Floats) -> Floats:
    return np.concatenate([np.atleast_1d(np.asarray(part, np.float64)) for part in parts])


def series(values: Floats, reward: Floats | None = None) -> Series:
    """Return a series with one value in each step."""
    return Series(
        values, np.arange(len(values), dtype=np.int32), np.zeros(len(values)) if reward is None else reward
    )


def pair(designed: Floats, drifted: Floats) -> Pair:
    return Pair(series(designed), series(drifted))


def strength(name: str, *pairs: Pair) -> float:
    return SYMPTOMS[name](pairs)


def step(size: int, low: float = 0.0, high: float = 1.0) -> Floats:
    """Return values that rise once, in the middle."""
    return array([low] * (size // 2), [high] * (size - size // 2))


def with_values(values: Floats, **changed: float) -> Floats:
    """Return the values with some of them replaced, such as `at3=1.0`."""
    found = values.copy()
    for name, value in changed.items():
        found[int(name.removeprefix("at"))] = value
    return found


EMPTY = series(np.zeros(0))


# series


def test_series_is_cut_at_a_step() -> None:
    whole = Series(
        array(1.0, 2.0, 3.0, 4.0, 5.0), np.array([0, 1, 1, 2, 3], np.int32), array(0.1, 0.2, 0.3, 0.4)
    )
    cut = whole.until(2)
    assert cut.values.tolist() == [1.0, 2.0, 3.0]
    assert cut.step.tolist() == [0, 1, 1]
    assert cut.reward.tolist() == [0.1, 0.2]


@pytest.mark.parametrize(("designed", "drifted"), [(7, 4), (4, 7)])
def test_both_series_end_with_the_shorter_mission(designed: int, drifted: int) -> None:
    both = pair(np.arange(float(designed)), np.arange(float(drifted)) + 10.0).together()
    assert both.designed.values.tolist() == [0.0, 1.0, 2.0, 3.0]
    assert both.drifted.values.tolist() == [10.0, 11.0, 12.0, 13.0]


def test_scale_is_the_trimmed_range_of_designed_values() -> None:
    values = np.arange(101.0)
    assert scale([pair(values, values * 50.0)]) == pytest.approx(96.0)
    assert scale([pair(values[:50], values), pair(values[50:], values)]) == pytest.approx(96.0)


# spikes: a hundred values have neighbours on both sides, and four more percent of them are certain


@pytest.mark.parametrize(("number", "expected"), [(0, 0.0), (1, 0.25), (3, 0.75), (4, 1.0), (5, 1.0)])
def test_spike_strength_is_the_growth_of_their_share(number: int, expected: float) -> None:
    spiky = step(102)
    spiky[4 : 4 + 3 * number : 3] = 0.5
    assert strength("spikes", pair(step(102), spiky)) == pytest.approx(expected)
    assert strength("spikes", pair(spiky, step(102))) == 0.0


@pytest.mark.parametrize(
    ("before", "value", "after", "expected"),
    [
        (0.0, 0.25, 0.0, 0.25),  # a quarter of the scale
        (0.0, 0.24, 0.0, 0.0),
        (0.0, -0.25, 0.0, 0.25),  # spikes point in either direction
        (0.0, 1.5, 0.5, 0.25),  # a change of 0.5 across a spike that is 1.0 higher than its higher neighbour
        (0.5, 1.5, 0.0, 0.25),
        (0.0, 1.25, 0.5, 0.0),
        (0.0, 1.0, 1.0, 0.0),  # a step
        (0.0, 1.0, 2.0, 0.0),  # a slope
    ],
)
def test_spike_returns_to_where_it_came_from(
    before: float, value: float, after: float, expected: float
) -> None:
    edge = [before] * 20 + [value] + [after] * 20
    rest = [0.0] * 10 + [1.0] * 51
    assert strength("spikes", pair(step(102), array(edge, rest))) == pytest.approx(expected)


def test_spikes_need_six_values() -> None:
    assert strength("spikes", pair(step(6), array(0, 0, 1, 0, 0, 0))) == 1.0
    assert strength("spikes", pair(step(6), array(0, 0, 1, 0, 0))) == 0.0


def test_spikes_are_measured_on_the_larger_of_both_scales() -> None:
    spiky = with_values(step(102), at10=0.5)
    assert strength("spikes", pair(np.zeros(102), spiky)) == pytest.approx(0.25)
    assert strength("spikes", pair(step(102), with_values(np.zeros(102), at10=0.5))) == pytest.approx(0.25)
    assert strength("spikes", pair(step(102, high=3.0), spiky)) == 0.0
    assert strength("spikes", pair(step(102), with_values(step(102, high=3.0), at10=0.5))) == 0.0
    assert strength("spikes", pair(np.zeros(102), np.zeros(102))) == 0.0


def test_spike_strength_is_a_mean_over_pairs() -> None:
    spiky = pair(step(102), with_values(step(102), at10=0.5))
    assert strength("spikes", spiky, pair(step(102), step(102))) == pytest.approx(0.125)


# noise: at a growth by 1.5 it begins, by 6 it is certain, and 3 is the middle on a log scale


def zigzag(size: int, height: float) -> Floats:
    """Return values whose second differences are all twice the height."""
    return np.asarray(np.arange(size) % 2 * height, np.float64)


@pytest.mark.parametrize(
    ("rough", "expected"), [(0.0, 0.0), (0.005, 0.0), (0.02, 0.5), (0.05, 1.0), (0.5, 1.0)]
)
def test_noise_strength_is_the_growth_of_roughness(rough: float, expected: float) -> None:
    found = strength("noise", pair(step(60), zigzag(60, rough / 2)))  # 1 % of the scale is added to both
    assert found == pytest.approx(expected, abs=1e-9)


def test_roughness_is_compared_between_worlds() -> None:
    designed = step(60) + zigzag(60, 0.005)
    least = 0.01 * 1.005
    rough = 3.0 * (0.01 + least) - least
    assert strength("noise", pair(designed, zigzag(60, rough / 2))) == pytest.approx(0.5)
    assert strength("noise", pair(zigzag(60, rough / 2), designed)) == 0.0


def test_noise_needs_six_values_and_a_scale() -> None:
    assert strength("noise", pair(step(60), zigzag(6, 1.0))) == 1.0
    assert strength("noise", pair(step(60), zigzag(5, 1.0))) == 0.0
    assert strength("noise", pair(np.zeros(60), zigzag(60, 1.0))) == 0.0


def test_a_single_rough_place_does_not_count_as_noise() -> None:
    assert strength("noise", pair(step(60), with_values(step(60), at7=9.0, at20=9.0))) == 0.0


# chatter: of a hundred steps, ten more with a switch are certain


def switching(number: int, low: float = 0.0, high: float = 1.0, size: int = 101) -> Floats:
    """Return values with a number of switches between low and high."""
    states = np.minimum(np.arange(size), number) % 2
    return np.where(states == 1, high, low)


@pytest.mark.parametrize(("number", "expected"), [(1, 0.0), (2, 0.1), (6, 0.5), (11, 1.0), (60, 1.0)])
def test_chatter_strength_is_the_growth_of_switches(number: int, expected: float) -> None:
    assert strength("chatter", pair(switching(1), switching(number))) == pytest.approx(expected)
    assert strength("chatter", pair(switching(number), switching(1))) == 0.0


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [(-2.0, 0.0, 0.5), (-3.0, -1.0, 0.0), (-1.0, 0.0, 0.5), (-0.5, 1.0, 0.0), (-3.0, -2.0, 0.0)],
)
def test_switch_crosses_the_middle_in_both_worlds(low: float, high: float, expected: float) -> None:
    designed = array(-3.0, [-3.0] * 50, [1.0] * 50)  # the middle is -1, which is not above itself
    shift = strength("chatter", pair(designed, switching(6, low, high)))
    assert shift == pytest.approx(expected)


def test_chatter_needs_six_values() -> None:
    assert strength("chatter", pair(switching(1), switching(3, size=6))) == 1.0
    assert strength("chatter", pair(switching(1), switching(3, size=5))) == 0.0
    assert strength("chatter", pair(np.ones(101), np.ones(101))) == 0.0
    assert strength("chatter", Pair(EMPTY, EMPTY)) == 0.0


# losses and jumps


@pytest.mark.parametrize(
    ("designed", "reward", "lost"),
    [(1.0, -0.01, True), (1.0, 0.0, False), (-1.0, -2.01, True), (-1.0, -2.0, False), (-1.0, 5.0, False)],
)
def test_loss_counts_beyond_every_designed_loss(designed: float, reward: float, lost: bool) -> None:
    found = losses(
        Pair(
            series(np.zeros(50), np.full(50, designed)),
            series(np.zeros(3), array(designed, reward, designed)),
        )
    )
    assert found == ([1] if lost else [])


def test_steps_without_a_designed_counterpart_lose_nothing() -> None:
    assert losses(Pair(EMPTY, series(np.zeros(3), array(-1.0, -1.0, -1.0)))) == []


def lost_at(size: int, *steps: int) -> Floats:
    reward = np.zeros(size)
    reward[list(steps)] = -1.0
    return reward


@pytest.mark.parametrize(("loss", "expected"), [(29, 0.0), (30, 0.95), (35, 0.95), (36, 0.0)])
def test_loss_soon_after_a_jump_is_due_to_it(loss: int, expected: float) -> None:
    jumping = step(60)
    found = Pair(
        series(step(120)), series(jumping, lost_at(60, loss))
    )  # 6 of the 120 steps are soon by design
    assert strength("jumps", found) == pytest.approx(expected)


def test_strength_is_the_share_of_losses_after_a_jump() -> None:
    assert strength("jumps", Pair(series(step(120)), series(step(60), lost_at(60, 5, 32)))) == pytest.approx(
        0.45
    )
    assert strength("jumps", Pair(series(step(120)), series(step(60)))) == 0.0


@pytest.mark.parametrize(("size", "expected"), [(0.4, 0.95), (0.39, 0.0), (-0.4, 0.95)])
def test_a_jump_is_forty_percent_of_the_range(size: float, expected: float) -> None:
    drifted = series(step(60, high=size), lost_at(60, 31))
    assert strength("jumps", Pair(series(step(120)), drifted)) == pytest.approx(expected)


@pytest.mark.parametrize(("size", "expected"), [(4.0, 0.95), (3.9, 0.0)])
def test_the_size_of_a_steady_value_replaces_its_range(size: float, expected: float) -> None:
    drifted = series(step(60, high=size), lost_at(60, 31))
    for steady in (10.0, -10.0):
        assert strength("jumps", Pair(series(np.full(120, steady)), drifted)) == pytest.approx(expected)


def test_jumps_are_found_in_the_step_of_the_value() -> None:
    drifted = Series(array(0.0, 0.0, 1.0), np.array([3, 3, 20], np.int32), lost_at(60, 25))
    assert strength("jumps", Pair(series(step(120)), drifted)) == pytest.approx(0.95)
    late = Series(array(0.0, 0.0, 1.0), np.array([3, 20, 26], np.int32), lost_at(60, 25))
    assert strength("jumps", Pair(series(step(120)), late)) == 0.0


def test_zero_values_have_no_jumps() -> None:
    known = Pair(series(step(120)), series(step(60), lost_at(60, 31)))
    assert strength("jumps", known, Pair(EMPTY, series(step(60)))) == pytest.approx(0.975)
    assert strength("jumps", Pair(series(np.zeros(120)), series(step(60), lost_at(60, 31)))) == 0.0


def test_empty_mission_has_no_large_value() -> None:
    none = Series(np.zeros(0), np.zeros(0, np.int32), np.zeros(120))
    steady = Pair(series(np.full(120, 0.1)), series(step(60)))
    found = Pair(none, series(step(60, high=0.05), lost_at(60, 31)))
    assert strength("jumps", found, steady) == pytest.approx(
        1.0 - 6 / 120 / 2
    )  # one first value of six steps


# offset: the second halves of 20 values, and half of the range is certain


def ends(start: float, end: float | Sequence[float], size: int = 20) -> Floats:
    late = [end] * (size - size // 2) if isinstance(end, int | float) else list(end)
    return array([start] * (size // 2), late)


@pytest.mark.parametrize(
    ("end", "expected"), [(0.0, 0.0), (1.0, 0.5), (-1.0, 0.5), (2.0, 1.0), (4.0, 1.0), (-4.0, 1.0)]
)
def test_offset_strength_is_the_growth_of_the_final_mean(end: float, expected: float) -> None:
    assert strength("offset", pair(ends(4.0, 0.0), ends(4.0, end))) == pytest.approx(expected)


def test_offset_is_weaker_far_from_zero() -> None:
    # the range is 3; a quarter of the largest value is left by design
    assert strength("offset", pair(ends(4.0, 1.0), ends(4.0, 1.75))) == pytest.approx(0.75 * 0.5)
    assert strength("offset", pair(ends(4.0, 1.0), ends(4.0, 0.5))) == 0.0


def test_an_offset_is_weaker_if_the_value_changes_sign() -> None:
    found = strength("offset", pair(ends(4.0, 0.0), ends(4.0, [3.0, -1.0] * 5)))
    assert found == pytest.approx(0.5 / np.sqrt(5.0))


def test_offset_of_a_swinging_value_is_found() -> None:
    swing = np.tile([2.0, -2.0], 20)
    assert strength("offset", pair(swing, swing + 2.0)) == pytest.approx(1.0)
    assert strength("offset", pair(swing, swing + 1.0)) == pytest.approx(0.5)
    assert strength("offset", pair(swing + 1.0, swing)) == 0.0  # towards zero
    assert strength("offset", pair(swing, 2.0 * swing)) == 0.0
    assert strength("offset", pair(swing + 9.0, swing + 12.0)) < 0.2  # far from zero by design


def test_offsets_to_both_sides_do_not_cancel() -> None:
    sides = [pair(ends(4.0, 0.0), ends(4.0, end)) for end in (1.0, -1.0)]
    assert strength("offset", *sides) == pytest.approx(0.5)


def test_an_offset_needs_three_values_in_each_second_half() -> None:
    assert strength("offset", pair(ends(4.0, 0.0, 5), ends(4.0, 2.0, 5))) == pytest.approx(1.0, abs=0.05)
    assert strength("offset", pair(ends(4.0, 0.0, 4), ends(4.0, 2.0, 4))) == 0.0
    designed, drifted = ends(4.0, 0.0), ends(4.0, 2.0)
    few = np.array([0, 1, 18, 19], np.int32)
    reward = np.zeros(20)
    sparse, dense = Series(drifted[few], few, reward), series(drifted)
    assert strength("offset", Pair(series(designed), dense)) == 1.0
    assert strength("offset", Pair(series(designed), sparse)) == 0.0
    assert strength("offset", Pair(Series(designed[few], few, reward), dense)) == 0.0
    assert strength("offset", pair(np.ones(20), ends(4.0, 2.0))) == 0.0


def test_pair_with_few_values_has_no_offset() -> None:
    known, few = pair(ends(4.0, 0.0), ends(4.0, 2.0)), pair(ends(4.0, 0.0, 4), ends(4.0, 2.0, 4))
    assert strength("offset", known) == 1.0
    assert strength("offset", known, few) == strength("offset", few, known) == 0.0
    swinging = pair(at_rest(24), array(np.zeros(24), square(1.0, *[3] * 8)))
    short = pair(at_rest(5), array(np.zeros(5), square(1.0, 3, 2)))
    assert strength("swing", swinging) > 0.0
    assert strength("swing", swinging, short) == strength("swing", short, swinging) == 0.0


# swing: at a growth by 2 it begins, by 6 it is certain, and the root of 12 is the middle


def square(height: float, *lengths: int) -> Floats:
    """Return values at plus and minus the height, which change their side after each length."""
    return array(*([height * (-1) ** number] * length for number, length in enumerate(lengths)))


def at_rest(late: int) -> Floats:
    """Return designed values between 0 and 1 whose second half rests."""
    return array(step(late), np.zeros(late))


SMOOTH = 37 / 59  # of the 59 pairs of neighbours in twelve fives, 11 differ in sign and 48 do not


@pytest.mark.parametrize(("growth", "expected"), [(2.0, 0.0), (12.0**0.5, 0.5), (6.0, 1.0), (20.0, 1.0)])
def test_swing_strength_is_the_growth_of_the_deviation(growth: float, expected: float) -> None:
    height = growth * 0.02
    drifted = array(np.zeros(60), square(height, *[5] * 12))
    assert strength("swing", pair(at_rest(60), drifted)) == pytest.approx(expected * SMOOTH)


def test_designed_swing_is_compared_with_the_drifted_swing() -> None:
    designed = array(step(60), square(0.01, *[5] * 12))
    least = 0.02 * scale([pair(designed, designed)])
    drifted = array(np.zeros(60), square(12.0**0.5 * (0.01 + least), *[5] * 12))
    assert strength("swing", pair(designed, drifted)) == pytest.approx(0.5 * SMOOTH)


def test_a_swing_crosses_its_mean_three_times() -> None:
    assert strength("swing", pair(at_rest(40), array(np.zeros(40), square(1.0, 10, 10, 10, 10)))) > 0.8
    assert strength("swing", pair(at_rest(40), array(np.zeros(40), square(1.0, 10, 20, 10)))) == 0.0


def test_touching_the_mean_is_no_crossing() -> None:
    late = array([1, 1, 0, 1, 1, 0, 1, 1, 0, 1, 1, -2, -2, -2, -2])
    assert strength("swing", pair(at_rest(15), array(np.zeros(15), late))) == 0.0


def test_alternating_value_does_not_swing() -> None:
    assert strength("swing", pair(at_rest(40), array(np.zeros(40), square(1.0, *[1] * 40)))) == 0.0
    assert strength("swing", pair(at_rest(40), np.zeros(80))) == 0.0
    assert strength("swing", pair(np.zeros(80), array(np.zeros(40), square(1.0, *[10] * 4)))) == 0.0


def test_a_swing_needs_six_values_in_each_second_half() -> None:
    six = array(np.zeros(6), 3.0, 3.0, -0.5, 0.5, -3.0, -3.0)
    five = array(np.zeros(5), 3.0, 3.0, -0.5, 0.5, -6.0)
    assert strength("swing", pair(at_rest(6), six)) == pytest.approx((14.75 / 5) / (36.5 / 6))
    assert strength("swing", pair(at_rest(6), five)) == 0.0
    assert strength("swing", pair(at_rest(5), six)) == 0.0


# runaway: the first and the last third of nine values, and a growth by 20 % of their sum is certain


def thirds(start: float, middle: float, end: float, part: int = 3) -> Floats:
    return array([start] * part, [middle] * part, [end] * part)


FLAT = thirds(1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("start", "end", "expected"),
    [(1.0, 1.2, 0.2 / 2.2 / 0.2), (1.0, 1.0, 0.0), (1.2, 1.0, 0.0), (2.0, 3.0, 1.0), (1.0, 9.0, 1.0)],
)
def test_runaway_strength_is_the_growth_of_size(start: float, end: float, expected: float) -> None:
    middle = end  # the second half has one value, then, and is on one side
    assert strength("runaway", pair(FLAT, thirds(start, middle, end))) == pytest.approx(expected)
    assert strength("runaway", pair(FLAT, -thirds(start, middle, end))) == pytest.approx(expected)


def test_designed_growth_is_subtracted() -> None:
    drifted = thirds(1.0, 1.2, 1.2)
    assert strength("runaway", pair(thirds(1.0, 1.1, 1.1), drifted)) == pytest.approx(
        (0.2 / 2.2 - 0.1 / 2.1) / 0.2
    )
    assert strength("runaway", pair(thirds(9.0, 1.0, 0.0), drifted)) == pytest.approx(0.2 / 2.2 / 0.2)


def test_sign_change_weakens_a_runaway() -> None:
    drifted = array([1.0] * 3, [9.0, 3.0], [-1.0, 3.0, -1.0, 3.0])
    assert strength("runaway", pair(FLAT, drifted)) == pytest.approx(1.4 / np.sqrt(29 / 5))


def test_only_the_outer_thirds_are_compared() -> None:
    grown = array(1.0, 1.0, 1.0, [1.2] * 5, 1.2, 1.2, 1.2)  # eleven values have thirds of three
    assert strength("runaway", pair(np.ones(11), grown)) == pytest.approx(0.2 / 2.2 / 0.2)


def test_running_away_needs_six_values() -> None:
    assert strength("runaway", pair(np.ones(6), thirds(1.0, 9.0, 9.0, part=2))) == 1.0
    assert strength("runaway", pair(np.ones(5), array(1.0, 1.0, 9.0, 9.0, 9.0))) == 0.0
    assert strength("runaway", pair(FLAT, np.zeros(9))) == 0.0
    assert strength("runaway", pair(np.zeros(9), np.zeros(9))) == 0.0


def test_missions_are_compared_up_to_the_shorter_end() -> None:
    longer = array(thirds(1.0, 1.2, 1.2), [99.0] * 9)
    assert strength("runaway", pair(FLAT, longer)) == pytest.approx(0.2 / 2.2 / 0.2)
