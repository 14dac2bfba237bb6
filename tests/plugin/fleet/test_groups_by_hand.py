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

from pytest_tarl.errors import FixtureError, SettingsError
from pytest_tarl.fleet import merged, mission_groups, question, repairs
from pytest_tarl.fleet.mission_groups import Judged
from pytest_tarl.fleet.question import Question
from pytest_tarl.fleet.schema import Origin
from pytest_tarl.learning.bounds import Range, mean_of, rate
from pytest_tarl.learning.guarantees import stated
from pytest_tarl.model import Region, Verdict
from tests.plugin.fleet.answers import fixture, group


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
    monkeypatch.setattr(mission_groups, "_declared", lambda _: declared)
    totals = [1.0, 2.0, 3.0, 4.0]
    one = mission_groups._group(
        database([1, 0, 1, 1], totals), replace(fixture(), stated=None), 0, ("a", 7, 4, 2)
    )
    assert (one.values, one.missions, one.robots, one.passed) == (("a", "7"), 4, 2, 3)
    assert (one.reward, one.outside, one.compared, one.verdict) == (2.5, outside, 0, None)
    assert one.success == rate(3, 4, mission_groups.CONFIDENCE)
    assert one.mean == mean_of(totals, mission_groups.CONFIDENCE, None if outside else declared)


def test_the_formulas_of_each_group_are_collected() -> None:
    rows = [(0, "a", 3, 1, -0.5), (0, "b", 3, 0, 0.5), (2, "a", 1, 1, -1.0)]
    assert mission_groups._violations(database([], [], rows)) == {
        0: (Judged("a", 3, 1, -0.5), Judged("b", 3, 0, 0.5)),
        2: (Judged("a", 1, 1, -1.0),),
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


def test_each_group_gets_its_own_verdict_and_formulas(monkeypatch: pytest.MonkeyPatch) -> None:
    worse = Verdict("degraded", 0.001, 0.001, 1.5, 0.2, 0.1)
    found = SimpleNamespace(verdict=worse, region=Region(((2, 0),)))
    judged = (Judged("a", 3, 1, -0.5),)
    monkeypatch.setattr(mission_groups.samples, "groups", lambda *_: ["sample"] * 3)
    monkeypatch.setattr(mission_groups, "_tasks", lambda *_: ())
    monkeypatch.setattr(mission_groups, "_violations", lambda _: {2: judged})
    monkeypatch.setattr(mission_groups, "_group", lambda _db, _fixture, number, _row: group(f"g{number}"))
    engine: Any = SimpleNamespace(each=lambda *_: [(3, None), (40, found), (5, None)])
    rows = [("a", 1, 1), ("b", 1, 1), ("c", 1, 1)]
    where: Any = None
    every = mission_groups.judged(
        database([], [], rows), where, fixture(), (), ["site"], engine, alpha=0.05, tolerance=None
    )
    assert [(one.values, one.compared, one.formulas) for one in every] == [
        (("g0",), 3, ()), (("g1",), 40, ()), (("g2",), 5, judged)
    ]  # fmt: skip
    assert [one.verdict and one.verdict.result for one in every] == [None, "degraded", None]
    assert [one.region.cells for one in every] == [(), ((2, 0),), ()]


@pytest.mark.parametrize(
    ("declared", "totals", "refused"),
    [
        (None, [1.0, 3.0], False),
        ((1.0, 3.0), [1.0, 3.0], False),
        ((0.0, 4.0), [2.0, 2.0], False),
        ((2.0, 2.5), [2.0, 2.0], False),
        ((1.5, 3.0), [1.0, 3.0], True),
        ((1.0, 2.5), [1.0, 3.0], True),
    ],
)
def test_totals_may_equal_the_declared_limits(
    declared: tuple[float, float] | None, totals: list[float], refused: bool
) -> None:
    before = replace(stated([True, True], [2.0, 2.0]), declared=declared)
    whole: Any = SimpleNamespace(
        total=np.array(totals), passed=np.array([True, False]), episodes=2, lists=(), judgements=None
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(merged, "varies", lambda _: True)
        if refused:
            with pytest.raises(FixtureError, match=r"The episodes earn 1 to 3, but the recording states"):
                merged._stated(before, whole)
        else:
            found = merged._stated(before, whole)
            assert found is not None
            assert found.declared == declared
            assert found.success.low < 0.5 < found.success.high
    assert merged._stated(None, whole) is None


def test_missions_that_do_not_fit_are_counted_by_reason() -> None:
    own = Origin("walk", "s", "l", "r")
    parts: Any = [
        SimpleNamespace(origin=origin, missions=missions)
        for origin, missions in (
            (own, 1),
            (replace(own, recording="other"), 2),
            (replace(own, statements="other"), 4),
            (replace(own, sensors="other"), 8),
            (replace(own, sensors="other", statements="other"), 16),
            (replace(own, test="run"), 32),
            (replace(own, test="run", sensors="other"), 64),
        )
    ]
    assert question._left_out(parts, own) == {
        "of run": 96, "of walk with other sensors or bins": 24, "of walk with other statements": 4
    }  # fmt: skip
    assert question._left_out(parts[:2], own) == {}


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"workers": 0}, "--workers must be 1 or more, got 0"),
        ({"alpha": 0.0}, "--alpha must be a probability"),
        ({"alpha": 1.0}, "--alpha must be a probability"),
        ({"by": ("site", "nothing")}, "--by must name each of"),
        ({"by": ("site", "site")}, "got site,site"),
    ],
)
def test_a_question_with_a_wrong_value_is_refused(changes: dict[str, Any], says: str) -> None:
    question._check(replace(Question("data", by=("site", "version")), workers=1, alpha=0.999))
    with pytest.raises(SettingsError, match=says):
        question._check(replace(Question("data", by=("site",)), **changes))
