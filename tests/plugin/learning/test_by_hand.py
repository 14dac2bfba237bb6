"""Comparisons, bets and summaries of episodes on a few values, worked out by hand."""

from __future__ import annotations

from dataclasses import replace
from math import exp, inf, log, log1p, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.errors import RecordingError
from pytest_tarl.formulas.judging import Judged
from pytest_tarl.learning import betting, footprint, reward_parts
from pytest_tarl.learning.betting import Bet, bet
from pytest_tarl.learning.binning import learned_edges, quantiles
from pytest_tarl.learning.binomial import BinomialTail, log_choose, probabilities
from pytest_tarl.learning.drift import Difference, corrected, judged, paper_region, tolerated
from pytest_tarl.learning.guarantees import stated, varies
from pytest_tarl.learning.judgements import judgements, rows, stacked, together, with_worlds, world
from pytest_tarl.learning.localize import culprits, prior
from pytest_tarl.learning.marginal import apart, groups, left_out, lent, projected
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.packing import ROUNDING
from pytest_tarl.learning.residual_sums import Evidence, slabs
from pytest_tarl.learning.residuals import beyond
from pytest_tarl.learning.reward_parts import lost, means
from pytest_tarl.learning.roots import root
from pytest_tarl.learning.sequential import Look, certain, concluded, planned
from pytest_tarl.learning.shifts import shifts
from pytest_tarl.learning.tables import END, Chain, Edges, ListSample, Sample, Visits
from pytest_tarl.model import FormulaRow, LossInterval, OperandEffect, Region, SitePlace, Slice, Verdict
from pytest_tarl.sensors import Cell, Sensor

VERDICT = Verdict("no difference", 0.5, 0.5, 0.0, 0.5, 0.1)


def episodes(*visited: list[Cell], reward: float = 1.0, cells: tuple[Cell, ...] = ()) -> Sample:
    """Return episodes that visit cells in this order and earn the reward at each step."""
    table = tuple(sorted({*cells, *(cell for one in visited for cell in one)}))
    number = {cell: n for n, cell in enumerate(table)}
    steps = [(n, number[cell]) for n, one in enumerate(visited) for cell in one]
    count = len(steps)
    episode, cell = (np.array([step[at] for step in steps], np.int64) for at in (0, 1))
    chain = Chain(
        episode,
        cell,
        np.full(count, END),
        np.ones(count, np.int64),
        np.full(count, reward),
        np.stack([np.full(count, 2.0), -cell.astype(float)], axis=1),
    )
    lengths = np.array([len(one) for one in visited])
    return Sample(
        table,
        tuple(range(len(visited))),
        np.full(len(visited), True),
        lengths * reward,
        lengths,
        ("a", "b"),
        chain,
        (),
    )


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"p_loss": 0.04, "loss": 0.2}, "degraded"),
        ({"p_loss": 0.04, "loss": 0.1}, "no difference"),
        ({"p_loss": 0.05, "loss": 0.2}, "no difference"),
        ({"p_loss": 0.04, "loss": 0.1, "p_drift": 0.04}, "drifted"),
        ({"p_drift": 0.05}, "no difference"),
        ({"p_loss": 0.04, "loss": 0.2, "p_drift": 0.04}, "degraded"),
        ({"p_failures": 0.04, "success": (1.0, 0.94)}, "degraded"),
        ({"p_failures": 0.05, "success": (1.0, 0.94)}, "no difference"),
        ({"p_failures": 0.04, "success": (1.0, 0.95)}, "no difference"),
        ({"p_failures": 0.04, "success": (0.5, 0.9), "p_drift": 0.04}, "drifted"),
    ],
)
def test_verdict_follows_from_p_values_and_tolerances(change: dict[str, float], expected: str) -> None:
    assert judged(replace(VERDICT, **change), 0.05).result == expected  # type: ignore[arg-type]


