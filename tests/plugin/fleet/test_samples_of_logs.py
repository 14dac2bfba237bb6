"""The formulas and sites of a recording, as they are needed to read a log."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("pyarrow")

from pytest_tarl.fleet.logged_samples import identity, plan_of, requirements_of
from pytest_tarl.formulas.marker_arguments import NOTHING_REQUIRED
from pytest_tarl.logged import Mission


def recording(*texts: str) -> Any:
    sensors = [SimpleNamespace(name="x", categories=()), SimpleNamespace(name="kind", categories=("a", "b"))]
    return SimpleNamespace(
        test="t.py::test",
        sensors=sensors,
        signals=(SimpleNamespace(name="level"),),
        sample=SimpleNamespace(judgements=SimpleNamespace(formulas=texts) if texts else None),
    )


def test_formulas_use_numeric_sensors_and_signals() -> None:
    pytest.importorskip("rtamt")
    found = requirements_of(recording("always (x > 0)", "eventually (level > x)"))
    assert [one.text for one in found.formulas] == ["always (x > 0)", "eventually (level > x)"]
    assert [one.signals for one in found.formulas] == [("x",), ("level", "x")]
    assert (found.names, [one.name for one in found.signals]) == (("x", "level"), ["level"])
    assert requirements_of(recording("always (kind > 0)")) == NOTHING_REQUIRED
    assert requirements_of(recording()) == NOTHING_REQUIRED


def test_sites_are_numbered_in_the_order_of_the_lists() -> None:
    a, b, c = (SimpleNamespace(id=name) for name in "abc")
    fixture: Any = SimpleNamespace(lists=(SimpleNamespace(sites=[b, a]), SimpleNamespace(sites=[a, c, b])))
    plan = plan_of(fixture)
    assert plan.places == (b, a, c)
    assert plan.members == ((0, 1), (1, 2, 0))


def test_each_part_of_a_mission_changes_its_identity() -> None:
    one = Mission(["a", "b"], 2.0, [{"reward": "AA"}], passed=True, failure="")
    others = [
        replace(one, sites=["b", "a"]),
        replace(one, time=2.5),
        replace(one, chunks=[{"reward": "AB"}]),
        replace(one, passed=False),
        replace(one, failure="fell"),
    ]
    assert len({identity(each) for each in (one, *others)}) == 6
    assert identity(replace(one, ended=True)) == identity(Mission(("a", "b"), 2.0, [{"reward": "AA"}]))
