"""The phases of a repair and its final report, with searches whose results are fixed here."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.model import Band, Conjunct, Guard, OperandEffect
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.repairing import repair
from pytest_tarl.repairing.budget import Purse
from pytest_tarl.repairing.incumbent import Watch
from pytest_tarl.repairing.ledger import Refused, Tried
from pytest_tarl.repairing.mission_pairs import NO_SIGNS, Signs
from pytest_tarl.repairing.ranges import Ranged
from pytest_tarl.repairing.repair import (
    _chief,
    _ended,
    _Findings,
    _notes,
    _of_the_range,
    _rank,
    _restructure,
    _search,
)
from pytest_tarl.repairing.structural import Structures
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.sensors import Sensor
from tests.plugin.searching.test_search import operand

WET = Guard((Conjunct(Sensor("wet", topic="/wet", field="data"), 1, 1),))
GOAL = Goal((Pair(0, 0.0),), near=9.0, enough=9.0, online=0.0)
ONE, TWO = (Candidate((Mutation(operand(3, "2.0", 2.0), value),), ALWAYS) for value in (5.0, 1.0))
EFFECTS = {"site": [OperandEffect("2.0", 2.0, 5.0, 3.0)]}


def order(**changes: Any) -> Any:
    options = {"budget": 60, "seconds": None, "structure": False, "seed": 0}
    every = {"drift": "mud", "goal": GOAL, "progress": lambda *_: None, "options": SimpleNamespace(**options)}
    return SimpleNamespace(**every | changes)


def mutants(of: Any = None) -> Any:
    return SimpleNamespace(order=of or order(), run=lambda *_: Outcome(10.0, True), foresee=lambda *_: None)


class Search:
    """A search that runs one episode and yields a candidate, or is interrupted."""

    def __init__(self, trials: Any, effects: Any = EFFECTS, interrupted: bool = False) -> None:
        self.trials, self.found, self.interrupted = trials, effects, interrupted

    def candidates(self) -> Iterator[Candidate]:
        self.trials(ONE, 0)
        if self.interrupted:
            raise KeyboardInterrupt
        yield ONE
        self.trials(TWO, 0)

    def effects(self) -> Any:
        return self.found


class Examiner:
    """An examiner that accepts the first candidate, or none."""

    def __init__(self, accepts: bool = True, **parts: Any) -> None:
        self.accepts = accepts
        every = {
            "refused": Refused(None, "budget"),
            "lost": (),
            "cut": False,
            "tested": 0,
            "tried": (),
            "ranged": {},
        }
        self.__dict__ |= every | {"placing": SimpleNamespace(notes=lambda _: ())} | parts

    def first(self, candidates: Iterator[Candidate], trials: Any) -> Any:
        return next(candidates) if self.accepts else [*candidates] and None


def searched(
    monkeypatch: pytest.MonkeyPatch,
    examiner: Any,
    found: _Findings,
    method: str = "halving",
    structure: bool = False,
    **search: Any,
) -> tuple[Any, Purse]:
    """Run one search; return its trials and the budget."""
    made: list[Any] = []

    def strategy(_: Any, name: str, guards: Any, trials: Any, _more: Any) -> Search:
        made.append(trials)
        assert (name, guards) == (method, (ALWAYS,))
        return Search(trials, **search)

    monkeypatch.setattr(repair.strategies, "strategy", strategy)
    of = order()
    of.options.structure = structure
    purse = Purse(60)
    _search(mutants(of), method, (ALWAYS,), examiner, purse, found, Watch(of))
    return made[0], purse


def test_first_accepted_candidate_is_the_repair(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = _Findings()
    trials, purse = searched(monkeypatch, Examiner(), found)
    assert (found.accepted, found.effects, found.method) == (ONE, EFFECTS, "halving")
    assert (purse.spent, trials.budget, trials.reserve) == (1, 60, 0)
    assert [(one.method, one.totals) for one in found.curves] == [("halving", (10.0,))]
    searched(monkeypatch, Examiner(), found, "bayes", effects={"other": []})
    assert (found.accepted, found.effects, found.method) == (ONE, EFFECTS, "halving")
    assert [one.method for one in found.curves] == ["halving", "bayes"]


def test_effects_come_from_the_first_effective_search(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = _Findings()
    searched(monkeypatch, Examiner(accepts=False), found, effects={})
    _, purse = searched(monkeypatch, Examiner(accepts=False), found, "bayes")
    assert (found.accepted, found.effects, found.method, purse.spent) == (None, EFFECTS, "bayes", 2)


def test_an_interrupted_search_keeps_its_curve_and_its_episodes(monkeypatch: pytest.MonkeyPatch) -> None:
    found = _Findings()
    _, purse = searched(monkeypatch, Examiner(), found, interrupted=True)
    assert (found.interrupted, found.accepted, len(found.curves), purse.spent) == (True, None, 1, 1)
    found.take(replace(purse, late=True))
    found.take(replace(purse, late=False))
    assert (found.episodes, found.late) == (2, True)


def test_a_sweep_leaves_episodes_to_structural_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    trials, _ = searched(monkeypatch, Examiner(), _Findings(), "sweep", structure=True)
    assert trials.budget == round(repair.CONSTANTS * 60) < 60
    assert trials.reserve == round(repair.RESERVE * 60) > 0
    assert trials.worth is GOAL
    other, _ = searched(monkeypatch, Examiner(), _Findings(), "halving", structure=True)
    assert (other.budget, other.reserve) == (60, 0)


def restructured(
    monkeypatch: pytest.MonkeyPatch,
    early: Any,
    late: bool = False,
    accepts: bool = True,
    structural: bool = True,
    **search: Any,
) -> tuple[Any, Any, Any]:
    """Run the structural search after a search of constants; return the findings, its arguments and the examiner."""
    monkeypatch.setattr(repair, "_structural", lambda _: structural)
    made: list[Any] = []

    class Structure(Search):
        def __init__(self, _: Any, guards: Any, trials: Any, effects: Any, signs: Any) -> None:
            super().__init__(trials, **search)
            made.append((guards, trials, effects, signs))

    monkeypatch.setattr(repair, "Structures", Structure)
    found = _Findings()
    found.early, found.effects = early, {"old": []}
    examiner: Any = Examiner(accepts, turns=1)
    of = order()
    purse = Purse(60, late=late)
    _restructure(mutants(of), examiner, found, Watch(of), (ALWAYS,), purse)
    assert found.structure == (purse.spent if structural else 0)
    return found, made[0], examiner


def before() -> Any:
    """Return structural changes tried within the search, with the outcome of one episode."""
    trials = Trials(lambda *_: Outcome(3.0, True), 10)
    trials(ONE, 0)
    return SimpleNamespace(trials=trials, signs=lambda _: Signs({"here": {}}))


def test_structural_search_gets_earlier_symptoms(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found, (guards, trials, effects, signs), examiner = restructured(monkeypatch, before())
    assert (guards, effects, signs) == (_chief((ALWAYS,)), {"old": []}, Signs({"here": {}}))
    assert trials.spent == 0  # the episode is known
    assert (found.accepted, found.effects, found.method) == (ONE, EFFECTS, "structure")
    assert [one.method for one in found.curves] == ["structure"]
    assert examiner.turns == 2  # it may use as many tests as the search before


def test_constant_from_a_structural_search_is_no_structure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found, _, _ = restructured(monkeypatch, None, structural=False)
    assert (found.accepted, found.effects, found.method, found.structure) == (ONE, {"old": []}, "", 0)


def test_structural_search_without_a_predecessor_has_no_symptoms(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert restructured(monkeypatch, before(), late=True)[1][3] == NO_SIGNS
    found, (_, trials, _, signs), _ = restructured(monkeypatch, None)
    assert (signs, trials.spent, found.structure) == (NO_SIGNS, 1, 1)


def test_a_structural_search_without_success_keeps_the_effects(monkeypatch: pytest.MonkeyPatch) -> None:
    found, _, _ = restructured(monkeypatch, None, accepts=False)
    assert (found.accepted, found.effects, found.structure, found.interrupted) == (
        None,
        {"old": []},
        2,
        False,
    )
    found, _, _ = restructured(monkeypatch, None, interrupted=True)
    assert (found.accepted, found.interrupted, found.structure, len(found.curves)) == (None, True, 1, 1)


def test_structural_changes_use_no_or_the_first_condition() -> None:
    assert _chief((ALWAYS, WET)) == (ALWAYS,)
    assert _chief((WET, ALWAYS)) == (ALWAYS, WET)


class Ranks(Search):
    """A ranking that runs one episode."""

    def run(self) -> None:
        next(self.candidates())


def test_a_ranking_replaces_effects_if_it_has_any(monkeypatch: pytest.MonkeyPatch) -> None:
    for effects, expected in ((EFFECTS, EFFECTS), ({}, {"old": []})):
        made: list[Any] = []

        def ranking(_: Any, guard: Any, trials: Any, effects: Any = effects, made: Any = made) -> Ranks:
            made.append(guard)
            return Ranks(trials, effects)

        monkeypatch.setattr(repair.strategies, "ranking", ranking)
        found = _Findings(effects={"old": []}, method="sweep")
        of = order()
        _rank(mutants(of), found, ALWAYS, Watch(of))
        assert (found.effects, found.method, found.episodes, made) == (expected, "ranking", 1, [ALWAYS])
        assert found.ranking is not None


def test_an_interrupted_ranking_keeps_its_curve_and_its_episodes(monkeypatch: pytest.MonkeyPatch) -> None:
    guards: list[Any] = []

    class Interrupted(Ranks):
        def run(self) -> None:
            super().run()
            raise KeyboardInterrupt

    def ranking(_: Any, guard: Any, trials: Any) -> Ranks:
        guards.append(guard)
        return Interrupted(trials, EFFECTS)

    monkeypatch.setattr(repair.strategies, "ranking", ranking)
    accepted: Any = SimpleNamespace(candidate=SimpleNamespace(guard=WET))
    found = _Findings(accepted=accepted, episodes=5)
    of = order()
    _rank(mutants(of), found, ALWAYS, Watch(of))
    assert (found.interrupted, found.accepted, found.episodes, found.effects) == (True, accepted, 6, EFFECTS)
    assert guards == [WET]  # the guard of the repair
    assert [(one.method, one.totals) for one in found.curves] == [("ranking", (10.0,))]


@pytest.mark.parametrize(
    ("interrupted", "late", "reason", "expected"),
    [
        (True, True, "budget", "interrupted"),
        (False, True, "budget", "time"),
        (False, False, "budget", "budget"),
        (False, True, "not shown", "not shown"),
    ],
)
def test_refusal_reason_states_why_the_search_ended(
    interrupted: bool, late: bool, reason: Any, expected: str
) -> None:
    examiner: Any = Examiner(refused=Refused(None, reason))
    assert _ended(examiner, _Findings(interrupted=interrupted, late=late)).reason == expected


def noted(monkeypatch: pytest.MonkeyPatch, found: _Findings, of: Any = None, **parts: Any) -> list[str]:
    monkeypatch.setattr(repair, "unnamed_modules", lambda _: ["a module"])
    monkeypatch.setattr(repair, "remarks", lambda *_: ["a remark"])
    monkeypatch.setattr(repair, "_of_the_range", lambda *_: ["a part"])
    of = of or order()
    examiner: Any = Examiner(**parts)
    return [*_notes(mutants(of), examiner, found, Watch(of))]


def test_notes_state_omissions_and_why_the_search_ended(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    placing = SimpleNamespace(notes=lambda one: [f"at {one.mutations[0].value}"] * 2)
    accepted: Any = SimpleNamespace(candidate=ONE)
    found = _Findings(accepted=accepted, structure=7, episodes=40)
    assert noted(monkeypatch, found, placing=placing, lost=("t", "t", "u"), cut=True, tested=1) == [
        "at 5.0",
        "a module",
        "a remark",
        "a part",
        "a candidate was dropped because it lowers the reward of another test: t",
        "a candidate was dropped because it lowers the reward of another test: u",
        "no constant that was tried in 33 episodes sufficed, so 7 further episodes tried structural changes",
    ]
    refused = Refused(TWO, "not shown")
    cut = "the search ended because its 60 episodes were spent: --tarl-budget 120 doubles them"
    assert noted(monkeypatch, _Findings(), placing=placing, refused=refused, cut=True, tested=1) == [
        "at 1.0",
        "a module",
        "a part",
        cut,
    ]
    for quiet in ({"cut": False, "tested": 1}, {"cut": True, "tested": 0}):
        assert cut not in noted(monkeypatch, _Findings(), **quiet)


def test_timed_out_search_names_a_sufficient_budget(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    of = order()
    of.options.seconds = 2.5
    told = noted(monkeypatch, _Findings(late=True, episodes=33), of, cut=True, tested=1)
    assert told[-1].startswith("the search ended after 2.5 s and 33 episodes; ")
    assert told[-1].endswith("use --tarl-budget 33")


def test_candidates_for_part_of_the_range_are_named_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(repair, "fits_a_part", lambda _, runs: f"{len(runs)} runs")
    of = order()
    watch = Watch(of)
    three = Candidate((Mutation(operand(9, "2.0", 2.0), 7.0),), ALWAYS)
    for candidate, runs in ((ONE, 9), (TWO, repair.NAMED_FROM), (three, repair.NAMED_FROM + 1)):
        for seed in range(runs):
            watch.saw(candidate, seed, Outcome(1.0, True))
    tried = [Tried(ONE, "not over the whole range", ()), Tried(TWO, "not shown", ())]
    ranged = {ONE: Ranged((), (Band("", 0.0, 1.0),), (Band("", 1.0, 2.0),)), TWO: Ranged()}
    examiner: Any = Examiner(tried=tried, ranged=ranged)
    assert [*_of_the_range(of, examiner, watch)] == [
        "line 3: 2.0 → 5: it works for sizes 0 to 1, but not for sizes 1 to 2",
        f"line 9: 2.0 → 7: {repair.NAMED_FROM + 1} runs",
    ]


@pytest.mark.parametrize(
    ("stronger", "parameter", "factor", "expected"),
    [
        ("larger", "gain", 0.5, True),
        ("larger", "gain", 2.0, False),
        ("smaller", "gain", 2.0, True),
        ("smaller", "gain", 0.5, False),
        ("larger", "gain", 1.0, False),
        ("larger", "gain", -0.5, False),
        ("larger", "other", 0.5, False),
        ("larger", "other", 2.0, False),
    ],
)
def test_a_template_states_which_factors_weaken_its_parameter(
    stronger: str, parameter: str, factor: float, expected: bool
) -> None:
    structures = Structures.__new__(Structures)
    one = operand(3, "2.0", 2.0)
    parameters: Sequence[Any] = [SimpleNamespace(name="gain", stronger=stronger)]
    form: Any = SimpleNamespace(parameter=parameter, template=SimpleNamespace(parameters=parameters))
    structures._found = {one: form}
    assert structures.weaker(one, factor) is expected


def test_examination_may_exceed_the_episodes_of_a_template_group(tmp_path: Path) -> None:
    structures = Structures.__new__(Structures)
    order: Any = SimpleNamespace(root=tmp_path, goal=None)
    structures.order = order
    structures._scaled = set()
    structures.trials = Trials(lambda *_: Outcome(1.0, True), budget=10, reserve=4)
    steps = structures._beyond_its_share(ONE, whole=30)
    assert next(steps) == ONE
    assert (structures.trials.budget, structures.trials.reserve) == (30, 0)
    for seed in range(3):
        structures.trials(ONE, seed)
    assert next(steps, None) is None
    assert (structures.trials.budget, structures.trials.reserve) == (13, 4)
