"""The results that a repair stores on its candidates, and its conclusions from them, for values written by hand."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.drifts import Drift
from pytest_tarl.learning.bounds import mean_of
from pytest_tarl.model import Band, Conjunct, Guard, Reason, Sizes
from pytest_tarl.patching.charts import SHARE
from pytest_tarl.patching.mutate import Mutation, mutations, stepped
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import SHIPPED, template
from pytest_tarl.repairing import partial, ranges, telling_sensors
from pytest_tarl.repairing.between import WEAKEST, Between, factor, further, stronger
from pytest_tarl.repairing.centring import centred, moved, neighbours
from pytest_tarl.repairing.incumbent import Watch
from pytest_tarl.repairing.ledger import Ledger, Refused, Tried, alike, of_fresh_seeds
from pytest_tarl.repairing.missed import Missed, _spread
from pytest_tarl.repairing.other_values import Others, ratio_of
from pytest_tarl.repairing.partial import Gained, _affordable, _lost_as_designed, _promising
from pytest_tarl.repairing.ranges import Ranged, bands_in_words, fits_a_part, over_the_range, repaired_sizes
from pytest_tarl.repairing.request import goal
from pytest_tarl.searching.accept import Acceptance, Outcome, Reference
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.sensors import Sensor
from tests.plugin.searching.test_search import operand

GAIN, OTHER = operand(3, "2.0", 2.0), operand(4, "4.0", 4.0)
WET = Guard((Conjunct(Sensor("wet", topic="/wet", field="data"), 1, 1),))
PAIRS = tuple(Pair(seed, float(seed)) for seed in range(3))
GOAL = Goal(PAIRS, near=8.0, enough=9.0, online=0.5)


def scaled(by: float, guard: Guard = ALWAYS, of: Any = GAIN) -> Candidate:
    """Return a candidate that multiplies the gain of 2, or another operand."""
    return Candidate((Mutation(of, by * of.value),), guard)


def watch(*seen: tuple[Candidate, int, float]) -> Watch:
    order: Any = SimpleNamespace(goal=GOAL)
    found = Watch(order)
    for one, seed, total in seen:
        found.saw(one, seed, Outcome(total, True))
    return found


def test_rarely_run_candidate_seldom_becomes_best() -> None:
    one, two = scaled(2.0), scaled(3.0)
    found = watch((one, 0, 4.0), (two, 0, 3.0))
    assert found.best == one
    found.saw(two, 1, Outcome(4.0, True))  # a gain counts runs / (runs + 1): 3·2/3 = 4·1/2
    assert found.best == one
    found.saw(two, 2, Outcome(5.5, True))
    assert found.best == two
    assert found.gain(two) == pytest.approx((3.0 + 3.0 + 3.5) / 3)
    found.saw(one, 9, Outcome(2.5, True))  # a seed without an unmutated run is compared with the mean
    assert found.gain(one) == pytest.approx((4.0 + 2.0) / 2)


def test_best_candidate_is_reported_unless_refused() -> None:
    one, fresh = scaled(2.0), Refused(scaled(3.0), "not shown", 1.0, 5)
    found = watch((one, 0, 4.0), (one, 1, 6.0))
    nothing = Refused(None, "budget")
    assert found.best_so_far(fresh) is fresh
    assert found.best_so_far(nothing) == Refused(one, "budget", 5.0, 2)
    assert watch().best_so_far(nothing) is nothing
    assert watch().progress("sweep") == "sweep"
    assert found.progress("sweep") == "sweep (best so far +4.5 of 8)"


def test_one_good_mission_of_three_leaves_a_candidate_unconfirmed() -> None:
    one, two, far, examined = (scaled(by) for by in (2.0, 3.0, 4.0, 5.0))
    runs = [(two, 0, 8.0), (two, 1, 1.0)]  # twice only
    for candidate, first in ((one, 8.0), (far, 7.9), (examined, 9.0)):
        runs += [(candidate, 0, first), (candidate, 1, 1.0), (candidate, 2, 2.0)]
    tried = [Tried(examined, "not shown", ())]
    assert watch(*runs).unconfirmed(tried) == [Tried(one, "not confirmed", (8.0, 1.0, 2.0))]


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        (scaled(2.0), scaled(2.1), True),
        (scaled(2.0), scaled(2.106), False),
        (scaled(2.0), scaled(-2.0), False),
        (scaled(2.0), scaled(2.0, WET), False),
        (scaled(2.0), scaled(1.0, of=OTHER), False),
        (scaled(-2.0), scaled(-2.1), True),
    ],
)
def test_candidates_within_five_percent_are_equal(one: Candidate, other: Candidate, expected: bool) -> None:
    assert alike(one, other) is expected
    assert alike(other, one) is expected


def test_ledger_finds_similar_candidates() -> None:
    ledger = Ledger()
    first = ledger.enter(Tried(scaled(2.0), "not shown", (1.0,), fresh=True, tested=True))
    ledger.enter(Tried(scaled(4.0), "gain too small", (), fresh=True))
    ledger.enter(Tried(scaled(5.0, WET), "not shown", (), tested=True))
    ledger.enter(Tried(scaled(5.0, of=OTHER), "not shown", (), tested=True))
    assert ledger.alike(scaled(2.05)) is first
    assert ledger.alike(scaled(3.0)) is None
    assert (ledger.tests(scaled(9.0)), ledger.tests(scaled(9.0, of=OTHER))) == (2, 1)
    assert of_fresh_seeds(ledger.tried) == 2


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        (scaled(3.0), scaled(2.0), True),
        (scaled(2.0), scaled(2.0), True),
        (scaled(2.0), scaled(3.0), False),
        (scaled(0.3), scaled(0.5), True),
        (scaled(0.6), scaled(0.5), False),
        (scaled(0.5), scaled(2.0), False),
        (scaled(2.0), scaled(1.0), False),
        (scaled(-2.0), scaled(-2.0), False),
        (scaled(3.0), scaled(2.0, of=OTHER), False),
    ],
)
def test_stronger_candidate_changes_the_same_constants_more(
    one: Candidate, other: Candidate, expected: bool
) -> None:
    assert further(one, other) is expected


@pytest.mark.parametrize(
    ("mutation", "expected"),
    [
        (Mutation(GAIN, 5.0), 2.5),
        (Mutation(GAIN, -5.0), None),
        (Mutation(replace(GAIN, code="KP", definition=operand(1, "2.0", 2.0).span), 2.5), 2.5),
        (Mutation(replace(GAIN, value=True), value=False), None),
    ],
)
def test_changed_constant_has_the_factor_of_its_values(mutation: Mutation, expected: float | None) -> None:
    if not mutation.operand.literal:
        assert mutation.operand.code == "KP"
    assert factor(mutation) == expected


def factors(of: Candidate | None) -> list[float]:
    assert of is not None
    return [factor(one) or math.nan for one in of.mutations]


def test_bisection_halves_exponents() -> None:
    both = Candidate((*scaled(16.0).mutations, *scaled(1 / 16.0, of=OTHER).mutations), ALWAYS)
    between = Between(both, mutations)
    assert factors(between.middle()) == pytest.approx([4.0, 0.25], rel=0.01)
    assert between.told("gain too small")
    assert factors(between.middle()) == pytest.approx([8.0, 0.125], rel=0.01)
    assert between.told("nominal gets worse")
    assert factors(between.middle()) == pytest.approx([16**0.625, 16**-0.625], rel=0.01)
    assert not between.told("not shown")
    assert between.middle() is not None
    assert between.middle() is None  # four steps


def test_bisection_begins_at_the_furthest_weak_candidate() -> None:
    between = Between(scaled(16.0), mutations)
    for weak in (scaled(4.0), scaled(2.0), scaled(0.5), scaled(3.0, of=OTHER), scaled(20.0)):
        between.beyond(weak)
    assert (between.weak, between.strong) == (0.5, 1.0)
    assert factors(between.middle()) == pytest.approx([8.0], rel=0.01)


def test_sign_changes_and_small_steps_are_not_bisected() -> None:
    assert Between(scaled(-2.0), mutations).middle() is None
    assert Between(scaled(1.04), mutations).middle() is None
    assert Between(scaled(1 / 1.04), mutations).middle() is None
    assert Between(scaled(1.06), mutations).middle() is not None


def test_parameter_of_a_structural_change_is_bisected() -> None:
    made = template(SHIPPED / "low_pass.toml")
    form = Form(made, made.parameters[0].name)
    between = Between(
        Candidate((replace(scaled(2.0).mutations[0], value=-0.8, form=form),), ALWAYS), mutations
    )
    assert [one.value for one in (between.middle() or scaled(2.0)).mutations] == [pytest.approx(-0.4)]
    assert between.told("gain too small")
    middle = between.middle()
    assert middle is not None
    assert middle.mutations[0].value == pytest.approx(-0.8 * WEAKEST**0.25)


def test_stronger_candidate_has_larger_factors() -> None:
    both = Candidate((*scaled(2.0).mutations, *scaled(0.5, of=OTHER).mutations), WET)
    found = stronger(both, 2.0, mutations)
    assert factors(found) == pytest.approx([4.0, 0.25])
    assert found is not None
    assert found.guard == WET
    for by in (-2.0, 1.0):
        assert stronger(scaled(by), 2.0, mutations) is None


def test_only_single_site_values_are_moved() -> None:
    assert factors(moved(scaled(2.0), 1.5, mutations)) == [3.0]
    beside = replace(OTHER, site=GAIN.site)
    both = Candidate((*scaled(2.0).mutations, *scaled(0.5, of=beside).mutations), ALWAYS)
    assert factors(moved(both, 1.5, mutations)) == pytest.approx([3.0, 0.75])
    away = replace(OTHER, site=replace(GAIN.site, text="other"))
    both = Candidate((*scaled(2.0).mutations, *scaled(0.5, of=away).mutations), ALWAYS)
    assert moved(both, 1.5, mutations) is None
    found = [factors(one)[0] for one in neighbours(scaled(2.0), mutations)]
    assert found == pytest.approx([2.5, 1.6, 2.24, 1.78])


def test_candidates_with_one_different_value_are_compared_by_ratio() -> None:
    assert ratio_of(scaled(3.0), scaled(2.0)) == pytest.approx(1.5)
    for other in (scaled(2.0, WET), scaled(2.0, of=OTHER), scaled(-2.0)):
        assert ratio_of(scaled(3.0), other) is None
    both = Candidate((*scaled(2.0).mutations, *scaled(0.5, of=OTHER).mutations), ALWAYS)
    assert ratio_of(both, both) is None


@pytest.mark.parametrize(
    ("lost", "expected"),
    [((1.8, 2.2), True), ((1.5, 2.2), False), ((1.8, 1.9), False), ((1.6, 2.6), True), ((), False)],
)
def test_a_narrow_window_has_close_values_on_both_sides(lost: Sequence[float], expected: bool) -> None:
    missed = Missed()
    missed.few = {scaled(by): [] for by in lost}
    mutants: Any = SimpleNamespace(mutate=mutations)
    assert Others(mutants, Ledger(), missed).bracketed(scaled(2.0)) is expected


MARGIN = Reference([10.0, 10.0], 1.0, 1.0, 0.0)


@pytest.mark.parametrize(
    ("by", "expected"),
    [(2.0, 2.6), (1.2, 1.2 * 1.3**3), (6.0, 6.0 / 1.3**2), (5.2, 4.0), (4.4, 4.4), (3.4, 3.4), (0.5, 0.5)],
)
def test_value_increases_while_it_loses_much_of_the_margin(by: float, expected: float) -> None:
    """A mission earns 10 minus 0.8 times |log2(factor / 3.4)|, and fails if the factor is below 1."""

    def run(one: Candidate, seed: int) -> Outcome:
        value = factors(one)[0]
        return Outcome(10.0 - 0.8 * abs(math.log2(3.4 / value)), value >= 1.0)

    goal = replace(GOAL, passing=True)
    trials = Trials(run, 99)
    found = centred(scaled(by), trials, mutations, goal, MARGIN, Ledger().knows)
    assert factors(found) == pytest.approx([expected], rel=0.02)


def acceptance(losses: dict[int, float], failed: Sequence[int] = (), **changes: Any) -> Acceptance:
    """Return a test in which designed missions earn 10 and the candidate loses `losses[seed]` on each seed."""
    drifted = tuple(Outcome(10.0 - lost, seed not in failed) for seed, lost in losses.items())
    one = Acceptance(False, "not shown", drifted, (), seeds=(*losses,), designed=(10.0,) * len(losses))
    return replace(one, **changes)


def test_mission_is_lost_if_its_loss_exceeds_the_slack() -> None:
    missed, one = Missed(), scaled(2.0)
    goal = replace(GOAL, passing=True)
    losses = dict.fromkeys(range(20, 40), 0.0) | {21: 2.0, 22: 2.1, 23: 9.0}
    missed.learn(one, acceptance(losses, failed=[24]), goal, MARGIN)
    assert missed.seeds == [(22, 8.0), (23, 8.0), (24, 8.0)]
    assert missed.few == {one: [(22, 8.0), (23, 8.0), (24, 8.0)]}
    assert missed.poor == {one}
    assert len(missed.spread[one]) == 5
    many = Missed()
    many.learn(one, acceptance(dict.fromkeys(range(8), 3.0) | {9: 0.0}, failed=[0, 1]), goal, MARGIN)
    assert (len(many.seeds), many.few, many.poor) == (8, {}, set())
    little = replace(
        acceptance({1: 0.0, 2: 0.0}), designed=(20.0, 5.0), drifted=(Outcome(8.0, True), Outcome(2.9, True))
    )
    few = Missed()
    few.learn(one, little, GOAL, MARGIN)
    assert few.seeds == [(2, 3.0)]  # a designed mission counts at most as the mean reward
    assert few.poor == set()  # here, missions need not succeed


def test_mission_that_also_fails_as_designed_is_not_lost() -> None:
    found = replace(
        acceptance({1: 0.0, 2: 0.0, 3: 0.0}, failed=[1, 2]),
        designed=(10.0, -3.0, 10.0),
        drifted=(Outcome(1.0, False), Outcome(-7.0, False), Outcome(10.0, True)),
    )
    missed = Missed()
    missed.learn(scaled(2.0), found, replace(GOAL, passing=True), MARGIN)
    assert missed.seeds == [(1, 8.0)]


@pytest.mark.parametrize(
    ("lost", "expected", "runs"), [((0, 1), True, 2), ((0, 2), True, 3), ((0,), False, 3), ((3,), False, 3)]
)
def test_candidate_fails_again_after_recent_losses(lost: Sequence[int], expected: bool, runs: int) -> None:
    missed = Missed([(9, 99.0), *((seed, 8.0) for seed in range(3))])
    trials = Trials(lambda _, seed: Outcome(7.9 if seed in lost else 8.0, True), 9)
    assert missed.again(scaled(2.0), trials, GOAL) is expected
    assert trials.spent == runs
    assert not Missed().again(scaled(2.0), trials, GOAL)


def test_better_candidate_passes_all_missions_that_another_lost() -> None:
    refused = scaled(2.0)
    missed = Missed(few={refused: [(1, 8.0), (2, 7.0)]})
    for totals, expected in (((8.0, 7.0), True), ((7.9, 9.0), False), ((9.0, 6.9), False)):
        trials = Trials(lambda _, seed, totals=totals: Outcome(totals[seed - 1], True), 9)  # type: ignore[misc]
        assert missed.mends(scaled(3.0), refused, trials, GOAL) is expected


@given(st.lists(st.integers(-5, 5), min_size=1, max_size=40))
def test_representative_missions_are_evenly_spaced_by_loss(losses: list[int]) -> None:
    found = _spread(acceptance(dict(enumerate(map(float, losses)))))
    assert len(found) == min(5, len(losses))
    told = [one.loss for one in found]
    assert told == sorted(told)
    assert len({one.seed for one in found}) == len(found)
    assert all(one.loss == losses[one.seed] for one in found)
    if len(losses) in (1, 2, 3, 4, 5):
        assert told == sorted(losses)
    if len(losses) == 25:  # ranks 2, 7, 12, 17, 22
        assert told == [float(sorted(losses)[rank]) for rank in range(2, 25, 5)]


def examined(*tried: tuple[Candidate, Reason], furthest: Candidate | None = None) -> Any:
    entries = [Tried(one, reason, ()) for one, reason in tried]
    return SimpleNamespace(tried=entries, refused=Refused(furthest, "not shown"))


def test_promising_candidates_include_the_best_refused_one() -> None:
    best, little, harmful, unseen = scaled(2.0), scaled(3.0), scaled(4.0), scaled(9.0)
    more = scaled(5.0)
    found = watch(
        (best, 0, 4.0), (little, 0, 0.79), (harmful, 0, 9.0), (more, 0, 3.0), (more, 1, 4.5), (more, 2, 5.5)
    )
    judge = examined((harmful, "breaks other missions"), (best, "not shown"), furthest=unseen)
    assert [*_promising(judge, found)] == [unseen, more, best]  # 3.33·3/4 counts more than 4·1/2
    assert [*_promising(examined(furthest=best), found)] == [best, harmful, more]


def test_designed_loss_is_the_mean_of_three_recorded_missions() -> None:
    def mutants(permanent: bool = False) -> Any:
        sample = SimpleNamespace(seeds=(4, 5, 6, 7), total=np.array([10.0, 11.0, 12.0, 13.0]))
        order = SimpleNamespace(permanent=permanent, fixture=SimpleNamespace(sample=sample))
        totals = {4: 4.0, 5: 11.0, 6: 12.0, 7: -99.0}
        return SimpleNamespace(
            order=order, foresee=lambda *_: None, run=lambda _, seed, __: Outcome(totals[seed], True)
        )

    assert _lost_as_designed(mutants(), scaled(2.0)) == pytest.approx(2.0)
    assert _lost_as_designed(mutants(permanent=True), scaled(2.0)) == 0.0


@pytest.mark.parametrize(
    ("gained", "low", "failures", "expected"),
    [
        (0.5, -1.0, 2, True),
        (0.5, -1.01, 0, False),
        (0.5, 0.0, 3, False),
        (10.0, -2.0, 2, True),
        (10.0, -2.01, 0, False),
    ],
)
def test_partial_repair_costs_at_most_the_margin(
    gained: float, low: float, failures: int, expected: bool
) -> None:
    mutants: Any = SimpleNamespace(order=SimpleNamespace(reference=MARGIN))
    assert _affordable(mutants, Gained(gained, gained, 0), Gained(0.0, low, failures)) is expected


def of_partial(effects: dict[Candidate, tuple[float, float]]) -> tuple[Any, Any, Watch]:
    """Return mutants, an examiner and a watch; `effects` are the candidates' gains under the drift and as designed."""
    sample = SimpleNamespace(seeds=(4, 5, 6), total=np.zeros(3))
    options = SimpleNamespace(seed=0, alpha=0.05)
    order: Any = SimpleNamespace(
        permanent=False,
        drift="mud",
        reference=MARGIN,
        options=options,
        fixture=SimpleNamespace(sample=sample),
        goal=GOAL,
    )

    def run(candidate: Candidate, seed: int, drift: str | None) -> Outcome:
        under, designed = effects.get(candidate, (0.0, 0.0))
        return Outcome(under if drift else designed, True)

    placing = lambda candidate, trials: candidate  # noqa: E731
    judge = SimpleNamespace(tried=[], refused=Refused(None, "budget"), placing=placing)
    found = watch(*((one, 0, under) for one, (under, _) in effects.items()))
    return SimpleNamespace(order=order, foresee=lambda *_: None, run=run), judge, found


