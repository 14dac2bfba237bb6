"""The parts of a comparison: current positions of recorded sites, tables by cell, rows to sum over, and drift sizes."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Drift, comparing
from pytest_tarl.comparing import (
    _compared,
    _current,
    _learned_tables,
    _learner,
    _paper_cells,
    _rows,
    _side,
    _sizes,
    _spread,
    _Watch,
    current_members,
)
from pytest_tarl.errors import FixtureError, RecordingError
from pytest_tarl.learning.sarsa import LEARNERS
from pytest_tarl.learning.sequential import Look
from pytest_tarl.model import Region, SitePlace, TaintList
from pytest_tarl.seeds import episode_seeds

CELLS = ((1,), (2,), (4,), (7,))


def place(name: str, line: int = 3) -> SitePlace:
    return SitePlace(name, "node.py", line, name, "data", "compute")


def listed(*names: str) -> TaintList:
    return TaintList("/a", "/b", tuple(map(place, names)))


def test_recorded_sites_get_their_current_numbers_and_positions() -> None:
    fixture: Any = SimpleNamespace(lists=(listed("a", "b"), listed("c", "a")))
    plan: Any = SimpleNamespace(places=(place("c", 9), place("a", 7)))
    assert current_members(fixture, plan) == ((1, -1), (0, 1))
    now = _current(fixture, plan)
    assert [[site.line for site in one.sites] for one in now] == [[7, 3], [9, 7]]


def test_tables_are_extended_to_the_cells_of_both_worlds() -> None:
    found = _spread(np.array([[1.0, 2.0], [3.0, 4.0]]), [(4,), (1,)], CELLS)
    assert np.array_equal(found, [[3.0, 4.0], [np.nan] * 2, [1.0, 2.0], [np.nan] * 2], equal_nan=True)
    fixture: Any = SimpleNamespace(sarsa=(np.ones((1, 1)),), sample=SimpleNamespace(cells=((2,),)))
    recorded: Any = SimpleNamespace(sample=SimpleNamespace(cells=((7,),)))
    ((before, after),) = _learned_tables(fixture, recorded, [np.full((1, 1), 5.0)], CELLS)
    assert np.flatnonzero(np.isfinite(before[:, 0])).tolist() == [1]
    assert np.flatnonzero(np.isfinite(after[:, 0])).tolist() == [3]


def test_table_has_the_cells_of_the_region_or_the_rest() -> None:
    assert _rows(Region(cells=((4,),), novel=((1,),)), ((2,),), CELLS).tolist() == [0, 2]
    assert _rows(Region(), ((2,), (7,)), CELLS).tolist() == [1, 3]
    assert _rows(Region(left=((4,),)), (), CELLS).tolist() == []


def test_paper_region_has_the_cells_of_all_lists(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(comparing, "paper_region", lambda before, _: np.array(before))
    tables: Any = [([3, 1], 0), ([1, 0], 0)]
    assert _paper_cells(tables, CELLS) == ((1,), (2,), (7,))


def test_lists_without_sites_are_left_out() -> None:
    tables = [(np.ones((4, 2)), np.zeros((4, 2))), (np.ones((4, 0)), np.ones((4, 0)))]
    (found,) = _compared([listed("a", "b"), listed()], tables, np.array([0, 2]))
    assert [(one.offline, one.online) for one in found.slices] == [(2.0, 0.0), (2.0, 0.0)]


def test_figure_has_the_drift_sizes_of_the_episodes() -> None:
    marked: Any = SimpleNamespace(drifts={"mud": Drift({"depth": Drift.range(1.0, 3.0), "kind": 2})})
    assert _sizes(marked, None, (1, 2)) == {}
    (found,) = _sizes(marked, "mud", (1, 2, 3)).values()
    assert (found.part, found.low, found.high, len(found.of["online"])) == ("depth", 1.0, 3.0, 3)
    assert len(set(found.of["online"])) == 3


def options(**given: Any) -> Any:
    usual = {"log": None, "bags": (), "episodes": None, "ONLINE_EPISODES": 50, "seed": 4, "most_looks": 3}
    return SimpleNamespace(**{**usual, **given})


def test_deployed_episodes_have_their_own_seeds() -> None:
    def side(stage: Any = None, **given: Any) -> Any:
        none: Any = None
        return _side(none, none, none, options(**given), none, stage)

    assert side().seeds == episode_seeds(4, "online", 50)
    assert side(episodes=7).seeds == episode_seeds(4, "online", 7)
    assert side(SimpleNamespace(episodes=9), episodes=7).seeds == episode_seeds(4, "online", 9)
    assert (side().looks, side().notes) == (3, ())


def test_a_log_and_bags_are_compared_once(monkeypatch: pytest.MonkeyPatch) -> None:
    marked: Any = SimpleNamespace(judge=None, requirements=None)
    none: Any = None
    monkeypatch.setattr(comparing, "read_log", lambda *_: SimpleNamespace(count=3, notes=("log",)))
    found = _side(none, none, marked, options(log="x.csv", bags=("y",)), none, None)
    assert ([*found.seeds], found.looks, found.notes) == ([0, 1, 2], 1, ("log",))
    monkeypatch.setattr(
        comparing, "bagged", lambda *_: SimpleNamespace(bags={9: "a", 5: "b"}, notes=("bag",))
    )
    found = _side(none, none, marked, options(bags=("y",)), none, None)
    assert ([*found.seeds], found.looks, found.notes) == ([9, 5], 1, ("bag",))


def test_a_comparison_uses_the_learning_rule_of_the_recording() -> None:
    def rule(recorded: str, asked: str) -> str:
        fixture: Any = SimpleNamespace(test="t", learner=recorded)
        given: Any = SimpleNamespace(learner=asked)
        return _learner(fixture, given)

    assert rule("sarsa", "") == rule("sarsa", "sarsa") == "sarsa"
    with pytest.raises(FixtureError, match="learned by 'magic', which this version"):
        rule("magic", "")
    other = next(name for name in LEARNERS if name != "sarsa")
    with pytest.raises(FixtureError, match=f"learned by sarsa, not by {other}"):
        rule("sarsa", other)


def watched(monkeypatch: pytest.MonkeyPatch, sure: set[int]) -> tuple[_Watch, list[dict[str, Any]]]:
    asked: list[dict[str, Any]] = []

    def compare(offline: Any, online: Any, **given: Any) -> Any:
        asked.append({"offline": offline, "online": online, **given})
        return online

    monkeypatch.setattr(comparing, "compare", compare)
    monkeypatch.setattr(comparing, "merge", len)
    monkeypatch.setattr(comparing, "certain", lambda found: found in sure)
    marked: Any = SimpleNamespace(total_range=(-5.0, 5.0), tolerance=0.5, sensors=("s",))
    given: Any = SimpleNamespace(alpha=0.05, seed=4)
    offline: Any = "recorded"
    return _Watch(offline, marked, given, (Look(2, 0.25), Look(4, 0.75)), 999), asked


def test_verdicts_are_checked_until_certain(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    watch, asked = watched(monkeypatch, {4})
    samples: list[Any] = []
    stops = []
    for _ in range(5):
        samples.append(SimpleNamespace(seeds=(1,), total=np.array([1.0])))
        stops.append(watch(samples))
    assert stops == [False, False, False, True, False]
    assert [look.episodes for look, _ in watch.seen] == [2, 4]
    assert [one["online"] for one in asked] == [2, 4]
    assert [one["alpha"] for one in asked] == pytest.approx([0.0125, 0.0375])
    first = asked[0]
    assert (first["offline"], first["tolerance"], first["permutations"]) == ("recorded", 0.5, 999)
    assert (first["declared"].low, first["declared"].high) == (-5.0, 5.0)
    assert asked[0]["generator"].random() == asked[1]["generator"].random()


def test_a_total_outside_its_range_ends_the_comparison(monkeypatch: pytest.MonkeyPatch) -> None:
    watch, _ = watched(monkeypatch, set())
    sample: Any = SimpleNamespace(seeds=(1,), total=np.array([6.0]))
    with pytest.raises(RecordingError, match="outside the marker's total_range"):
        watch([sample])