def test_a_verdict_states_whether_reward_or_successes_decreased() -> None:
    lost = {"p_loss": 0.01, "loss": 0.2}
    failed = {"p_failures": 0.01, "success": (1.0, 0.5)}
    found = [judged(replace(VERDICT, **one), 0.05) for one in (lost, failed, lost | failed, {})]  # type: ignore[arg-type]
    assert [one.because for one in found] == [("reward",), ("success",), ("reward", "success"), ()]
    assert [one.failures_only for one in found] == [False, True, False, False]


def test_loss_and_failures_share_their_correction() -> None:
    one = replace(VERDICT, p_loss=0.03, p_failures=0.01, success=(1.0, 0.5), loss=0.2)
    two = replace(VERDICT, p_loss=0.02, p_failures=0.9, loss=0.2)
    first, second = corrected([one, two], 0.05)
    assert (first.p_failures, first.because) == (0.02, ("success",))
    assert first.p_loss == pytest.approx(0.06)
    assert (second.p_loss, second.because) == (0.02, ("reward",))
    assert second.p_failures == pytest.approx(0.9)


def test_verdicts_of_several_comparisons_are_corrected_separately() -> None:
    one = replace(VERDICT, p_loss=0.02, loss=0.2, p_drift=0.03)
    two = replace(VERDICT, p_loss=0.3, loss=0.2, p_drift=0.02)
    first, second = corrected([one, two], 0.05)
    assert (first.p_loss, first.p_drift, first.result) == (0.04, 0.04, "degraded")
    assert (second.p_loss, second.p_drift, second.result) == (0.3, 0.04, "drifted")


def test_tolerated_loss_is_five_percent_or_the_stated_tolerance() -> None:
    sample = episodes([(0,)] * 2, [(0,)] * 4, reward=-2.0)  # totals -4 and -8
    assert tolerated(sample, None) == pytest.approx(0.3)
    assert tolerated(sample, 0.2) == pytest.approx(0.3)
    assert tolerated(sample, 0.4) == 0.4


def test_paper_region_has_at_least_half_of_the_largest_difference() -> None:
    offline = np.array([[1.0, 1.0], [1.0, nan], [0.0, 0.0], [5.0, 5.0]])
    online = np.array([[0.0, 0.0], [0.0, 1.0], [0.0, 0.0], [nan, nan]])
    assert paper_region(offline, online).tolist() == [0, 1]
    assert paper_region(offline, offline).tolist() == []
    assert paper_region(np.empty((0, 2)), np.empty((0, 2))).tolist() == []


def test_each_sensor_bin_is_a_slab_of_cells() -> None:
    assert [slab.tolist() for slab in slabs([(0, 5), (0, 6), (1, 5)])] == [
        [0, 1],
        [2],
        [0, 2],
        [1],
        [0, 1, 2],
    ]
    assert [slab.tolist() for slab in slabs([(0,), (1,)])] == [[0, 1]]


def test_sums_of_residuals_below_the_rounding_error_become_zero() -> None:
    part = np.array([[1.0, -1.0, 3.0], [0.25, 0.0, 0.0]])
    error = np.full((2, 3), 0.25)
    cells = slabs([(0,), (1,), (2,)])
    one = Evidence(part, part, part, error, 0.0 * error, cells, part[:, :1])
    move, reward, novel, wide_move, wide_reward, totals = one.columns()
    assert move is part
    assert wide_move.tolist() == [[3.0], [0.0]]
    assert wide_reward.tolist() == [[3.0], [0.25]]
    assert (reward is part, novel is part, totals.shape) == (True, True, (2, 1))
    both = replace(one, slabs=slabs([(0, 5), (0, 6), (1, 5)]))
    assert both.covered(np.array([False, True, False, True, False])).tolist() == [False, True, True]
    assert beyond(np.array([-1.0, 1.0, 0.5]), np.array([0.5, 1.0, 0.5])).tolist() == [-1.0, 0.0, 0.0]


