"""Decisions of a repair that depend on other parts, which are scripted here: goals, phases, queues and notes."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.drifts import Drift
from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.repairing import accepting, other_values, repair, request
from pytest_tarl.repairing.accepting import OLD_WORLD, Accepted, Examiner
from pytest_tarl.repairing.ledger import Tried
from pytest_tarl.repairing.missed import Missed
from pytest_tarl.repairing.other_values import KNOWN, Others
from pytest_tarl.repairing.regression_tests import Beside
from pytest_tarl.repairing.request import Order, spread
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from tarl_lint.model import SiteId, Span
from tests.plugin.repairing.test_accepting import DRIFTED, WET, Field
from tests.plugin.searching.test_search import operand

# The order and its goal


def sample(totals: list[float], passed: float = 1.0) -> Any:
    count = len(totals)
    return SimpleNamespace(
        seeds=tuple(range(50, 50 + count)),
        total=np.array(totals),
        steps=np.arange(10, 10 + count),
        passed=np.array([passed] * count),
    )


def order(online: list[float], sizes: tuple[str, ...] = (), **changes: Any) -> Order:
    verdict = SimpleNamespace(tolerance=changes.pop("tolerance", 1.5), loss=20.0)
    comparison = SimpleNamespace(
        verdict=verdict, sizes=dict.fromkeys(sizes), drift="mud", permanent=False, totals={}
    )
    usual: dict[str, Any] = {
        "rollout": None,
        "analysis": None,
        "root": Path("/project"),
        "fixture": SimpleNamespace(sample=sample([9.0, 11.0])),
        "online": SimpleNamespace(comparison=comparison, recorded=SimpleNamespace(sample=sample(online))),
        "options": None,
        "progress": None,
        "patches": Path("/patches"),
    }
    return Order(**usual | changes)


def test_goal_has_failing_episodes_and_designed_mean_length() -> None:
    found = order([5.0, 10.0, 6.0]).goal
    assert found.pairs == (Pair(52, 6.0, 12), Pair(50, 5.0, 10))
    assert (found.steps, found.ranged, found.online) == (10.5, False, 7.0)
    given = Goal((), near=1.0, enough=2.0, online=3.0)
    assert order([5.0], searched=given).goal is given


@pytest.mark.parametrize(
    ("sizes", "world", "ranged"), [(("",), True, True), (("",), False, False), ((), True, False)]
)
def test_first_episodes_span_the_range_of_sizes(
    monkeypatch: pytest.MonkeyPatch, sizes: tuple[str, ...], world: bool, ranged: bool
) -> None:
    monkeypatch.setattr(request, "sizes", lambda world, drift, seed: {"": float(seed % 50)})
    drift: Any = Drift(True) if world else None
    found = order([5.0, 4.0, 3.0, 2.0, 1.0], sizes, world=drift).goal
    expected = [52, 51, 54, 50, 53] if ranged else [50, 51, 52, 53, 54]
    assert ([pair.seed for pair in found.pairs], found.ranged) == (expected, ranged)


@pytest.mark.parametrize(
    ("drawn", "expected"),
    [
        ([], []),
        ([(1.0, 0)], [0]),
        ([(2.0, 0), (1.0, 1)], [0, 1]),
        ([(0.1 * at, at) for at in range(7)], [3, 1, 5, 0, 2, 4, 6]),
        ([(9.0 - at, at) for at in range(4)], [1, 2, 0, 3]),
    ],
)
def test_episodes_are_ordered_by_halving_the_range(
    drawn: list[tuple[float, int]], expected: list[int]
) -> None:
    found = list(spread(drawn))
    assert found == expected
    assert sorted(found) == [*range(len(drawn))]


@pytest.mark.parametrize(
    ("declared", "low", "high"), [(None, 2.0, None), ((0.0, 30.0), 0.0, 30.0), ((5.0, 30.0), 2.0, 30.0)]
)
def test_the_reference_is_the_recording_with_the_declared_range(
    declared: Any, low: float, high: float | None
) -> None:
    of = order([5.0, 2.0, 12.0], declared=declared)
    found = of.reference
    assert (of.worst, found.totals, found.pass_rate, found.margin) == (2.0, [9.0, 11.0], 1.0, 1.5)
    assert (found.lowest, found.highest) == (low, high)
    assert order([5.0], tolerance=0.0).reference.margin == pytest.approx(0.05 * 20.0)


# The examiner


def examiner(
    line_up: list[str], monkeypatch: pytest.MonkeyPatch, **parts: Any
) -> tuple[Examiner, Any, Trials]:
    monkeypatch.setattr(
        "pytest_tarl.searching.candidates.firing_episodes", lambda guard, sample, _: sample.seeds
    )
    field: Any = Field(line_up)
    for name, value in parts.items():
        setattr(field.order, name, value)
    trials = Trials(lambda candidate, seed: field.run(candidate, seed, "mud"), 300)
    return Examiner(field, (ALWAYS,)), field, trials


def test_a_candidate_that_cannot_be_written_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    one, field, trials = examiner(["good"], monkeypatch)

    def unwritable(*_: Any) -> str:
        raise RepairError("two parentheses")

    monkeypatch.setattr(accepting, "known_to_fail", unwritable)
    found = one._examined(field.candidates[0], trials)
    assert isinstance(found, Tried)
    assert (found.reason, found.fresh) == ("cannot be written", False)
    assert one.refused.reason == "cannot be written"


def test_smoother_form_of_a_candidate_is_accepted(monkeypatch: pytest.MonkeyPatch) -> None:
    one, field, trials = examiner(["good", "good"], monkeypatch)
    first, nicer = field.candidates
    monkeypatch.setattr(accepting, "smoothed", lambda _, candidate: [nicer] if candidate == first else [])
    found = one._examined(first, trials)
    assert isinstance(found, Accepted)
    assert found.candidate == nicer
    one, field, trials = examiner(["good", "bad at once"], monkeypatch)
    first, nicer = field.candidates
    found = one._examined(first, trials)
    assert isinstance(found, Accepted)
    assert found.candidate == first
    assert [each.candidate for each in one.tried] == [nicer, first]


@pytest.mark.parametrize("kind", ["lucky on known seeds", "bad as designed"])
def test_constant_follows_a_sensor_if_it_fits_only_some_missions(
    monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    one, field, trials = examiner([kind, "good"], monkeypatch)
    asked: list[Candidate] = []

    def following(_: object, candidate: Candidate) -> list[Candidate]:
        asked.append(candidate)
        return [field.candidates[1]]

    monkeypatch.setattr(other_values, "following", following)
    found = one.first(iter(field.candidates[:1]), trials)
    assert found is not None
    assert found.candidate == field.candidates[1]
    assert asked == field.candidates[:1]


def test_candidate_with_known_losses_is_not_improved(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    one, field, trials = examiner(["good"], monkeypatch)
    centred: list[Candidate] = []

    def better(candidate: Candidate, *_: object) -> Candidate:
        centred.append(candidate)
        return candidate

    monkeypatch.setattr(accepting, "centred", better)
    one._missed.seeds.append((3, 11.0))
    assert one._centred(field.candidates[0], trials) == field.candidates[0]
    assert centred == []
    one._missed.seeds.clear()
    assert one._centred(field.candidates[0], trials) == field.candidates[0]
    assert centred == field.candidates


def test_a_candidate_is_refused_if_another_test_gets_worse(monkeypatch: pytest.MonkeyPatch) -> None:
    one, field, _trials = examiner(["good"], monkeypatch)
    monkeypatch.setattr(accepting, "beside", lambda *_: Beside((), ("test_b earns less",), 7))
    found = one._on_fresh_seeds(field.candidates[0])
    assert isinstance(found, Tried)
    assert (found.reason, one.lost, one.refused.reason) == (
        "another test gets worse", ("test_b earns less",), "another test gets worse"
    )  # fmt: skip
    (drifted, tested) = len(found.totals), one.spent - 7
    assert tested >= drifted > 0
    monkeypatch.setattr(accepting, "beside", lambda *_: Beside(("test_b as recorded",), (), 7))
    one.spent = 0
    good = one._on_fresh_seeds(field.candidates[0])
    assert isinstance(good, Accepted)
    assert (good.beside.held, one.spent) == (("test_b as recorded",), good.acceptance.episodes + 7)


def test_report_shows_the_repair_in_the_old_world(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    one, field, _ = examiner(["bad as designed"], monkeypatch, permanent=True)
    monkeypatch.setattr(accepting, "firing", lambda *_: ())
    found = one._on_fresh_seeds(field.candidates[0])
    assert isinstance(found, Accepted)
    assert [outcome.total for outcome in found.acceptance.nominal] == [4.0] * OLD_WORLD
    assert one.spent == found.acceptance.episodes + OLD_WORLD
    one, field, _ = examiner(["good"], monkeypatch)
    found = one._on_fresh_seeds(field.candidates[0])
    assert isinstance(found, Accepted)
    assert one.spent == found.acceptance.episodes


@pytest.mark.parametrize(
    ("reason", "totals", "expected"),
    [
        ("gain too small", (1.0, 2.9), "worse than unrepaired"),
        ("gain too small", (1.0, 3.0), "gain too small"),
        ("fails too often", (0.0, 0.0), "fails too often"),
    ],
)
def test_repair_that_earns_less_is_reported(
    monkeypatch: pytest.MonkeyPatch, reason: Any, totals: tuple[float, ...], expected: str
) -> None:
    one, _, _ = examiner(["good"], monkeypatch)
    assert one.order.goal.online == DRIFTED == 2.0
    assert one._named(reason, totals) == expected


def test_waiting_candidates_are_reported_as_untested(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    one, field, _ = examiner(["good", "good", "good"], monkeypatch)
    one.waiting = [*field.candidates]
    one.tested = accepting.MOST
    assert one._of_those_waiting() is None
    assert [(each.candidate, each.reason) for each in one.tried] == [
        (candidate, "never tested") for candidate in field.candidates
    ]
    assert (one.waiting, one.refused.reason) == ([], "never tested")
    one.turns = 2  # another search may use as many tests again
    one.waiting = [*field.candidates]
    found = one._of_those_waiting()
    assert isinstance(found, Accepted)
    assert found.candidate == field.candidates[0]
    assert one.waiting == field.candidates[1:]


@pytest.mark.parametrize(
    ("tested", "screened", "turns", "over"),
    [
        (5, 0, 1, True),
        (4, 19, 1, False),
        (0, 20, 1, True),
        (9, 39, 2, False),
        (10, 0, 2, True),
        (0, 40, 2, True),
    ],
)
def test_search_ends_after_five_tests(
    monkeypatch: pytest.MonkeyPatch, tested: int, screened: int, turns: int, over: bool
) -> None:
    one, field, _ = examiner(["good"], monkeypatch)
    one.tested, one.turns = tested, turns
    for _ in range(screened):
        one.ledger.enter(Tried(field.candidates[0], "gain too small", (), fresh=True))
    assert one._exhausted() is over


def test_a_plainer_candidate_that_waits_is_tested_first(monkeypatch: pytest.MonkeyPatch) -> None:
    one, field, trials = examiner(["good", "good"], monkeypatch)
    plain, odd = field.candidates
    oddness = {plain.mutations: 1.0, odd.mutations: 2.0}
    monkeypatch.setattr(accepting, "oddness", lambda mutations: oddness[mutations])
    one.waiting = [plain]
    found = one._examined(odd, trials)
    assert isinstance(found, Accepted)
    assert (found.candidate, one.waiting) == (plain, [])
    one, field, trials = examiner(["good", "good"], monkeypatch)
    oddness[plain.mutations] = 2.0
    one.waiting = [plain]
    found = one._examined(odd, trials)
    assert isinstance(found, Accepted)
    assert (found.candidate, one.waiting) == (odd, [plain])


# Other values


@pytest.mark.parametrize("breaks", [False, True])
def test_unwritable_value_fails_everywhere(breaks: bool) -> None:
    pairs = tuple(Pair(seed, 1.0) for seed in range(5))
    goal = Goal(pairs, near=8.0, enough=9.0, online=1.0)
    asked: list[int] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        asked.append(seed)
        if breaks:
            raise RepairError("odd")
        return Outcome(9.0, passed=True)

    trials = Trials(run, 100)
    trials.misses[3] = 5
    trials.misses[1] = 2
    missed = Missed()
    refused, other = (Candidate((Mutation(operand(1, "x", 2.0), by),), ALWAYS) for by in (2.0, 3.0))
    missed.few[refused] = [(7, 8.5)]
    mutants: Any = SimpleNamespace(order=SimpleNamespace(goal=goal))
    others = Others(mutants, None, missed)  # type: ignore[arg-type]
    assert others._reaches(other, trials) is not breaks
    assert asked == [0]
    asked.clear()
    assert others._holds(other, trials) is not breaks
    assert asked == ([3] if breaks else [3, 1])  # the hardest first; the outcome on seed 0 is known
    assert KNOWN == 3
    asked.clear()
    assert others._mends(other, refused, trials) is not breaks
    assert asked == [7]


# The phases


class Phases:
    """The searches of a repair in place of the real ones."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, accepts: int | None, interrupts: int | None) -> None:
        self.log: list[Any] = []

        def search(
            mutants: Any, method: str, searched: Any, examiner: Any, purse: Any, found: Any, watch: Any
        ) -> None:
            number = sum(one[0] == "search" for one in self.log)
            self.log.append(("search", method, searched, purse.episodes, purse.seconds))
            purse.spent += 10
            if number == accepts:
                found.accepted = "accepted"
            found.interrupted = number == interrupts

        def concluded(mutants: Any, examiner: Any, found: Any, watch: Any) -> Any:
            self.guards = examiner.guards
            return found

        monkeypatch.setattr(repair, "_enrich", lambda *_: self.log.append(("enrich",)))
        monkeypatch.setattr(repair, "_search", search)
        monkeypatch.setattr(repair, "_restructure", lambda *given: self.log.append(("structure", given[4])))
        monkeypatch.setattr(repair, "_rank", lambda *given: self.log.append(("rank", given[2])))
        monkeypatch.setattr(repair, "_concluded", concluded)
        monkeypatch.setattr(repair.strategies, "evidence", lambda _: "hints")
        monkeypatch.setattr(repair.candidates, "candidate_guards", lambda hints: (ALWAYS, Guard((WET,))))
        monkeypatch.setattr(repair.candidates, "telling", lambda guards, hints, most: guards[-1:])
        for name in ("Mutants", "Watch"):
            monkeypatch.setattr(repair, name, lambda of: SimpleNamespace(order=of))
        monkeypatch.setattr(
            repair, "Examiner", lambda mutants, guards: SimpleNamespace(mutants=mutants, guards=guards)
        )

    def run(self, permanent: bool = False, **options: Any) -> Any:
        usual = {
            "budget": 60, "seconds": 5.0, "searches": ("sweep", "halving"), "structure": True, "localize": "top",
        }  # fmt: skip
        of: Any = SimpleNamespace(options=SimpleNamespace(**usual | options), permanent=permanent)
        return repair.repair(of)

    def names(self) -> list[str]:
        return [one[0] for one in self.log]