def test_cheap_change_is_a_partial_repair() -> None:
    costly, ruinous, harmless = scaled(2.0), scaled(3.0), scaled(4.0)
    effects = {costly: (10.0, -1.9), ruinous: (12.0, -9.0)}
    found, spent = partial.best(*of_partial(effects))
    assert found is not None
    assert (found.candidate, found.designed.mean, spent) == (
        costly,
        -1.9,
        2 * partial.KNOWN + 4 * partial.EPISODES,
    )
    found, _ = partial.best(*of_partial({**effects, harmless: (5.0, -0.5)}))
    assert found is not None
    assert found.candidate == harmless
    assert partial.best(*of_partial({ruinous: (12.0, -9.0)}))[0] is None


def ranged(part: str = "") -> Any:
    """Return an order whose drift draws sizes from 0 to 3; seed n draws a size near n."""
    sizes = {part: Sizes(part, 0.0, 3.0, {"online": (1.0,)})}
    return SimpleNamespace(
        world=Drift.range(0.0, 3.0),
        drift="mud",
        goal=GOAL,
        reference=MARGIN,
        options=SimpleNamespace(seed=3),
        comparison=SimpleNamespace(sizes=sizes),
    )


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let each seed draw a drift size of a tenth of the seed."""
    monkeypatch.setattr(
        ranges, "_drawn", lambda order, seed: dict.fromkeys(order.comparison.sizes, seed / 10)
    )
    monkeypatch.setattr(ranges, "spread_seeds", lambda order, stream, most: tuple(range(most)))


BANDS = [Band("", 0.0, 1.0), Band("", 1.0, 2.0), Band("", 2.0, 3.0)]


@pytest.mark.usefixtures("drawn")
@pytest.mark.parametrize(
    ("losses", "accepted", "reason", "held", "expected"),
    [
        ({5: 1.0, 15: 1.0, 25: 0.0}, True, "", (0, 1, 2), ""),
        ({5: 0.0, 15: 1.1, 25: 0.0}, True, "", (0, 2), "not over the whole range"),
        ({5: 0.0, 15: 1.1, 25: 0.0}, False, "not shown", (0, 2), "not over the whole range"),
        ({5: 9.0, 15: 9.0, 25: 9.0}, False, "not shown", (), "not shown"),
        ({5: 0.0, 15: 9.0, 25: 9.0}, False, "nominal gets worse", (0,), "nominal gets worse"),
        ({5: 0.0, 15: 0.0}, True, "", (0, 1), "not over the whole range"),
        ({10: 0.5, 12: 1.4, 25: 0.0}, True, "", (0, 1, 2), ""),  # an end belongs to both parts
    ],
)
def test_repair_must_hold_in_every_part(
    losses: dict[int, float], accepted: bool, reason: Reason, held: tuple[int, ...], expected: Reason
) -> None:
    result = acceptance(losses, accepted=accepted, reason=reason)
    found, told = over_the_range(ranged(), "s", 4, lambda seeds: replace(result, episodes=len(seeds)))
    assert (found.reason, found.accepted, found.episodes) == (expected, not expected, 4)
    assert told.seeds == (*losses,)
    assert told.held == tuple(BANDS[n] for n in held)
    assert told.lost == tuple(band for n, band in enumerate(BANDS) if n not in held)


def test_a_drift_without_a_range_is_tested_once() -> None:
    order: Any = SimpleNamespace(
        comparison=SimpleNamespace(sizes={}), options=SimpleNamespace(seed=3), reference=MARGIN
    )
    result = acceptance({5: 9.0}, accepted=True, reason="")
    assert over_the_range(order, "s", 4, lambda _: result) == (result, Ranged())


@pytest.mark.usefixtures("drawn")
@pytest.mark.parametrize(
    ("near", "far", "part", "expected"),
    [
        ((1, 2), (5, 6), "", "it works for sizes from 0.1 to 0.2, but not for 0.5 to 0.6"),
        ((5, 6), (1,), "mud", "it works for sizes of mud from 0.5 to 0.6, but not for 0.1 to 0.1"),
        ((1, 5), (3,), "", ""),
        ((1,), (5,), "", ""),
        ((1, 2), (), "", ""),
    ],
)
def test_candidate_for_one_end_is_described_by_its_sizes(
    near: tuple[int, ...], far: tuple[int, ...], part: str, expected: str
) -> None:
    runs = {seed: Outcome(8.0, True) for seed in near} | {seed: Outcome(7.9, True) for seed in far}
    assert fits_a_part(ranged(part), runs) == expected


def test_sizes_where_a_repair_holds_are_listed() -> None:
    one, two, three = BANDS
    assert bands_in_words(Ranged((), (one, two), (three,))) == (
        "it works for sizes 0 to 1 and sizes 1 to 2, but not for sizes 2 to 3"
    )
    assert bands_in_words(Ranged((), (), (three,))) == "it works in no part of the range (sizes 2 to 3)"


@pytest.mark.usefixtures("drawn")
def test_range_repair_reports_the_sizes_of_its_acceptance_test() -> None:
    (found,) = repaired_sizes(ranged(), Ranged((5, 15))).values()
    assert found.of == {"online": (1.0,), "repaired": (0.5, 1.5)}


def test_search_goal_is_the_designed_reward_minus_tolerance() -> None:
    online = [Pair(1, 5.0), Pair(2, 8.5), Pair(3, 6.0), Pair(4, 10.0)]
    reference = Reference([9.0, 11.0], 0.95, 1.5, 0.0)
    found = goal(online, reference, 20.0)
    # mean 10, standard deviation √2: near is 10 - max(1.5, 2.83, 2), enough 10 - max(1.5, 1.41)
    assert found.near == pytest.approx(10 - 2 * math.sqrt(2))
    assert found.enough == 8.5
    assert [pair.seed for pair in found.pairs] == [3, 1]  # the worst last
    assert found.online == pytest.approx(7.375)
    assert found.passing
    assert goal(online, replace(reference, margin=1.0), 40.0).near == 6.0
    assert goal(online, replace(reference, margin=1.0), 40.0).enough == pytest.approx(10 - math.sqrt(2))
    assert not goal(online, replace(reference, pass_rate=0.94), 20.0).passing
    nothing = goal([Pair(4, 10.0)], replace(reference, totals=[10.0]), 0.0)
    assert (nothing.pairs, nothing.near) == ((Pair(4, 10.0),), 8.5)


def test_sensor_with_separate_values_distinguishes_worlds(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    worlds = {
        "designed": {(0.0, 1.0): 0.75, (1.0, 2.0): 0.25},
        "drifted": {(1.0, 2.0): 0.5, (2.0, 3.0): 0.5},
    }
    order: Any = SimpleNamespace(
        fixture=SimpleNamespace(sample="designed"),
        online=SimpleNamespace(recorded=SimpleNamespace(sample="drifted")),
    )
    monkeypatch.setattr(telling_sensors, "_shares", lambda _, world, __: worlds[world])
    sensor: Any = None
    assert telling_sensors._overlap(order, sensor) == 0.25
    worlds["drifted"] = {}
    assert telling_sensors._overlap(order, sensor) == 1.0


def test_logarithmic_step_is_reported_as_a_factor() -> None:
    share = operand(3, "0.95", 0.95)
    step = stepped(share, 2.0, SHARE, mutations)
    assert step is not None
    assert factor(step) == pytest.approx(2.0, rel=0.01)


def test_partial_gains_are_paired_by_seed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(partial, "EPISODES", 4)
    asked: list[Any] = []

    def run(one: Candidate, seed: int, drift: str | None) -> Outcome:
        place = ran.setdefault(one, []).append(seed) or len(ran[one])
        return Outcome(10.0 * place + (place if one.mutations else 0), not one.mutations or place > 1)

    ran: Any = {}
    order = SimpleNamespace(options=SimpleNamespace(seed=3, alpha=0.1))
    mutants: Any = SimpleNamespace(order=order, run=run, foresee=lambda *one: asked.append(one))
    found = partial._gained(mutants, scaled(2.0), "mud", 1)
    assert (found.mean, found.failures) == (2.5, 1)
    assert found.low == mean_of([1.0, 2.0, 3.0, 4.0], 0.95).low
    with_it, without = ran.values()
    assert with_it == without
    assert [drift for _, drift in asked] == ["mud", "mud"]