def test_each_difference_multiplies_the_wealth_of_a_bet() -> None:
    one = Bet(1.0, -2.0, (0.5,))
    assert one.wealth([1.0, 0.0]) == pytest.approx(log1p(1.0) + log1p(0.5))
    assert one.wealth([-9.0]) == pytest.approx(log1p(-0.5))  # clipped to -2
    assert one.wealth([]) == 0.0
    assert Bet(1.0, -3.0, (0.5,)).wealth([-3.0, 9.0]) == -inf
    two = Bet(1.0, -2.0, (0.5, 0.25))
    assert two.wealth([1.0]) == pytest.approx(log(0.9 * 2.0 + 0.1 * 1.5))
    assert Bet(1.0, -3.0, (0.5, 0.25)).wealth([-3.0]) == pytest.approx(log(0.1 * 0.5))


def test_stake_of_a_bet_grows_with_the_gap() -> None:
    found = bet(1.0, -3.0, [0.5, -0.5])
    wanted = 1.0 / (1.5 * 0.5 + 1.0)  # a mean of 0: the gap is the margin; the variance is 0.5
    assert found.stakes == pytest.approx((min(wanted, 0.95 / 2.0), min(wanted, 0.5 / 2.0)))
    assert bet(1.0, -1.0, [0.5, -0.5]).stakes == pytest.approx((wanted,))
    assert bet(1.0, -1.0, [-9.0, -9.0]).stakes == pytest.approx(
        (1.0 / 0.25,)
    )  # at least a quarter of the margin
    assert bet(1.0, -1.0, [0.5]).stakes == pytest.approx((1.0 / 1.5,))
    assert betting._bounded(5.0, 1.0, -1.0, 0.5) == 5.0


def test_hopeless_betting_test_stops() -> None:
    one = Bet(1.0, -2.0, (0.5,))
    even = [0.5, -0.5] * 10
    best = 1.0  # the bound of the mean at 0.5 % lies well below it
    assert not one.hopeless(even, 100, 0.05)
    assert one.hopeless(even, 0, exp(-one.wealth(even) - 0.1))
    assert not one.hopeless(even, 0, exp(-one.wealth(even) + 0.1))
    assert one.hopeless([-1.9, -2.0, -1.8] * 4, 1000, 0.05)
    growing = log1p(0.5 * (best + 1.0))
    assert one.hopeless(even, 1, exp(-one.wealth(even) - growing))


def test_edges_are_quantiles_without_repetitions() -> None:
    assert quantiles("x", [0.0, 1.0, 2.0, 3.0, 4.0], 4) == (0.0, 1.0, 2.0, 3.0, 4.0)
    assert quantiles("x", [0.0, 0.0, 0.0, 8.0, nan, inf], 2) == (0.0, 8.0)
    assert quantiles("x", [0.0, 1.0, 0.123456789], 2) == (0.0, 0.1235, 1.0)
    assert quantiles("x", [0.0, 1000.0, 123.456789], 2) == (0.0, 123.5, 1000.0)
    with pytest.raises(RecordingError, match="read 3 all the time"):
        quantiles("x", [3.0, 3.0], 2)
    with pytest.raises(RecordingError, match="read nothing in"):
        quantiles("x", [nan], 2)


def test_only_sensors_with_bins_to_learn_get_edges() -> None:
    learned = Sensor("x", topic="/x", field="data", bins=2)
    fixed = Sensor("y", topic="/y", field="data", low=0, high=1, bins=2)
    wanted = [one for one in (learned, fixed) if one.to_learn]
    assert learned_edges([learned, fixed], {"x": [0.0, 1.0, 2.0]}) == {
        one.name: (0.0, 1.0, 2.0) for one in wanted
    }


def test_binomial_coefficients_probabilities_and_tails_equal_known_values() -> None:
    assert np.exp(log_choose(4)) == pytest.approx([1, 4, 6, 4, 1])
    assert probabilities(2, 0.25) == pytest.approx([0.5625, 0.375, 0.0625])
    assert BinomialTail(1, 2)(0.25) == pytest.approx(0.9375)
    assert [BinomialTail(1, 2)(p) for p in (0.0, 1.0)] == [1.0, 0.0]
    assert [BinomialTail(2, 2)(p) for p in (0.0, 1.0)] == [1.0, 1.0]
    assert [BinomialTail(-1, 2)(p) for p in (0.0, 0.5, 1.0)] == [0.0, 0.0, 0.0]