def test_structural_changes_follow_if_nothing_is_accepted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    phases = Phases(monkeypatch, None, None)
    found = phases.run()
    wet = (Guard((WET,)),)
    assert phases.log == [
        ("enrich",),
        ("search", "sweep", wet, 60, 5.0),
        ("search", "halving", wet, 60, 5.0),
        ("structure", wet),
    ]
    assert (found.episodes, phases.guards) == (20, (ALWAYS, *wet))


@pytest.mark.parametrize(
    ("accepts", "interrupts", "options", "expected"),
    [
        (0, None, {}, ["search", "search"]),
        (0, None, {"localize": "full"}, ["search", "search", "rank"]),
        (None, 0, {"localize": "full"}, ["search"]),
        (None, 1, {}, ["search", "search"]),
        (None, None, {"structure": False}, ["search", "search"]),
        (None, None, {"localize": "full", "searches": ("sweep",)}, ["search", "structure", "rank"]),
    ],
)
def test_interrupted_search_ends_without_a_ranking(
    monkeypatch: pytest.MonkeyPatch, accepts: Any, interrupts: Any, options: Any, expected: list[str]
) -> None:
    phases = Phases(monkeypatch, accepts, interrupts)
    phases.run(**options)
    assert phases.names() == ["enrich", *expected]
    if expected[-1] == "rank":
        assert phases.log[-1] == ("rank", Guard((WET,)))


