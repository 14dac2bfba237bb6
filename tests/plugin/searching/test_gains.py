"""The table of gains and its queries, on values written by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS, _hull, _spans, _steepest, _widened, holds
from pytest_tarl.searching.course import deviation
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.gentler import COARSE, FINE, another_way, gentler
from pytest_tarl.searching.plainness import Oddness, kind, named, oddness, of_nature, plainer, writing
from pytest_tarl.searching.race import Arm, Race, ahead_by, behind, paired
from pytest_tarl.searching.ranking import Ranking
from pytest_tarl.searching.screening import blocks, main_effects, worth_screening
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.units import Unit, whole_constants
from pytest_tarl.sensors import Sensor
from tarl_lint.model import Operand
from tests.plugin.searching.test_candidates import CHANGES, REGION, evidence
from tests.plugin.searching.test_search import operand

WET = Guard((Conjunct(Sensor("wet", topic="/wet", field="data"), 1, 1),))


def constant(line: int, code: str, value: float | None = 2.0) -> Operand:
    """Return a use of a named constant; each statement is a separate site."""
    made = operand(line, code, 2.0)
    return replace(
        made,
        value=value,
        site=replace(made.site, text=f"x{line} = {code}"),
        definition=operand(line + 40, code, 2.0).span,
    )


A, B, C = (Unit((constant(n, name),)) for n, name in enumerate(("A", "B", "C"), start=1))


def gains(slack: float = 0.5) -> Gains:
    """A gains 4 with 2.2 and 5 with 5.0; B loses with either factor but gains 1 under WET; C has no effect."""
    found = Gains(slack)
    for unit, guard, factor, gain in (
        (A, ALWAYS, 2.2, 4.0),
        (A, ALWAYS, 0.4, -3.0),
        (A, ALWAYS, 5.0, 5.0),
        (B, ALWAYS, 2.2, -1.0),
        (B, ALWAYS, 0.4, -0.6),
        (B, WET, 0.4, 1.0),
        (C, ALWAYS, 2.2, 0.0),
        (C, ALWAYS, 0.4, 0.0),
    ):
        found.enter((unit, guard), factor, gain)
    return found


def test_unchanged_constant_has_gain_zero() -> None:
    found = gains()
    assert found.of(A, ALWAYS) == {1.0: 0.0, 2.2: 4.0, 0.4: -3.0, 5.0: 5.0}
    assert found.of(A, WET) == {}
    assert (found.most((A, ALWAYS)), found.most((B, ALWAYS)), found.most((A, WET))) == (5.0, 0.0, 0.0)
    proposed = Gains(0.5, proposed=True)
    proposed.enter((A, ALWAYS), 1.0, -2.0)
    assert proposed.of(A, ALWAYS) == {1.0: -2.0}


def test_gains_are_listed_separately_for_each_condition() -> None:
    found = gains()
    assert [*found.under(WET)] == [B]
    assert [*found.under(ALWAYS)] == [A, B, C]
    assert [key for key, _ in found.items()] == [(A, ALWAYS), (B, ALWAYS), (B, WET), (C, ALWAYS)]


@pytest.mark.parametrize(("slack", "expected"), [(4.9, True), (5.0, False)])
def test_gain_must_exceed_the_slack(slack: float, expected: bool) -> None:
    assert gains(slack).anything() is expected


def test_ineffective_proposal_changed_no_episode() -> None:
    found = Gains(0.5, proposed=True)
    found.enter((A, ALWAYS), 1.0, 0.0)
    found.enter((A, ALWAYS), 2.2, 3.0)
    found.enter((B, ALWAYS), 1.0, 0.0, moved=True)
    found.enter((C, ALWAYS), 2.2, 0.0)
    assert [found.idle(unit) for unit in (A, B, C)] == [True, False, False]
    plain = Gains(0.5)
    plain.enter((A, ALWAYS), 1.0, 0.0)
    assert not plain.idle(A)


def test_effective_constant_changed_some_episode() -> None:
    found = gains()
    assert [found.moves(unit) for unit in (A, B, C)] == [True, True, False]
    assert found.moving([C, B, A]) == [B, A]
    one_way = Gains(0.5)
    one_way.enter((C, ALWAYS), 2.2, 0.0)
    assert one_way.moving([C, A]) == [C, A]  # moved in one direction only, or never tried
    one_way.enter((C, WET), 0.4, 0.0)
    assert one_way.moving([C, A]) == [A]  # moved in both directions, under any condition


def test_constants_that_always_lose_are_found() -> None:
    found = gains()
    assert found.lost_both_ways(ALWAYS, [A, B, C], (2.2, 0.4)) == [B]
    assert found.lost_both_ways(ALWAYS, [A, B], (0.4,)) == [A, B]
    assert found.lost_both_ways(ALWAYS, [A, B], (2.2, 0.4, 5.0)) == []
    least = Gains(0.5)
    for unit, factor, gain, moved in (
        (A, 2.2, -0.5, True),  # a gain not above the slack
        (A, 0.4, -9.0, True),
        (B, 2.2, 0.0, True),  # a mission that already earned the least possible reward
        (B, 0.4, -9.0, True),
        (C, 2.2, 0.0, False),
        (C, 0.4, -9.0, True),
    ):
        least.enter((unit, ALWAYS), factor, gain, moved)
    assert least.lost_both_ways(ALWAYS, [A, B, C], (2.2, 0.4)) == [B]


def test_constants_are_sorted_by_gain() -> None:
    found = gains()
    found.enter((B, ALWAYS), 5.0, 6.0)
    assert found.leading(5.0, ALWAYS, [A, B, C], 5.0) == [B, A]
    assert found.leading(5.0, ALWAYS, [A, B, C], 5.1) == [B]
    assert found.leading(2.2, ALWAYS, [A, B, C], -1.0) == [A, B]
    assert found.leading(2.2, ALWAYS, [A, B, C], -1.0, inert=True) == [A, C, B]


def test_best_factor_is_found_per_condition() -> None:
    found = gains()
    assert found.best_under([ALWAYS, WET]) == [(A, 5.0), (B, 0.4)]
    assert found.best_under([ALWAYS]) == [(A, 5.0)]
    assert found.best_under([]) == []


def test_each_statement_contributes_only_its_best_change() -> None:
    found = gains()
    twin = Unit((replace(constant(1, "TWIN"), site=A.operands[0].site),))
    found.enter((twin, ALWAYS), 2.2, 7.0)
    assert found.leaders(ALWAYS) == [(7.0, (twin, 2.2))]
    assert found.leaders(WET) == [(1.0, (B, 0.4))]


LITERAL, ZERO = operand(9, "2.5", 2.5), operand(9, "0.0", 0.0)
GRAVITY = constant(8, "GRAVITY", 9.81)


@pytest.mark.parametrize(
    ("one", "tried"),
    [
        (constant(7, "SPEED"), Oddness.NAMED),
        (replace(constant(7, "speed"), definition=None), Oddness.VARIABLE),
        (replace(constant(7, "speed"), definition=None, setting="speed"), Oddness.NAMED),
        (constant(7, "START", 0.0), Oddness.INNER),
        (LITERAL, Oddness.INNER),
        (ZERO, Oddness.OFFSET),
        (GRAVITY, Oddness.NATURE),
        (operand(9, "9.81", 9.81), Oddness.NATURE),
    ],
)
def test_constant_kinds_have_a_search_order(one: Operand, tried: Oddness) -> None:
    assert writing(one) is tried


def test_a_zero_is_an_offset_regardless_of_its_name() -> None:
    assert kind(Unit((constant(7, "START", 0.0),))) is Oddness.OFFSET
    assert kind(Unit((replace(operand(7, "False", 0.0), value=False),))) is Oddness.INNER
    assert named([A, Unit((LITERAL,)), Unit((GRAVITY,)), B]) == [A, B]
    assert oddness([]) is Oddness.NAMED


@pytest.mark.parametrize(
    ("value", "expected"),
    [(9.81, True), (-9.81, True), (math.pi, True), (3.14, True), (6.28, True), (3.15, False), (9.5, False),
     (None, False), (True, False)],
)  # fmt: skip
def test_gravity_and_pi_are_recognised_by_name_and_value(value: float | None, expected: bool) -> None:
    assert of_nature(constant(7, "G", value)) is expected


def test_constant_of_nature_stays_one_with_another_sign() -> None:
    assert oddness([Mutation(GRAVITY, -1.0)]) is Oddness.NATURE


def test_readable_changes_come_first() -> None:
    literal = Unit((LITERAL,))
    found = gains()
    assert plainer(Oddness.VARIABLE, found.under(ALWAYS), [C, B, A, literal], 4.0) == [A, literal]
    others = [Unit((constant(n, f"N{n}"),)) for n in range(20, 24)]
    assert plainer(Oddness.INNER, found.under(ALWAYS), [*others, A], 5.0) == [A, *others[:2]]
    assert plainer(Oddness.INNER, found.under(ALWAYS), [*others, A], 5.1) == others[:2]
    assert plainer(Oddness.NAMED, found.under(ALWAYS), [A, *others], 0.0) == []
    mixed = [literal, *others]
    assert plainer(Oddness.OFFSET, {}, mixed, 0.0) == [*others, literal]


def test_named_constant_of_the_statement_is_tried_first() -> None:
    others = [Unit((constant(n, f"N{n}"),)) for n in range(20, 24)]
    beside = Unit((replace(LITERAL, site=others[3].operands[0].site),))
    assert plainer(Oddness.INNER, {}, others, 5.0, beside) == [others[3], others[0]]
    assert plainer(Oddness.OFFSET, {}, [*others, beside], 5.0, beside) == [others[3], *others[:3], beside]


def test_named_constant_below_is_tried_before_one_above() -> None:
    """A value that reads too low is scaled, or the threshold with which it is compared below is lowered."""
    above, beside, threshold, further = (Unit((constant(n, f"N{n}"),)) for n in (50, 51, 52, 60))
    ranked = plainer(Oddness.INNER, {}, [above, further, threshold], 5.0, beside)
    assert ranked == [threshold, further]


GOAL = Goal(tuple(Pair(seed, 0.0, 10) for seed in range(3)), 9.0, 9.0, 0.0, steps=10.0)


def changed(unit: Unit, factor: float) -> Candidate:
    return Candidate(unit.mutations(mutations, factor), ALWAYS)


@pytest.mark.parametrize(
    ("steps", "expected"), [(13, False), (14, True), (8, False), (7, True), (None, False)]
)
def test_candidate_with_much_longer_missions_is_unusual(steps: int | None, expected: bool) -> None:
    trials = Trials(lambda _, seed: Outcome(10.0, True, steps=steps), 9)
    one = changed(A, 2.2)
    assert not another_way(one, trials, GOAL)  # not run yet
    trials(one, 0)
    assert another_way(one, trials, GOAL) is expected
    assert not another_way(one, trials, replace(GOAL, steps=None))
    assert another_way(changed(Unit((GRAVITY,)), 2.2), trials, GOAL)


def test_gaining_statement_gets_finer_steps() -> None:
    beside = Unit((replace(constant(30, "BESIDE"), site=A.operands[0].site),))
    found = gains()
    assert gentler(A, [A, C, B, Unit((LITERAL,)), beside], found, ALWAYS, 5.0) == [
        (beside, FINE),
        (B, COARSE),
    ]
    assert gentler(A, [beside], found, ALWAYS, 5.1) == [(beside, COARSE)]


def test_screening_uses_blocks_of_twenty() -> None:
    many = [Unit((operand(n, "1.0", 1.0),)) for n in range(41)]
    assert [len(block) for block in blocks(many)] == [20, 20, 1]
    assert [len(block) for block in blocks(many[:40])] == [40]
    assert blocks([]) == []
    assert (worth_screening(many), worth_screening(many[:40])) == (True, False)


def test_main_effects_equal_a_ridge_regression_computed_by_hand() -> None:
    design, gained = np.array([[1.0, 0.0], [1.0, 1.0]]), np.array([2.0, 5.0])
    # (DᵀD + I) e = Dᵀg: [[3, 1], [1, 2]] e = [7, 5]
    assert main_effects(design, gained) == pytest.approx([9 / 5, 8 / 5])


def test_the_deviation_compares_cumulative_rewards_step_by_step() -> None:
    assert deviation((2.0, 0.0), (1.0, 1.0)) == pytest.approx((1.0 + 0.0) / 2 / 2)
    assert deviation((1.0,), (1.0, -3.0)) == pytest.approx((0.0 + 3.0) / 2 / 2)
    assert deviation((), ()) == 0.0


def test_uses_of_a_named_constant_change_together() -> None:
    first, other = constant(3, "A"), replace(constant(9, "A"), definition=constant(3, "A").definition)
    elsewhere = replace(other, span=replace(other.span, path="other.py"))
    literal = operand(5, "2.0", 2.0)
    apart = [Unit((one,)) for one in (first, literal, other, elsewhere, literal)]
    found = [unit.operands for unit in whole_constants(apart)]
    assert found == [(first, other), (literal,), (elsewhere,), (literal,)]
    truth = [Unit((replace(one, value=True),)) for one in (first, other)]
    assert whole_constants(truth) == tuple(truth)


def race(of: dict[tuple[Unit, float], dict[int, float]]) -> Race:
    found = Race(mutations, Trials(lambda *_: Outcome(0.0, True), 9), GOAL)
    found.gains = {Arm(unit, factor, ALWAYS): seen for (unit, factor), seen in of.items()}
    return found


def test_changes_are_ranked_by_gain_and_ties_are_found() -> None:
    found = race(
        {
            (A, 2.2): {0: 1.0, 1: 1.1, 2: 0.9},
            (B, 2.2): {0: 5.0, 1: 5.2, 2: 4.9},
            (C, 2.2): {0: 4.0, 1: 6.2, 2: 4.5},
        }
    )
    one, two, three = found.gains
    assert found.ranked([one, two, three, two]) == [two, three, one]
    assert found.abreast([one, two, three]) == [two, three]
    assert found.gain(three) == pytest.approx(4.9)
    assert found.gain(Arm(A, 9.0, ALWAYS)) == 0.0


def test_new_factor_lies_between_neighbours() -> None:
    seen = {0: 1.0}
    found = race({(A, 4.0): seen, (A, 1.0): seen, (A, -2.0): seen, (B, 2.0): seen, (A, 1.05): seen})
    assert [arm.factor for arm in found.around(Arm(A, 4.0, ALWAYS))] == [round(math.sqrt(4.2), 3)]
    assert found.around(Arm(A, 1.0, ALWAYS)) == []  # its neighbour is nearer than the finest ratio
    assert [arm.factor for arm in found.around(Arm(A, 1.05, ALWAYS))] == [round(math.sqrt(4.2), 3)]
    assert found.around(Arm(A, 3.0, ALWAYS)) == []
    assert found.around(Arm(A, 4.0, WET)) == []


@given(
    st.dictionaries(st.integers(0, 5), st.floats(-9, 9)), st.dictionaries(st.integers(0, 5), st.floats(-9, 9))
)
def test_worse_change_needs_three_common_seeds(one: dict[int, float], other: dict[int, float]) -> None:
    differences = paired(one, other)
    assert differences == [one[seed] - other[seed] for seed in one if seed in other]
    if len(differences) < 3:
        assert not behind(other, one)
    else:
        assert behind(other, one) == (ahead_by(differences)[0] > 0)
        assert not (behind(other, one) and behind(one, other))


def test_confidence_interval_of_a_lead_is_students_t() -> None:
    low, high = ahead_by([1.0, 2.0, 3.0])  # 2 ± 4.3027·1/√3
    assert (low, high) == pytest.approx((2 - 4.3027 / math.sqrt(3), 2 + 4.3027 / math.sqrt(3)), abs=2e-3)


def test_the_certainty_of_a_ranking_counts_sites_that_gain() -> None:
    ranking = Ranking([A.operands[0]], mutations, ALWAYS, Trials(lambda *_: Outcome(0.0, True), 9), GOAL)
    ranking.race = race(
        {
            (A, 2.2): {0: 3.0, 1: 3.1, 2: 2.9},
            (A, 5.0): {0: 9.0},  # a gain on one seed may be chance
            (B, 2.2): {0: 5.0, 1: 5.2, 2: 4.9},
            (C, 2.2): {0: 0.5, 1: 0.7},
        }
    )
    ranking.slack = 0.6
    sites = [str(unit.operands[0].site) for unit in (A, B, C)]
    first = ranking.certainty(sites[1])
    assert first is not None
    assert (first.gaining, first.level, first.ahead, first.seeds) == (2, 0, 0, 3)
    assert first.by is not None
    assert 0 < first.by[0] < 2.0 < first.by[1]
    second = ranking.certainty(sites[0])
    assert second is not None
    assert (second.level, second.ahead) == (0, 1)
    third = ranking.certainty(sites[2])
    assert third is not None
    assert (third.level, third.ahead, third.by, third.seeds) == (2, 0, None, 2)


ANGLE = Sensor("heading", topic="/h", field="data", low=0, high=8, bins=8, angle=True)
LINE = Sensor("x", topic="/x", field="data", low=0, high=8, bins=8)


@pytest.mark.parametrize(
    ("cells", "line", "arc"),
    [((2, 3, 5), (2, 5), (2, 5)), ((0, 1, 7), (0, 7), (7, 9)), ((4,), (4, 4), (4, 4)), ((), None, None)],
)
def test_angle_interval_is_the_shortest_arc(
    cells: tuple[int, ...], line: tuple[int, int] | None, arc: tuple[int, int] | None
) -> None:
    some = [(one,) for one in cells]
    assert _hull(some, 0, LINE) == line
    assert _hull(some, 0, ANGLE) == arc


def test_full_interval_is_unrestricted() -> None:
    assert _spans((2, 4), {2, 4}, LINE)
    assert not _spans((2, 4), {2, 5}, LINE)
    assert _spans((7, 9), {0, 1, 7}, ANGLE)
    assert not _spans((7, 9), {2, 7}, ANGLE)
    assert not _spans((7, 9), {0, 7}, LINE)


def test_condition_is_proposed_for_the_largest_change_per_visit() -> None:
    assert _steepest(evidence(REGION, changes=dict(CHANGES)), 0) == (4, 6)
    assert _steepest(evidence(REGION, changes=dict(CHANGES)), 1) == (1, 1)


def widened(sensor: Sensor, low: float, high: float) -> tuple[float, float]:
    (one,) = _widened(Guard((Conjunct(sensor, low, high),))).conjuncts
    return one.low, one.high


def test_intervals_are_widened_by_two_bins() -> None:
    assert widened(LINE, 3.0, 5.0) == (1.0, 7.0)
    assert widened(LINE, 2.0, 6.0) == (0.0, 8.0)
    assert widened(LINE, 1.0, 7.0) == (-math.inf, math.inf)
    assert widened(ANGLE, 3.0, 5.0) == (1.0, 7.0)
    assert widened(ANGLE, 7.0, 1.0) == (5.0, 3.0)
    assert widened(ANGLE, 0.0, 4.0) == (-math.inf, math.inf)
    assert widened(Sensor("wet", topic="/wet", field="data"), 1.0, 1.0) == (1.0, 1.0)


@pytest.mark.parametrize(
    ("sensor", "low", "high", "expected"),
    [
        (LINE, 3.0, 5.0, [3, 4]),
        (LINE, 3.0 + 1e-10, 5.0 - 1e-10, [3, 4]),
        (LINE, 3.0 + 1e-6, 5.0 - 1e-6, []),
        (LINE, -math.inf, 1.0, [0]),
        (ANGLE, 7.0, 1.0, [0, 7]),
        (ANGLE, 7.0 + 1e-10, 1.0 - 1e-10, [0, 7]),
    ],
)
def test_condition_holds_in_its_bins(sensor: Sensor, low: float, high: float, expected: list[int]) -> None:
    guard = Guard((Conjunct(sensor, low, high),))
    assert [index for index in range(8) if holds(guard, (index,), [sensor])] == expected


def test_clear_loss_means_that_each_factor_lost() -> None:
    found = gains()
    assert found.clearly_lost(ALWAYS, [A, B, C], (2.2, 0.4)) == [B]
    assert found.clearly_lost(ALWAYS, [A, B, C], (0.4,)) == [A, B]
    assert found.clearly_lost(ALWAYS, [B], (2.2, 5.0)) == []  # not tried


def many(moved: int) -> Gains:
    """Return the gains of eight constants under WET; some of them changed an episode."""
    found = Gains(0.5)
    for line in range(8):
        found.enter((Unit((constant(10 + line, f"C{line}"),)), WET), 2.2, 0.0, line < moved)
    return found


def test_idle_condition_has_changes_without_effect() -> None:
    assert many(2).idle_guard(WET)
    assert not many(3).idle_guard(WET)
    assert not gains().idle_guard(WET)  # too few constants
    without = Gains(0.5)
    for line in range(8):
        without.enter((Unit((constant(10 + line, f"C{line}"),)), ALWAYS), 2.2, 0.0, False)
    assert not without.idle_guard(ALWAYS)  # it has no condition


def test_tries_under_an_idle_condition_prove_nothing() -> None:
    found = many(0)
    units = [unit for (unit, _), _ in found.items()]
    for unit in units:
        found.enter((unit, WET), 0.4, 0.0, False)
    assert found.moving(units) == units
    for factor in (2.2, 0.4):
        found.enter((units[0], ALWAYS), factor, 0.0, False)
    assert found.moving(units) == units[1:]


def test_gain_without_progress_is_not_counted() -> None:
    found = Gains(0.5)
    found.enter((A, ALWAYS), 0.4, 2.0, True, hollow=True)
    assert found.most((A, ALWAYS)) == 2.0
    assert found.best() == 0.0
    assert not found.anything()
    found.enter((A, ALWAYS), 0.4, 2.0, True)  # a further seed showed progress
    assert found.best() == 2.0


@pytest.mark.parametrize(
    ("its", "alike"),
    [
        ({2.2: 4.0, 0.4: -3.0, 5.0: 5.0}, True),
        ({2.2: 4.0, 0.4: -3.0, 5.0: 5.0, 1.5: 0.2}, True),  # a factor that only the other one was tried with
        ({2.2: 4.0, 0.4: -3.0}, False),  # too few
        ({2.2: 4.0, 0.4: -3.0, 5.0: 4.0}, False),
        ({}, False),
    ],
)
def test_constants_with_equal_rewards_act_alike(its: dict[float, float], alike: bool) -> None:
    found, other = gains(), Unit((constant(9, "D"),))
    for factor, gain in its.items():
        found.enter((other, ALWAYS), factor, gain)
    assert found.acting_alike(A, ALWAYS, [A, B, C, other]) == ([other] if alike else [])