@given(st.floats(0.01, 0.99))
def test_bisection_finds_the_largest_valid_value(edge: float) -> None:
    assert root(lambda value: value <= edge, 0.0, 1.0) == pytest.approx(edge, abs=1e-12)
    assert root(lambda _: False, 0.0, 1.0) == 0.0
    coarse = root(lambda value: value <= edge, 0.0, 1.0, 3)
    assert coarse == int(edge * 8) / 8


def test_spent_risk_grows_quadratically() -> None:
    assert planned(40, 3) == (Look(10, 1 / 16), Look(20, 3 / 16), Look(40, 3 / 4))
    assert planned(39, 3) == (Look(19, (19 / 39) ** 2), Look(39, 1 - (19 / 39) ** 2))
    assert planned(5, 3) == (Look(5, 1.0),)


def difference(**changes: Any) -> Difference:
    return Difference(replace(VERDICT, **changes), Region(((1,),)), {})


def test_p_values_and_confidence_are_adjusted_for_several_checks() -> None:
    interval = LossInterval(0.1, 0.9, 0.98)
    seen = [
        (Look(10, 0.25), difference(p_loss=0.01, p_drift=0.2, p_failures=0.02)),
        (Look(20, 0.75), difference(p_loss=0.045, p_drift=0.9, loss=0.5, interval=interval)),
    ]
    found = concluded(seen, 0.05)
    assert (found.verdict.p_loss, found.verdict.p_drift) == (pytest.approx(0.04), pytest.approx(0.8))
    assert found.verdict.p_failures == pytest.approx(0.08)
    assert found.verdict.interval is not None
    assert (found.verdict.interval.low, found.verdict.interval.confidence) == (0.1, 0.9)
    assert (found.verdict.result, found.region) == ("degraded", Region(((1,),)))
    quiet = concluded([(Look(20, 0.5), difference(p_loss=0.9))], 0.05)
    assert (quiet.verdict.p_loss, quiet.region, quiet.verdict.interval) == (1.0, Region(), None)


@pytest.mark.parametrize(
    ("result", "region", "expected"),
    [
        ("degraded", Region(((1,),)), True),
        ("degraded", Region((), ((1,),)), True),
        ("degraded", Region(left=((1,),)), False),
        ("drifted", Region(((1,),)), False),
    ],
)
def test_check_ends_a_comparison_only_with_loss_and_region(
    result: Any, region: Region, expected: bool
) -> None:
    assert certain(Difference(replace(VERDICT, result=result), region, {})) is expected


def test_one_different_column_makes_episodes_vary() -> None:
    same = episodes([(0,), (1,)], [(0,), (1,)])
    assert not varies(same)
    assert not varies(episodes([(0,), (1,)]))
    assert varies(episodes([(0,), (1,)], [(1,), (0,)]))
    assert varies(episodes([(0,)], [(0,), (0,)]))
    assert varies(replace(same, total=np.array([1.0, 2.0])))
    assert varies(replace(same, steps=np.array([1, 2])))
    assert varies(replace(same, passed=np.array([True, False])))
    chain = replace(same.chain, reward=np.array([1.0, 0.0, 0.0, 1.0]))
    assert varies(replace(same, chain=chain))
    assert varies(replace(same, chain=replace(same.chain, count=np.array([1, 1, 1, 2]))))


def test_a_recording_states_bounds_on_success_mean_and_quantile() -> None:
    found = stated([True] * 59 + [False], [1.0, 3.0] * 30)
    assert (found.episodes, found.passed, found.average, found.needed) == (60, 59, 2.0, 59)
    assert found.success.confidence == 0.95
    assert found.quantile == 1.0
    assert (found.share, found.varied, found.declared) == (0.05, True, None)
    early = stated([True] * 60, [1.0] * 60, anytime=True, confidence=0.9)
    assert (early.needed, early.quantile, early.success.confidence) == (0, None, 0.9)


