"""Rules of --fail-if, portions of missions, and rows of statements, worked out by hand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pyarrow")

from pytest_tarl.fleet import ingest, partitions
from pytest_tarl.fleet.mission_rows import Row, _cells, _statements
from pytest_tarl.fleet.question import Answer
from pytest_tarl.learning.tables import END, START, Chain, Edges, ListSample, Sample, Visits

NOTHING: Any = SimpleNamespace(drifted=(), below=())
NONE = np.zeros(0, np.int64)


def meets(*results: str | None, onsets: Any = NOTHING, robots: Any = NOTHING) -> set[str]:
    """Return the rules that an answer with these verdicts meets; None is a group without a verdict."""
    verdicts = (None if one is None else SimpleNamespace(result=one) for one in results)
    groups = [SimpleNamespace(verdict=one) for one in verdicts]
    answer: Any = SimpleNamespace(groups=groups, onsets=onsets, robots=robots)
    return {rule for rule in ("degraded", "drifted", "changed", "robot") if Answer.meets(answer, rule)}


def test_verdicts_of_groups_decide_about_the_rules_degraded_and_drifted() -> None:
    assert meets("degraded", "no difference", None) == {"degraded", "drifted"}
    assert meets(None, "drifted") == {"drifted"}
    assert meets("no difference", None) == meets(None) == meets() == set()


@pytest.mark.parametrize("name", ["drifted", "below"])
def test_onsets_and_robots_decide_about_the_rules_changed_and_robot(name: str) -> None:
    some = SimpleNamespace(**{**vars(NOTHING), name: ("r1",)})
    assert meets(onsets=some) == {"changed"}
    assert meets(robots=some) == {"robot"}


@pytest.mark.parametrize(("entries", "sizes"), [(9, [3, 3, 1]), (8, [2, 2, 2, 1]), (1, [1] * 7), (99, [7])])
def test_missions_are_scored_in_portions_that_fit_into_memory(
    entries: int, sizes: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """With two recorded cells, a mission has three entries: one for each cell, and one for all others."""
    numbers = np.arange(7)
    ends = {"passed": numbers > 2, "total": numbers * 1.5, "steps": numbers + 1}
    rows = partitions.Transitions(
        numbers, numbers % 2, np.full(7, END), np.ones(7, np.int64), numbers.astype(float)
    )
    scored: list[tuple[list[int], list[float]]] = []

    def binned(_: object, sample: Any) -> Any:
        scored.append((sample.chain.cell.tolist(), sample.total.tolist()))
        return sample.total[:, None]

    monkeypatch.setattr(partitions, "ENTRIES", entries)
    monkeypatch.setattr(partitions.dataset, "columns", lambda *_: {"cell": [], "next_cell": []})
    monkeypatch.setattr(partitions, "_names", lambda _: set())
    monkeypatch.setattr(partitions, "_rows", lambda *_: rows)
    monkeypatch.setattr(partitions, "_results", lambda *_: ends)
    monkeypatch.setattr(partitions, "binned", binned)
    wanted = [partitions.Wanted("c", "m", np.empty(0, np.uint64), numbers)]
    scale: Any = SimpleNamespace(cells=((0,), (1,)))
    where: Any = None
    found = partitions.scored(where, wanted, scale)
    assert [len(totals) for _, totals in scored] == sizes
    assert [cell for cells, _ in scored for cell in cells] == [0, 1, 0, 1, 0, 1, 0]
    assert found.bins[:, 0].tolist() == [int(1.5 * n) for n in range(7)]
    assert found.new == ()


def test_new_missions_are_written_once_enough_of_them_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[list[int]] = []

    def write(self: Any) -> None:
        written.append([row.mission for day in sorted(self.rows) for row in self.rows[day]])
        self.rows.clear()
        self.waiting = 0

    nothing: Any = None
    writer = ingest._Writer(nothing, "1", nothing, nothing, b"")
    monkeypatch.setattr(ingest, "TOGETHER", 3)
    monkeypatch.setattr(ingest._Writer, "write", write)
    monkeypatch.setattr(ingest._Writer, "holds", lambda *_: False)
    monkeypatch.setattr(ingest._Writer, "_held", lambda self, day: self.known.setdefault(day, {}))
    some: Any = [SimpleNamespace(date=f"day {n % 2}", mission=n, robot="r1") for n in range(6)]
    assert [writer.add(some[:2]), writer.add([*some[:2], some[2]]), writer.add(some)] == [2, 1, 3]
    assert written == [[0, 2, 1], [4, 3, 5]]


def test_columns_that_have_the_wanted_type_are_not_copied() -> None:
    column: Any = SimpleNamespace(to_numpy=lambda: kept)
    kept = np.arange(3, dtype=np.int64)
    assert partitions._values(column, np.int64) is kept
    assert partitions._values(column, np.float64).tolist() == [0.0, 1.0, 2.0]


def mission(number: int, cells: tuple[tuple[int, ...], ...], visited: list[tuple[int, int, int]]) -> Row:
    """Return a mission whose list of two sites has visits (cell, site, count); None for the cell is the start."""
    states = [START] + [1 + 2 * cell + site for cell, site, _ in visited]
    counts = np.array([1, *(count for *_, count in visited)])
    sums = (counts * 2.0, counts * 3.0, counts * 4.0, counts * 5.0)
    visits = Visits(np.zeros(len(states), np.int64), np.array(states), counts, *sums)
    one = ListSample(2, Edges(NONE, NONE, NONE, NONE), visits, np.zeros((1, 2)))
    chain = Chain(
        np.zeros(2, np.int64), np.array([0, len(cells) - 1]), np.array([len(cells) - 1, END]),
        np.array([4, 1]), np.array([0.5, 0.25]), np.zeros((2, 0)),
    )  # fmt: skip
    sample = Sample(cells, (number,), np.array([True]), np.zeros(1), np.ones(1, int), (), chain, (one,))
    return Row("r1", "hall", 0.0, sample)


ROWS = [mission(7, ((0,), (3,)), [(0, 1, 2), (1, 0, 5)]), mission(8, ((3,), (4,)), [(1, 1, 6)])]


def test_a_row_of_a_statement_has_the_cell_and_the_sums_of_its_visits() -> None:
    """The visit to the start of the mission is not a row."""
    lists: Any = [
        SimpleNamespace(source="/scan", sink="/cmd", sites=[SimpleNamespace(id="a"), SimpleNamespace(id="b")])
    ]
    found = _statements(ROWS, lists)
    assert found["mission"].tolist() == [7, 7, 8]
    assert found["cell"].to_pylist() == ["0", "3", "4"]
    assert found["statement"].to_pylist() == ["b", "a", "b"]
    assert (found["source"].to_pylist(), found["sink"].to_pylist()) == (["/scan"] * 3, ["/cmd"] * 3)
    assert found["count"].tolist() == [2, 5, 6]
    sums = [found[name].tolist() for name in ("reward", "scaled", "reward_squared", "scaled_squared")]
    assert sums == [[2.0 * n, 5.0 * n, 6.0 * n] for n in (2, 3, 4, 5)]


def test_a_row_of_a_cell_has_its_transition_and_null_at_the_end_of_the_mission() -> None:
    found = _cells(ROWS)
    assert found["mission"].tolist() == [7, 7, 8, 8]
    assert found["cell"].to_pylist() == ["0", "3", "3", "4"]
    assert found["next_cell"].to_pylist() == ["3", None, "4", None]
    assert found["count"].tolist() == [4, 1, 4, 1]
    assert found["reward"].tolist() == [0.5, 0.25, 0.5, 0.25]


def test_missions_without_visits_have_empty_columns_of_the_right_types() -> None:
    lists: Any = [SimpleNamespace(source="/scan", sink="/cmd", sites=[])]
    found = _statements([mission(7, ((0,), (3,)), [])], lists)
    assert (found["count"].dtype, found["reward"].dtype) == (np.int64, np.float64)
    assert [len(column) for column in found.values()] == [0] * len(found)
