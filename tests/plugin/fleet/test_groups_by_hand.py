"""The figures of a group from its missions, and the confidence that several groups share."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pyarrow")
pytest.importorskip("duckdb")
pytest.importorskip("dask")

from pytest_tarl.fleet import groups, repairs
from pytest_tarl.learning.bounds import Range, mean_of, rate
from tests.plugin.fleet.answers import fixture


def database(passed: list[int], total: list[float], names: Any = ()) -> Any:
    """Return a database that answers each query with these missions or names."""
    columns = {"passed": np.array(passed), "total": np.array(total)}
    return SimpleNamespace(columns=lambda *_: columns, names=lambda _: list(names))


@pytest.mark.parametrize(
    ("declared", "outside"),
    [(None, 0), (Range(1.0, 4.0), 0), (Range(1.5, 4.0), 1), (Range(1.5, 3.5), 2), (Range(9.0, 10.0), 4)],
)
def test_a_group_has_the_figures_of_its_missions(
    declared: Range | None, outside: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(groups, "_declared", lambda _: declared)
    totals = [1.0, 2.0, 3.0, 4.0]
    one = groups._group(database([1, 0, 1, 1], totals), replace(fixture(), stated=None), 0, ("a", 7, 4, 2))
    assert (one.values, one.missions, one.robots, one.passed) == (("a", "7"), 4, 2, 3)
    assert (one.reward, one.outside, one.compared, one.verdict) == (2.5, outside, 0, None)
    assert one.success == rate(3, 4, groups.CONFIDENCE)
    assert one.mean == mean_of(totals, groups.CONFIDENCE, None if outside else declared)


def test_the_formulas_of_each_group_are_collected() -> None:
    rows = [(0, "a", 3, 1, -0.5), (0, "b", 3, 0, 0.5), (2, "a", 1, 1, -1.0)]
    assert groups._violations(database([], [], rows)) == {
        0: (groups.Judged("a", 3, 1, -0.5), groups.Judged("b", 3, 0, 0.5)),
        2: (groups.Judged("a", 1, 1, -1.0),),
    }


@pytest.mark.parametrize(("of_repairs", "of_groups"), [(0, 0), (1, 0), (1, 1), (1, 2), (3, 2)])
def test_the_bounds_of_all_effects_hold_together(
    of_repairs: int, of_groups: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each of two one-sided bounds gets an equal part of ALPHA (Bonferroni)."""
    told: list[tuple[str, tuple[str, ...], tuple[str, ...], float]] = []

    def strata(_: Any, repair: str, columns: tuple[str, ...], values: tuple[str, ...]) -> Any:
        return columns, (repair, values)

    def effect(repair: str, values: tuple[str, ...], rows: Any, confidence: float) -> str:
        assert rows[1] == (repair, values)
        told.append((repair, values, rows[0], confidence))
        return repair

    monkeypatch.setattr(repairs, "_groups", lambda *_: ((f"site-{n}",) for n in range(of_groups)))
    monkeypatch.setattr(repairs, "_strata", strata)
    monkeypatch.setattr(repairs, "effect", effect)
    names = [(f"guard-{n}",) for n in range(of_repairs)]
    found = repairs.effects(database([], [], names), ("repair", "site"))
    number = of_repairs * of_groups
    assert len(found) == len(told) == number
    expected = 1.0 - repairs.ALPHA / (2 * max(number, 1))
    assert {columns for *_, columns, _ in told} <= {("site",)}
    assert [confidence for *_, confidence in told] == pytest.approx([expected] * number)