GOOD, BAD, UNKNOWN = Judged("g", 0.5), Judged("g", -0.25, 3.5), Judged("g", nan)


def test_formula_counts_only_judged_episodes() -> None:
    several = stacked([[GOOD], [BAD], [UNKNOWN], [], [Judged("g", -0.75, 2.5), Judged("a", 1.0)]])
    assert several is not None
    assert several.formulas == ("a", "g")
    found = world(several, "g")
    assert found is not None
    assert (found.robustness, found.least, found.episodes) == (pytest.approx(-0.5 / 3), -0.75, 3)
    assert (found.violated, found.first) == (2, 2.5)
    other = world(several, "a")
    assert other is not None
    assert (other.violated, other.first, other.episodes) == (0, None, 1)
    edge = world(judgements([Judged("g", 0.0, 1.0)]), "g")
    assert edge is not None
    assert edge.violated == 1
    assert world(several, "none") is None
    assert world(None, "g") is None
    assert world(judgements([UNKNOWN]), "g") is None
    assert judgements([]) is None
    assert stacked([[], []]) is None


def test_additional_formulas_are_sorted_by_name() -> None:
    one = judgements([GOOD, Judged("b", 1.0), Judged("a", 1.0)])
    found = rows(["g", "never"], {"offline": None, "online": one})
    assert [row.formula for row in found] == ["g", "never", "a", "b"]
    assert [[*row.worlds] for row in found] == [["online"], [], ["online"], ["online"]]
    added = with_worlds(
        (FormulaRow("g", found[0].worlds),), {"repaired": [[BAD], [GOOD]], "nominal_repaired": []}
    )
    assert {name: one.violated for name, one in added[0].worlds.items()} == {"online": 0, "repaired": 1}


def test_formula_judgements_follow_the_selected_episodes() -> None:
    base = episodes([(0,)], [(0,)])
    both = stacked([[GOOD], [BAD]])
    samples = [replace(base, judgements=both), base]
    found = together(samples, [(0, 1), (1, 0), (0, 0)])
    assert found is not None
    assert found.robustness[:, 0].tolist() == pytest.approx([-0.25, nan, 0.5], nan_ok=True)
    assert found.lost[0, 0] == 3.5
    assert together([base], [(0, 0)]) is None


NEW = [(0, 7), (1, 7), (2, 7)]
KNOWN = [(0, 1), (1, 1), (2, 2)]


def test_sensors_that_have_only_new_values_are_excluded() -> None:
    assert left_out(episodes(KNOWN), episodes(NEW)) == (1,)
    assert left_out(episodes(KNOWN), episodes([(0, 7), (8, 7)])) == (1,)  # half of the steps
    assert left_out(episodes(KNOWN), episodes([(0, 7), (8, 7), (8, 7)])) == ()
    assert left_out(episodes(KNOWN), episodes([*NEW * 7, (0, 1)])) == (1,)  # 1 of 22
    assert left_out(episodes(KNOWN), episodes([*NEW * 6, (0, 1)])) == ()  # 1 of 19
    assert apart(episodes(KNOWN), episodes(NEW))
    assert not apart(episodes(KNOWN), episodes([*NEW, (0, 1)]))


def test_cells_that_differ_in_a_left_out_sensor_are_joined() -> None:
    found, row = groups([(0, 1), (0, 2), (3, 1)], [1])
    assert (found, row.tolist()) == (((0,), (3,)), [0, 0, 1])
    short = projected(episodes([(0, 1), (0, 2), (3, 1)]), [1])
    assert short.cells == ((0,), (3,))
    assert short.chain.cell.tolist() == [0, 0, 1]
    assert short.chain.next_cell.tolist() == [END] * 3


