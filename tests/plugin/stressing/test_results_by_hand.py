"""Boundaries, rays and evidence of stress runs, for curves and episodes written down by hand."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.learning.bounds import Range
from pytest_tarl.spaces import Choice, Span
from pytest_tarl.stressing.boundary import _candidates, bisect
from pytest_tarl.stressing.combinations import Together, _inside, _share
from pytest_tarl.stressing.coordinates import Coordinates
from pytest_tarl.stressing.findings import Curve, contains
from pytest_tarl.stressing.fresh_values import Model
from pytest_tarl.stressing.guarantee import (
    Evidence,
    Outcome,
    Part,
    enough_pass,
    examined,
    hopeless,
    little_lost,
    margin_of,
    margin_of_one,
    most_passed,
    refuted,
    unlike_recorded,
)
from pytest_tarl.stressing.holding import least
from pytest_tarl.stressing.kept import Replayed, _judged
from pytest_tarl.stressing.margin_changes import Row, compared
from pytest_tarl.stressing.margin_changes import words as boundary_words
from pytest_tarl.stressing.margins import Margin, Margins
from pytest_tarl.stressing.rays import distance, joined, rays
from pytest_tarl.stressing.regions import outwards, regions
from pytest_tarl.stressing.shrinking import weighted
from pytest_tarl.stressing.sobol_indices import _number, affordable
from pytest_tarl.stressing.spreading import _inverse, _primes
from pytest_tarl.stressing.stress_run import divided
from tests.plugin.stressing.test_words_by_hand import (
    DOWN,
    FLAT,
    GIVEN,
    GOOD,
    LEFT,
    MUD,
    SPACE,
    STEEP,
    combined,
    curve,
    seen,
)


def test_rays_lead_to_range_ends_and_options() -> None:
    found = [(ray.names[0], ray.farthest[ray.names[0]]) for ray in rays(SPACE, {})]
    assert found == [("mud", 0.0), ("slope", -1.0), ("slope", 1.0), ("camera", 1.0), ("camera", 2.0)]
    mud, flat, steep, down, _ = rays(SPACE, {"mud": (3.0, 4.0), "slope": (-1.0, 0.25), "camera": ("down",)})
    assert (mud.extra, flat.extra, steep.extra, down.extra) == ((0.25,), (), (0.25,), ())
    assert mud.places == (1.0, 0.75, 0.5, 0.25)
    assert replace(mud, extra=(0.1,)).places == (1.0, 0.75, 0.5, 0.25, 0.1)
    assert (down.places, down.continuous, mud.continuous) == ((1.0,), False, True)
    assert (down.point(0.01)["camera"], down.point(0.0)["camera"]) == (1.0, 0.0)
    assert (mud.value(0.25), mud.length, flat.length, down.length) == (3.0, 1.0, 0.5, 1.0)


def test_combined_ray_passes_through_the_sum_of_points() -> None:
    both = joined([(MUD, 0.5), (STEEP, 0.5)])
    assert both.farthest == {"mud": 2.0, "slope": 0.5, "camera": 0.0}
    assert (both.names, both.length) == (("mud", "slope"), pytest.approx(sqrt(0.25 + 0.0625)))
    assert both.point(0.5) == {"mud": 3.0, "slope": 0.25, "camera": 0.0}


def test_regions_beyond_a_failure_reach_the_ends() -> None:
    wide, narrow = regions(SPACE, combined(mud=1.0, slope=-0.5, camera=1.0))
    assert wide.words == "mud from 1 to 0 and slope from -0.5 to -1 and camera='down'"
    assert narrow.words == "mud from 1 to 0.75 and slope from -0.5 to -0.625 and camera='down'"
    assert wide.drift.value.directions == {"mud": Span(0.0, 1.0, 1.0), "slope": Span(-1.0, -0.5, -0.5)}
    (end,) = regions(SPACE, combined(mud=0.0, camera=1.0))
    assert (end.words, end.drift.value) == ("mud=0 and camera='down'", (0.0, "down"))
    (option,) = regions(SPACE, combined(camera=2.0))
    assert option.drift.value == "left"


def test_combined_ray_extends_ranges_and_keeps_options() -> None:
    ray = outwards(SPACE, combined(mud=3.0, slope=0.5, camera=1.0))
    assert ray.farthest == {"mud": 2.0, "slope": 1.0, "camera": 1.0}
    assert outwards(SPACE, combined(camera=1.0)).farthest == {"mud": 4.0, "slope": 0.0, "camera": 1.0}


def test_a_weight_interpolates_between_nominal_and_a_drift_size() -> None:
    assert weighted(SPACE, "mud", 2.0, 0.25) == 3.5
    assert weighted(SPACE, "mud", 2.0, 0.0) == 4.0
    assert (weighted(SPACE, "camera", 2.0, 0.1), weighted(SPACE, "camera", 2.0, 0.0)) == (2.0, 0.0)


def test_vectors_are_clipped_to_ranges_and_length() -> None:
    one = Coordinates(SPACE, {**SPACE.nominal, "camera": 1.0})
    assert (one.low.tolist(), one.high.tolist(), one.options) == ([-1.0, -0.5], [0.0, 0.5], 1)
    assert one.covers({"mud": 1.0, "slope": 1.0, "camera": 1.0})
    assert not one.covers(SPACE.nominal)
    assert one.point(np.array([-0.5, 9.0])) == {"mud": 2.0, "slope": 1.0, "camera": 1.0}
    assert one.point(np.array([-1e-13, 0.25])) == {"mud": 4.0, "slope": 0.5, "camera": 1.0}
    assert one.within(np.array([-0.6, 0.0]), 1.0) is None
    shorter = one.within(np.array([-0.6, 0.0]), sqrt(1.09))
    assert shorter is not None
    assert shorter.tolist() == pytest.approx([-0.3, 0.0])
    same = one.within(np.array([-0.3, 0.0]), 2.0)
    assert same is not None
    assert same.tolist() == [-0.3, 0.0]


@pytest.mark.parametrize(
    ("passed", "loss", "expected"),
    [
        (1.0, 0.0, 1.0),
        (1.0, -9.0, 1.0),
        (0.95, 0.0, 0.5),
        (1.0, 0.25, 0.5),
        (0.9, 0.25, 0.0),
        (0.8, 0.0, -1.0),
    ],
)
def test_margin_is_the_smaller_of_pass_and_reward_margins(
    passed: float, loss: float, expected: float
) -> None:
    assert GIVEN.margin(passed, loss) == pytest.approx(expected)


def test_without_a_tolerance_any_loss_makes_the_margin_negative() -> None:
    strict = replace(GIVEN, tolerance=0.0)
    assert (strict.margin(1.0, 0.0), strict.margin(1.0, 0.01)) == (1.0, -1.0)
    assert margin_of_one(GIVEN, Outcome(True, 9.75), Outcome(False, 10.0)) == pytest.approx(0.5)


FINE, FAILED = Outcome(True, 10.0), Outcome(False, 10.0)


def test_losses_are_paired_by_seed_with_at_least_eight() -> None:
    outcomes = [Outcome(True, 9.9), Outcome(True, 9.7)] * 4
    found = examined(GIVEN, outcomes, [FINE] * 8)
    assert (found.result, found.episodes, found.passed) == ("holds", 8, 8)
    assert (found.loss, found.margin) == (pytest.approx(0.2), pytest.approx(0.6))
    assert found.spread == pytest.approx(0.1 * sqrt(8 / 7))
    assert examined(GIVEN, outcomes[:7], [FINE] * 7).result == "open"
    assert examined(GIVEN, [FINE], [FINE]).spread == 0.0
    assert examined(GIVEN, [FINE] * 7 + [FAILED], [FINE] * 8).result == "open"
    assert seen(-0.1, "open").failing
    assert not seen(0.0, "open").failing
    assert seen(0.5, "fails").failing


def test_the_standard_error_of_a_margin_equals_the_formula() -> None:
    margin, deviation = margin_of(GIVEN, [Outcome(True, 9.9), Outcome(True, 9.7)], [FINE] * 2)
    prior = (0.5 / 3) ** 2
    assert margin == pytest.approx(0.6)
    assert deviation == pytest.approx(sqrt((0.02 + 2 * prior) / 3 / 2) / 0.5)
    margin, deviation = margin_of(GIVEN, [FAILED] * 4, [FINE] * 4)
    assert (margin, deviation) == (-1.5, pytest.approx(0.1))
    assert margin_of(replace(GIVEN, tolerance=0.0), [FINE] * 4, [FINE] * 4) == (1.0, 1.0)


def test_numbers_that_prove_or_refute_the_guarantee_are_computed() -> None:
    """At a rate of 0.9, 8 episodes all pass with probability 0.9⁸ = 0.43 and show nothing; 44 passes suffice at 1 %."""
    assert not enough_pass(GIVEN, [FINE] * 43, 0.01)
    assert enough_pass(GIVEN, [FINE] * 44, 0.01)  # 0.9⁴⁴ = 0.0097
    assert least(0.9, 0, 0.01) == 44
    assert most_passed(GIVEN, 1, 0.01) == -1
    assert most_passed(GIVEN, 3, 0.01) == 0  # 0.1³ = 0.001 < 0.005 < 0.028
    assert most_passed(GIVEN, 32, 0.01) == 23  # 9 failures or more: 0.0038, 8 or more: 0.012


def test_test_stops_early_if_refutation_is_unlikely() -> None:
    nominal = [Outcome(True, 10.0)] * 16

    def ends(failed: int, loss: float) -> bool:
        outcomes = [Outcome(n >= failed, 10.0 - loss + 0.1 * (-1) ** n) for n in range(16)]
        return hopeless(GIVEN, outcomes, nominal, 64, 0.01)

    tolerance = GIVEN.tolerance
    assert ends(0, 0.0)
    assert ends(0, tolerance - 0.1)  # the mean loss has a standard error of 0.026
    assert not ends(0, tolerance - 0.02)
    assert not ends(0, tolerance + 0.1)
    assert not ends(8, 0.0)


def test_strict_test_stops_if_equal_losses_cannot_refute() -> None:
    """Losses alternate around their mean; they deviate by 0.1, so the mean of 16 has a standard error of 0.026.

    If 48 of 64 episodes lose one standard error more, the mean grows by 0.019. The quantiles are Student's.
    """
    nominal = [Outcome(True, 10.0)] * 16

    def ends(excess: float, failed: int = 0, part: Part = "loss") -> bool:
        loss = GIVEN.tolerance + excess
        outcomes = [Outcome(n >= failed, 10.0 - loss + 0.1 * (-1) ** n) for n in range(16)]
        return hopeless(GIVEN, outcomes, nominal, 64, 0.005, part, strict=True)

    needed = 2.66 * 0.1 / sqrt(63) - 0.75 * 1.03 * 0.1 / sqrt(15)
    assert ends(needed - 0.002)
    assert not ends(needed + 0.002)
    assert ends(needed + 0.002, part="both")  # at half of the risk
    assert not ends(needed - 0.1, failed=8, part="both")
    assert ends(needed + 0.1, part="rate")
    whole = [Outcome(True, 10.0 - GIVEN.tolerance - 0.05 + 0.1 * (-1) ** n) for n in range(64)]
    assert not hopeless(GIVEN, whole, nominal * 4, 64, 0.005, "loss", strict=True)
    assert refuted(GIVEN, whole, nominal * 4, 0.005, "loss")


@pytest.mark.parametrize("directions", [1, 4, 50])
@pytest.mark.parametrize("alpha", [0.01, 0.05, 0.3])
def test_claim_risks_add_up_to_alpha_at_most(alpha: float, directions: int) -> None:
    risks = divided(alpha, directions)
    assert risks.combinations + (directions + 1) * risks.each <= alpha * (1 + 1e-12)
    assert min(risks.each, risks.combinations) > 0.0


def test_acceptable_loss_has_an_upper_bound_below_the_tolerance() -> None:
    assert little_lost(GIVEN, [Outcome(True, 9.7), Outcome(True, 9.8)] * 8, [FINE] * 16, 0.05)
    assert not little_lost(GIVEN, [Outcome(True, 9.2), Outcome(True, 9.9)] * 8, [FINE] * 16, 0.05)
    declared = replace(GIVEN, declared=Range(0.0, 100.0))
    assert not little_lost(declared, [Outcome(True, 9.7), Outcome(True, 9.8)] * 8, [FINE] * 16, 0.05)


def test_worse_nominal_world_differs_from_the_recording() -> None:
    varied = replace(GIVEN, totals=(9.9, 10.1) * 10)
    assert not unlike_recorded(varied, [Outcome(True, 9.9), Outcome(True, 9.8)] * 8, 0.05)
    assert unlike_recorded(varied, [Outcome(True, 9.0), Outcome(True, 8.9)] * 8, 0.05)
    assert unlike_recorded(varied, [FAILED] * 16, 0.05)


@pytest.mark.parametrize(
    ("outcomes", "fails", "passed", "loss"),
    [
        ([FINE] * 4, False, 4, 0.0),
        ([FINE, FINE, FINE, FAILED], True, 3, 0.0),
        ([Outcome(True, 9.5)] * 4, False, 4, 0.5),
        ([Outcome(True, 9.4)] * 4, True, 4, 0.6),
    ],
)
def test_kept_drift_counts_only_if_it_fails_again(
    outcomes: list[Outcome], fails: bool, passed: int, loss: float
) -> None:
    found = _judged({"mud": 1.0}, outcomes, GIVEN)
    assert found == Replayed({"mud": 1.0}, fails, passed, found.loss)
    assert found.loss == pytest.approx(loss)


def test_search_confirms_clearly_failing_sizes() -> None:
    option = curve(DOWN, {1.0: -1.0})
    assert _candidates(option, GIVEN, 0.1) == [1.0]
    assert _candidates(curve(MUD, {1.0: 1.0}), GIVEN, 0.1) == []
    plain = replace(DOWN, names=("camera",))
    many = Curve(plain, {t: seen(-t) for t in (0.2, 0.4, 0.6, 0.8, 1.0)}, swept=True)
    assert _candidates(many, GIVEN, 0.1) == [0.6, 1.0]
    margins = {0.2: -0.1, 0.4: -1.0, 0.6: -0.5, 0.7: -0.4, 0.8: -0.3, 0.9: -0.2}
    assert _candidates(Curve(plain, {t: seen(m) for t, m in margins.items()}), GIVEN, 0.1) == [0.4, 0.8, 0.9]


def test_bisection_stops_at_a_fiftieth() -> None:
    asked: list[float] = []

    def examine(point: Any, most: int) -> Evidence:
        t = (4.0 - point["mud"]) / 4.0
        asked.append(t)
        return seen(0.6 - t)

    evaluator: Any = SimpleNamespace(examine=examine)
    found = curve(MUD, {0.5: 0.1, 0.75: -0.15})
    bisect(found, evaluator)
    assert asked == [0.625, 0.5625, 0.59375, 0.609375]
    assert found.bracket == (0.59375, 0.609375)
    undecided = Curve(MUD, {0.5: seen(0.1), 0.75: seen(-0.1, "open", 8)}, swept=True)
    noisy: Any = SimpleNamespace(examine=lambda point, most: seen(-0.1, "open", most))
    bisect(undecided, noisy)
    assert undecided.bracket == (0.5, 0.53125)


def test_directions_that_hold_alone_are_listed() -> None:
    harmless = [curve(MUD, {1.0: 1.0}), curve(LEFT, {1.0: 1.0})]
    failing = [curve(FLAT, GOOD), curve(STEEP, {0.25: -1.0}), curve(DOWN, {1.0: -1.0})]
    assert [*_inside([harmless[0], *failing, harmless[1]])] == [(MUD, 1.0), (FLAT, 0.45), (LEFT, 1.0)]


def test_containing_drift_is_farther_in_every_direction() -> None:
    one = combined(mud=2.0, slope=-0.5).point
    assert contains(SPACE, one, combined(mud=2.0).point)
    assert contains(SPACE, one, one)
    assert not contains(SPACE, one, combined(mud=1.9).point)
    assert not contains(SPACE, one, combined(slope=0.1).point)


def test_each_chain_test_has_its_own_risk() -> None:
    risks: list[tuple[str, float]] = []
    released: list[str] = []

    def confirm(point: Any, pool: str, risk: float, *_: Any, strict: bool, least: float | None) -> bool:
        assert strict
        assert least is None
        risks.append((pool, risk))
        return point["mud"] >= 2.0

    evaluator: Any = SimpleNamespace(
        space=SPACE, confirm=confirm, examine=lambda point, _: seen(-1.0), release=released.append
    )
    together = Together(0.06, [curve(MUD, GOOD)])
    chain = [combined(mud=value, slope=0.5).point for value in (3.0, 2.0, 1.0, 0.5)]
    assert together.confirm(chain, evaluator)
    assert [one.point["mud"] for one in together.found] == [3.0, 2.0]
    assert [point["mud"] for point in together.tested] == [3.0, 2.0, 1.0]
    assert risks == [("chain 0", pytest.approx(0.06 * _share(0)))] * 3
    assert released == ["chain 0"]
    assert not together.confirm([combined(mud=2.5, slope=0.75).point], evaluator)  # beyond a failure found
    assert not together.confirm([SPACE.nominal], evaluator)
    assert len(together.tested) == 3
    assert not together.confirm([combined(mud=1.0).point], evaluator)
    assert risks[-1] == ("chain 1", pytest.approx(0.06 * _share(1)))
    assert sum(_share(number) for number in range(1000)) <= 1.0


def test_ray_model_places_the_boundary_between_episodes() -> None:
    evidence = {
        0.25: Evidence("holds", 1.0, 40, 40, 0.0, 0.01),
        0.5: Evidence("holds", 1.0, 40, 40, 0.1, 0.01),
        0.75: Evidence("fails", -1.0, 40, 0, 0.9, 0.01),
    }
    model = Model(evidence, 0.5)
    held, failing = model.holding(20, 16), model.failing(20, 10)
    assert failing is not None
    assert 0.45 <= held < failing <= 0.75
    assert model._loss(0.625, 0.0, 16) == pytest.approx(0.5)
    assert model._loss(0.5, 2.0, 10) == pytest.approx(0.1 + 2 * 0.01 * sqrt(1 / 40 + 1 / 10))
    assert model._weights.sum() == pytest.approx(1.0)
    assert model._passing(0.1, 4, 4) > 0.99
    assert model._passing(1.0, 4, 1) < 0.1
    assert Model({0.5: Evidence("fails", -1.0, 40, 0, 9.0, 0.0)}, 0.5).holding(99, 16) < 0.5
    assert Model({1.0: Evidence("holds", 1.0, 99, 99, 0.0, 0.0)}, 0.5).failing(20, 0) is None


SIDE = Margin("mud", 1.0, 0.0, 0.3, 0.2)


@pytest.mark.parametrize(
    ("side", "expected"),
    [
        (SIDE, "0.2 to 0.3"),
        (replace(SIDE, fails_at=None), "beyond 0.3"),
        (replace(SIDE, holds_to=None), "not beyond 0.2"),
        (replace(SIDE, holds_to=None, fails_at=None), "no failure shown"),
        (Margin("camera='down'", 0.0, 1.0, None, 1.0), "fails"),
        (Margin("camera='down'", 0.0, 1.0, 1.0, None), "holds"),
        (Margin("camera='down'", 0.0, 1.0, None, None), "no failure shown"),
    ],
)
def test_each_kind_of_boundary_has_its_sentence(side: Margin, expected: str) -> None:
    assert boundary_words(side) == expected


def test_margins_follow_the_new_file() -> None:
    up, gone = replace(SIDE, end=2.0), Margin("camera='down'", 0.0, 1.0, None, None)
    before = Margins("t", "w", 0.9, 0.5, 0.9, (gone, SIDE))
    found = compared([before], [replace(before, sides=(up, SIDE))])
    assert [(row.name, row.change) for row in found] == [
        ("mud to 2", "new"),
        ("mud to 0", "no significant change"),
        ("camera='down'", "gone"),
    ]
    assert [row.title for row in found] == ["t[w]"] * 3
    assert found[0].cells == ("-", "0.2 to 0.3")
    assert found[2].cells == ("no failure shown", "-")
    assert Row("t", SIDE, None).name == "mud to 0"


@pytest.mark.parametrize(
    ("size", "left", "rows"),
    [(2, 5 * 32, 32), (2, 5 * 32 - 1, 0), (2, 5 * 64, 64), (3, 10**6, 256), (1, 10**6, 0)],
)
def test_sample_has_one_row_per_affordable_episode(size: int, left: int, rows: int) -> None:
    assert affordable(size, left) == rows


@given(st.floats(0, 1))
def test_share_becomes_a_number_or_an_option(share: float) -> None:
    assert _number(Choice(("a", "b", "c")), share) == min(int(share * 3), 2)
    number = _number(Span(-1.0, 3.0, 0.0), share)
    assert -1.0 <= number <= 3.0
    assert number == pytest.approx(-1.0 + 4.0 * share)


def test_halton_points_are_radical_inverses_in_prime_bases() -> None:
    assert _primes(6) == [2, 3, 5, 7, 11, 13]
    assert [_inverse(n, 2) for n in (1, 2, 3, 4)] == [0.5, 0.25, 0.75, 0.125]
    assert _inverse(5, 3) == pytest.approx(2 / 3 + 1 / 9)
    assert distance(SPACE, SPACE.nominal) == 0.0
