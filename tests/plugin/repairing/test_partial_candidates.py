"""Which candidates are tested as partial repairs, in which order, and how many episodes this takes."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.repairing import partial
from pytest_tarl.repairing.incumbent import Watch
from pytest_tarl.repairing.ledger import Refused
from pytest_tarl.repairing.mutants import ORIGINAL
from pytest_tarl.repairing.partial import EPISODES, KNOWN, Best, Gained, _placed, _promising, _run
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.search import Candidate
from tests.plugin.repairing.test_results import of_partial, scaled

ONE, TWO, THREE, FOUR = (scaled(by) for by in (2.0, 3.0, 4.0, 5.0))
DRIFTED, BOTH = (
    2 * EPISODES,
    4 * EPISODES,
)  # episodes of a test that ends in the drifted world, or in both worlds


def best(
    effects: dict[Candidate, tuple[float, float]], change: Callable[[Any, Any, Watch], None] | None = None
) -> tuple[Best | None, int]:
    """Return the result for candidates with given gains in the drifted and the designed world."""
    mutants, judge, found = of_partial(effects)
    if change is not None:
        change(mutants, judge, found)
    return partial.best(mutants, judge, found)


def test_first_helpful_candidate_is_returned() -> None:
    found, spent = best({ONE: (5.0, 0.5), TWO: (7.0, -0.25)})
    assert found == Best(TWO, Gained(7.0, 7.0, 0), Gained(-0.25, -0.25, 0))
    assert spent == KNOWN + BOTH


def test_at_most_two_candidates_are_tested() -> None:
    mutants, judge, found = of_partial({ONE: (5.0, 0.0), TWO: (6.0, 0.0), THREE: (7.0, 0.0)})
    useless = {THREE, TWO}
    runs = mutants.run

    def run(candidate: Candidate, seed: int, drift: str | None) -> Outcome:
        return Outcome(0.0, True) if candidate in useless else runs(candidate, seed, drift)

    mutants.run = run
    assert partial.best(mutants, judge, found) == (None, 2 * KNOWN + 2 * DRIFTED)
    useless.discard(TWO)
    helping, spent = partial.best(mutants, judge, found)
    assert helping is not None
    assert (helping.candidate, spent) == (TWO, 2 * KNOWN + DRIFTED + BOTH)


@pytest.mark.parametrize(("lost", "episodes"), [(1.0, BOTH), (1.01, 0)])
def test_candidate_may_lose_the_margin_as_designed(lost: float, episodes: int) -> None:
    found, spent = best({ONE: (5.0, -lost)})
    assert (found is not None) == bool(episodes)
    assert spent == KNOWN + episodes


@pytest.mark.parametrize(("lost", "tested"), [(2.0, True), (2.01, False)])
def test_costlier_candidate_may_lose_a_fifth_of_its_gain(lost: float, tested: bool) -> None:
    found, spent = best(
        {ONE: (10.0, -lost)}, lambda mutants, _, __: setattr(mutants.order, "permanent", False)
    )
    assert (found is not None) == tested
    assert spent == KNOWN + (BOTH if tested else 0)


def test_costly_unsearched_candidate_is_dropped() -> None:
    def refuse(mutants: Any, judge: Any, watch: Watch) -> None:
        judge.refused = Refused(ONE, "not shown")
        watch.seen.clear()

    assert best({ONE: (10.0, -1.5)}, refuse) == (None, KNOWN)
    found, _ = best({ONE: (10.0, -0.5)}, refuse)
    assert found is not None


def test_harmless_and_costly_candidates_share_the_two_tests() -> None:
    effects = {ONE: (12.0, -2.0), TWO: (11.0, -2.0), THREE: (10.0, -2.0), FOUR: (9.0, 0.0)}
    mutants, judge, found = of_partial(effects)
    tried: list[Candidate] = []

    def run(candidate: Candidate, seed: int, drift: str | None) -> Outcome:
        if drift and candidate != ORIGINAL and candidate not in tried:
            tried.append(candidate)
        return Outcome(effects.get(candidate, (0.0, 0.0))[1] if drift is None else 0.0, True)

    mutants.run = run
    assert partial.best(mutants, judge, found) == (None, 4 * KNOWN + 2 * DRIFTED)
    assert tried == [FOUR, ONE]


def test_at_most_twelve_candidates_are_screened() -> None:
    many = {scaled(2.0 + by): (5.0 + by, -9.0) for by in range(14)}
    assert best(many) == (None, 12 * KNOWN)


def test_a_candidate_that_cannot_run_is_skipped() -> None:
    def breaks(candidate: Candidate, when: Callable[[str | None], bool]) -> Callable[[Any, Any, Watch], None]:
        def change(mutants: Any, _: Any, __: Watch) -> None:
            runs = mutants.run

            def run(one: Candidate, seed: int, drift: str | None) -> Outcome:
                if one == candidate and when(drift):
                    raise RepairError("no")
                return runs(one, seed, drift)  # type: ignore[no-any-return]

            mutants.run = run

        return change

    effects = {ONE: (5.0, 0.0), TWO: (7.0, 0.0), THREE: (6.0, 0.0)}
    found, spent = best(effects, breaks(TWO, lambda drift: drift is None))
    assert found is not None
    assert (found.candidate, spent) == (THREE, 2 * KNOWN + BOTH)
    found, spent = best(effects, breaks(TWO, lambda drift: drift is not None))
    assert found is not None
    assert (found.candidate, spent) == (THREE, 2 * KNOWN + DRIFTED + BOTH)  # the failed test counts as one


def test_permanent_drift_ignores_designed_losses() -> None:
    def permanent(mutants: Any, _: Any, __: Watch) -> None:
        mutants.order.permanent = True

    found, _ = best({ONE: (5.0, -9.0)}, permanent)
    assert found is not None
    assert found.designed.mean == -9.0


def test_candidate_moves_to_its_definition_in_few_episodes() -> None:
    mutants, judge, _ = of_partial({})
    judge.placing = lambda candidate, trials: [trials.charge() for _ in range(5)] and TWO
    assert _placed(mutants, judge, ONE) == (TWO, 5)
    judge.placing = lambda candidate, trials: [trials.charge() for _ in range(12)] and None
    assert _placed(mutants, judge, ONE) == (ONE, 12)
    judge.placing = lambda candidate, trials: [trials.charge() for _ in range(13)] and TWO
    assert _placed(mutants, judge, ONE) == (ONE, 12)


def test_placing_episodes_run_under_drift_and_are_counted() -> None:
    mutants, judge, found = of_partial({ONE: (5.0, 0.0)})
    totals: list[float] = []

    def placing(candidate: Candidate, trials: Any) -> Candidate:
        totals.append(trials(candidate, 4).total)
        return candidate

    judge.placing = placing
    assert partial.best(mutants, judge, found)[1] == 1 + KNOWN + BOTH
    assert totals == [5.0]


def test_promising_candidates_need_a_tenth_of_the_wanted_gain() -> None:
    def names(gains: dict[Candidate, float], furthest: Candidate | None = None) -> list[Candidate]:
        _, judge, found = of_partial({one: (gain, 0.0) for one, gain in gains.items()})
        judge.refused = Refused(furthest, "budget")
        return [*_promising(judge, found)]

    assert names({ONE: 0.8, TWO: 0.79}) == [ONE]  # the goal wants 8
    assert names({ONE: 0.5}, furthest=ONE) == []
    assert names({ONE: 5.0}, furthest=TWO) == [TWO, ONE]


def test_episodes_are_announced_before_they_run() -> None:
    told: Any = []
    mutants: Any = SimpleNamespace(
        foresee=lambda wanted, drift: told.append((wanted, drift)),
        run=lambda one, seed, drift: told.append((one, seed, drift)) or Outcome(float(seed), True),
    )
    assert [one.total for one in _run(mutants, ONE, (3, 1), "mud")] == [3.0, 1.0]
    assert told == [([(ONE, 3), (ONE, 1)], "mud"), (ONE, 3, "mud"), (ONE, 1, "mud")]