def test_unknown_utility_is_a_mean_of_similar_cells() -> None:
    table = np.array([[1.0], [4.0], [nan], [nan]])
    visits = Visits(
        np.zeros(3, np.int64), np.array([0, 1, 2]), np.array([9, 1, 2]), *(np.zeros(3) for _ in range(4))
    )
    none = np.empty(0, np.int64)
    recorded = ListSample(1, Edges(none, none, none, none), visits, np.zeros((1, 1)))
    cells = [(0, 0), (0, 1), (0, 2), (5, 0)]
    found = lent(table, recorded, cells, [1])
    assert found[:, 0].tolist() == pytest.approx([1.0, 4.0, 3.0, nan], nan_ok=True)


def test_reward_parts_are_averaged_per_episode() -> None:
    one, two = episodes([(0,), (2,)], [(2,)]), replace(episodes([(0,)]), part_names=("a", "c"))
    assert means(one, two) == {"a": (3.0, 2.0), "b": (-1.0, 0.0), "c": (0.0, 0.0)}


def test_cells_with_a_lost_part_are_named() -> None:
    """In each cell, part b earns minus the number of that cell: the part loses 3 in cell 3 and gains in cell 2."""
    usual = [episodes([(0,), (1,)], [(0,), (1,)], cells=((2,), (3,))) for _ in range(8)]
    moved = [episodes([(0,), (3,)], [(0,), (3,)], cells=((1,), (2,))) for _ in range(8)]
    one, two = (
        merge([replace(sample, seeds=(2 * n, 2 * n + 1)) for n, sample in enumerate(some)])
        for some in (usual, moved)
    )
    found = lost(one, two, 0.05, np.random.default_rng(0))
    assert found == {"a": ((1,),), "b": ((3,),)}
    assert lost(one, one, 0.05, np.random.default_rng(0)) == {"a": (), "b": ()}
    bare = replace(one, part_names=())
    assert lost(bare, bare, 0.05, np.random.default_rng(0)) == {}


@pytest.mark.parametrize(("excess", "named"), [(7.5, ()), (9.0, ((0,),))])
def test_a_part_that_is_lower_by_no_more_than_rounding_can_cause_is_not_named(
    excess: float, named: tuple[Cell, ...]
) -> None:
    """A sum may be off by four rounding errors, and the worlds differ by twice their deviation from the mean."""

    def world_of(part: float) -> Sample:
        one = replace(episodes([(0,)]), part_names=("b",))
        one = replace(one, chain=replace(one.chain, parts=np.array([[part]])))
        return merge([replace(one, seeds=(n,)) for n in range(8)])

    found = lost(world_of(-1.0), world_of(-1.0 - excess * ROUNDING), 0.05, np.random.default_rng(0))
    assert found == {"b": named}


def test_a_loss_is_named_only_below_the_level_and_if_it_is_material(monkeypatch: pytest.MonkeyPatch) -> None:
    """The deployed episode loses 20, 20, 1 and -1 of the part b in its four cells."""
    usual, moved = episodes([(0,), (1,), (2,), (3,)]), episodes([(0,), (1,), (2,), (3,)])
    usual, moved = (replace(one, part_names=("b",)) for one in (usual, moved))
    gains = np.array([[20.0], [20.0], [1.0], [-1.0]])
    usual = replace(usual, chain=replace(usual.chain, parts=gains))
    moved = replace(moved, chain=replace(moved.chain, parts=np.zeros((4, 1))))
    p_values = np.array([0.05, 0.049, 0.01, 0.01])
    monkeypatch.setattr(reward_parts, "max_statistic", lambda *_, **__: p_values)
    assert lost(usual, moved, 0.05, np.random.default_rng(0)) == {"b": ((1,),)}
    p_values[0] = 0.04
    assert lost(usual, moved, 0.05, np.random.default_rng(0)) == {"b": ((0,), (1,))}