def test_a_permanent_drift_needs_no_condition(monkeypatch: pytest.MonkeyPatch) -> None:
    phases = Phases(monkeypatch, None, None)
    phases.run(permanent=True)
    assert phases.guards == (ALWAYS,)


def test_sites_of_the_slices_come_first() -> None:
    def step(name: str) -> Any:
        site = SiteId("node", "run", name, 0)
        return SimpleNamespace(
            site=site, span=Span("node.py", 4, 1, 4, 9), code=name, dependence="data", role="stored"
        )

    ranked = SimpleNamespace(site=SimpleNamespace(id=str(step("b").site)), score=0.5)
    a, b, late, config = (step(name) for name in ("a", "b", "late", "config"))
    analysis = SimpleNamespace(
        sites=(a, b),
        deciding=(late,),
        timing=(step("timing"),),
        configuring={1: (config, 0)},
        making={2: (a, 0)},
    )
    of: Any = SimpleNamespace(comparison=SimpleNamespace(culprits=(ranked,)), analysis=analysis)
    found = repair._ranked(of, {str(late.site): (), str(config.site): ()})
    assert [(place.id, score) for place, score in found] == [
        (ranked.site.id, 0.5),
        (str(a.site), 0.0),
        (str(late.site), 0.0),
        (str(config.site), 0.0),
    ]
    assert (found[1][0].path, found[1][0].line, found[1][0].code) == ("node.py", 4, "a")
    assert [place.id for place, _ in repair._ranked(of, {})] == [ranked.site.id, str(a.site)]


def test_tenth_of_the_last_phase_is_for_examinations(monkeypatch: pytest.MonkeyPatch) -> None:
    budgets: list[int] = []
    trials = Trials(lambda *_: Outcome(1.0, passed=True), 60, limit=60)

    class Search:
        def __init__(self, *_: object) -> None:
            budgets.append(trials.budget)

        def candidates(self) -> Any:
            return iter(())

        def effects(self) -> dict[str, Any]:
            return {}

    def first(_: object, trials: Trials) -> None:
        with trials.granting(90):
            budgets.append(trials.budget)

    monkeypatch.setattr(repair, "Structures", Search)
    purse: Any = SimpleNamespace(phase=lambda *_: trials, settle=lambda _: None)
    mutants: Any = SimpleNamespace(order=SimpleNamespace(goal=None))
    one: Any = SimpleNamespace(first=first, turns=1)
    repair._restructure(mutants, one, repair._Findings(), None, (ALWAYS,), purse)  # type: ignore[arg-type]
    assert budgets == [54, 60]
