"""What a repair reports about its edits."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Conjunct, Edit, Guard, Repair
from pytest_tarl.patching.constant_definitions import Place
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.repairing import delivering
from pytest_tarl.repairing.delivering import (
    _constants,
    _designed_and_repaired,
    _edit,
    _edits,
    _recorded,
    _verify,
    attempts,
    withheld,
)
from pytest_tarl.repairing.ledger import Refused, Tried
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate
from pytest_tarl.sensors import Sensor
from tests.plugin.searching.test_search import operand

NO_ORDER: Any = None  # edits of constants need no order


def test_uses_of_one_definition_share_its_edit() -> None:
    low = replace(operand(5, "LIMIT", 1.0), definition=operand(1, "1.0", 1.0).span)
    high = replace(low, span=replace(low.span, column=low.span.column + 9))
    place = Place("node.py", 8, 11, 1, "LIMIT", 1.0)
    shared = Candidate((Mutation(low, 2.0, place), Mutation(high, 2.0, place)), ALWAYS)
    assert len(_edits(NO_ORDER, shared)) == 1
    apart = Candidate((Mutation(low, 2.0), Mutation(high, 2.0)), ALWAYS)
    assert len(_edits(NO_ORDER, apart)) == 2


def numeric(name: str, low: float, high: float) -> Conjunct:
    return Conjunct(Sensor(name, topic=f"/{name}", field="data", low=0, high=10, bins=5), low, high)


def order(**changed: Any) -> Any:
    sample = SimpleNamespace(test="t.py::test", topics={})
    usual = {"permanent": False, "fixture": sample, "recorded": None, "drift": "mud"}
    return SimpleNamespace(**{**usual, **changed})


GAIN, EAGER = operand(3, "2.0", 2.0), operand(5, "True", True)
UNKNOWN = replace(operand(6, "self.kp", 1.0), value=None, definition=None)
NAMED = replace(operand(7, "LIMIT", 4.0), definition=operand(1, "4.0", 4.0).span)


def test_constants_are_named_where_they_are_defined() -> None:
    form: Any = SimpleNamespace()
    candidate = Candidate((Mutation(GAIN, 3.0), Mutation(NAMED, 0.5), Mutation(EAGER, 1, form=form)), ALWAYS)
    assert list(_constants(candidate)) == ["node.py:3 column 5", "node.py:1 column 5"]
    assert list(_constants(Candidate((Mutation(UNKNOWN, 2.0),), ALWAYS))) == ["node.py:6 column 5"]


def test_edits_have_the_new_value_or_a_factor() -> None:
    place = Place("params.yaml", 8, 11, 3, "limit", 1.0)
    assert _edit(NO_ORDER, Mutation(GAIN, 0.1 + 0.2)) == Edit("node.py", 3, "2.0", 0.3)
    assert _edit(NO_ORDER, Mutation(UNKNOWN, 1.5)) == Edit("node.py", 6, "self.kp", 1.5, factor=True)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(delivering, "effective_value", lambda _: 7.0)
        assert _edit(NO_ORDER, Mutation(NAMED, 2.0, place)) == Edit("params.yaml", 3, "limit", 7.0)
        patched.setattr(delivering, "form_words", lambda *_: "limit the speed")
        form: Any = SimpleNamespace()
        assert _edit(NO_ORDER, Mutation(GAIN, 2.0, form=form)) == Edit(
            "node.py", 3, "2.0", 7.0, what="limit the speed"
        )


def test_reward_of_a_repair_as_designed_is_described() -> None:
    told = _designed_and_repaired(order(permanent=True), [3.0])
    assert (
        told
        == "old world and repaired: 3.00 per episode, 1 episodes; not required, because the drift is permanent"
    )
    assert _designed_and_repaired(order(), [3.0]).startswith(
        "designed and repaired: 3.00 per episode, 1 episodes, on"
    )
    assert _designed_and_repaired(order(), []).endswith("because the condition never holds there")


def test_tested_refused_candidate_has_its_mean(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(delivering, "_guard", lambda *_: "wet")
    candidate = Candidate((Mutation(GAIN, 3.0),), ALWAYS)
    assert withheld(order(), Refused(None, "budget"), ()) == Repair(False, "", (), reason="budget")
    edits = (Edit("node.py", 3, "2.0", 3.0),)
    assert withheld(order(), Refused(candidate, "gain too small"), ()) == Repair(
        False, "wet", edits, reason="gain too small"
    )
    found = withheld(order(), Refused(candidate, "gain too small", 4.5, 6), ())
    assert (found.accepted, found.mean, found.episodes) == (False, 4.5, 6)


def test_attempts_have_the_mean_of_their_episodes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(delivering, "_guard", lambda *_: "")
    candidate = Candidate((Mutation(GAIN, 3.0),), ALWAYS)
    one, other = attempts(
        order(),
        [Tried(candidate, "gain too small", (1.0, 4.0), fresh=True), Tried(candidate, "never tested", ())],
    )
    assert (one.reason, one.mean, one.episodes, one.fresh) == ("gain too small", 2.5, 2, True)
    assert (other.reason, math.isnan(other.mean), other.episodes, other.fresh) == (
        "never tested",
        True,
        0,
        False,
    )


def test_condition_without_variables_is_described_by_sensors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def unable(*_: Any) -> str:
        raise RepairError("no variable")

    monkeypatch.setattr(delivering, "guard_text", unable)
    candidate = Candidate((), Guard((numeric("depth", 2.0, math.inf), numeric("speed", -1.0, 0.5))))
    told = delivering._guard(order(analysis=None), candidate)
    assert told == "2 <= depth <= inf and -1 <= speed <= 0.5"


def test_the_recording_is_named_by_its_digest(tmp_path: Path) -> None:
    assert _recorded(order()) == []
    path = tmp_path / ".tarl" / "a.npz"
    path.parent.mkdir()
    path.write_bytes(b"abc")
    (told,) = _recorded(order(recorded=path, root=tmp_path))
    assert told == "fixture: ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad .tarl/a.npz"


def verified(
    monkeypatch: pytest.MonkeyPatch, *mutations: Mutation, sources: tuple[str, ...] = ("node.py",)
) -> Any:
    """Return the file and the lines that may differ, for each checked file."""
    seen: Any = []
    monkeypatch.setattr(delivering, "nothing_lost", lambda shown, _, __, lines: seen.append((shown, lines)))
    given: Any = SimpleNamespace(
        root=Path("/r"), analysis=SimpleNamespace(sources=dict.fromkeys(sources, "old"))
    )
    _verify(given, Candidate(mutations, ALWAYS), {Path("/r/node.py"): "new", Path("/r/params.py"): "new"})
    return seen


def test_only_the_lines_of_the_changes_may_differ(monkeypatch: pytest.MonkeyPatch) -> None:
    place = Place("params.py", 8, 11, 6, "LIMIT", 1.0)
    long = replace(GAIN, span=replace(GAIN.span, end_line=5))
    assert verified(monkeypatch, Mutation(long, 3.0)) == [("node.py", {3, 4, 5})]
    both = verified(
        monkeypatch,
        Mutation(GAIN, 3.0),
        Mutation(NAMED, 0.5, place),
        sources=("node.py", "params.py", "a.py"),
    )
    assert both == [("node.py", {3}), ("params.py", {6})]
    partner = replace(GAIN.span, line=9, end_line=9)
    form: Any = SimpleNamespace(partner=partner)
    assert verified(monkeypatch, Mutation(GAIN, 3.0, form=form)) == [("node.py", {3, 9})]
    alone: Any = SimpleNamespace(partner=None)
    assert verified(monkeypatch, Mutation(GAIN, 3.0, form=alone)) == [("node.py", {3})]