def test_symmetric_totals_have_a_symmetric_interval() -> None:
    before = np.array([-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0] * 3)
    low, high = shifts(before + 1.0, before, 0.05)
    assert low < 1.0 < high
    assert high - 1.0 == pytest.approx(1.0 - low, rel=0.25)
    assert 0.5 < high - 1.0 < 1.6  # 1.68 standard errors of 0.65
    assert shifts(np.ones(5), np.zeros(5), 0.05) == (1.0, 1.0)
    assert shifts(np.array([1.0]), np.array([0.0, 1.0]), 0.05) == (-inf, inf)


A, B, C, D = (SitePlace(name, "n.py", line, name, "data", "assign") for line, name in enumerate("ABCD"))


def test_sites_are_ranked_by_share_of_the_difference() -> None:
    first = [
        Slice(A, "l", 4.0, 0.0),
        Slice(B, "l", 0.0, 2.0),
        Slice(C, "l", 1.0, 1.0),
        Slice(D, "l", nan, 1.0),
    ]
    second = [Slice(B, "m", 1.0, 0.0), Slice(C, "m", 1e9, 1e9 + 1e-6)]
    assert prior([first, second]) == ((A, 1.0), (B, 1.0))
    assert prior([first]) == ((A, 1.0), (B, 0.5))
    assert prior([first], {"B"}) == ((B, 0.75), (A, 0.49))
    assert prior([]) == ()


def effect(size: float, code: str = "x") -> OperandEffect:
    return OperandEffect(code, 1.0, 2.0, size)


def test_repaired_culprits_rank_above_other_culprits() -> None:
    ranked = [(A, 1.0), (B, 0.5), (C, 0.25), (D, 0.0)]
    effects = {"A": [effect(1.0), effect(3.0, "y")], "B": [effect(9.0)], "C": []}
    found = culprits(ranked, effects, ["A"], 6.0)
    assert [(one.site, one.score, one.method) for one in found] == [
        (A, 1.0, "sweep"),
        (B, 1.0, "sweep"),
        (C, 0.0, "slices"),
        (D, 0.0, "slices"),
    ]
    assert [one.code for one in found[0].operands] == ["y", "x"]
    plain = culprits(ranked, effects, [], 6.0, "bayes")
    assert [(one.site, one.score) for one in plain[:2]] == [(B, 1.0), (A, 0.5)]
    assert plain[0].method == "bayes"
    assert culprits(ranked, {"A": [effect(-1.0)]}, [], 6.0)[0].score == 0.0
    assert culprits(ranked, {"A": [effect(1.0)]}, [], 0.0)[0].score == 0.0
    assert [one.site for one in culprits(ranked, {}, [], 6.0)] == [A, B, C]


def test_sites_whose_constants_changed_nothing_come_last() -> None:
    ranked = [(A, 1.0), (B, 0.5), (C, 0.25), (D, 0.0)]
    effects = {"A": [effect(0.0)], "B": [effect(-2.0), effect(0.0, "y")], "D": [effect(0.0)]}
    assert [one.site for one in culprits(ranked, effects, ["D"], 6.0)] == [D, B, C, A]


def test_episode_footprint_comes_from_the_first_three(monkeypatch: pytest.MonkeyPatch) -> None:
    one = episodes([(0,)] * 10)
    size = footprint.nbytes(one)
    assert size == sum(column.nbytes for column in vars(one.chain).values()) + 1 + 8 + 8
    told: list[str] = []
    monkeypatch.setattr(footprint, "available", lambda: 5 * 10 * size - 3 * size - 1)
    found = footprint.Footprint(10, told.append)
    for _ in range(6):
        found.add(one)
    assert len(told) == 1
    assert told[0] == found.warning
    fitting = (5 * 10 * size - 3 * size - 1 + 3 * size) * 3 // (5 * 3 * size)
    assert f"Run at most {fitting} with" in told[0]
    monkeypatch.setattr(footprint, "available", lambda: 5 * 10 * size - 3 * size)
    enough = footprint.Footprint(10, told.append)
    for _ in range(3):
        enough.add(one)
    assert len(told) == 1
