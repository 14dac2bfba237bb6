"""Each value of the JSON document of `tarl fleet`, for small answers that are written down by hand."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import datetime, timezone
from math import inf, nan
from typing import Any

import pytest

pytest.importorskip("pyarrow")
pytest.importorskip("duckdb")
pytest.importorskip("dask")

from pytest_tarl.fleet.clusters import Cluster, Clusters
from pytest_tarl.fleet.components import Component
from pytest_tarl.fleet.decomposition import Decomposition
from pytest_tarl.fleet.json_result import document, schema, text
from pytest_tarl.fleet.mission_groups import Judged
from pytest_tarl.fleet.question import Answer, Question
from pytest_tarl.model import Region, Verdict
from tests.plugin.fleet.answers import answer, effect, evidence, group, robot, robots, status, unknown

CELL, NEW = (2, 0), (3, 1)


def written(found: Answer) -> Any:
    """Return the document as a reader of the JSON gets it, after a check against the schema."""
    read = json.loads(text(found))
    pytest.importorskip("jsonschema").validate(read, schema())
    return read


def as_json(low: float | None, high: float | None, exact: bool = True) -> dict[str, Any]:
    return {"low": low, "high": high, "confidence": 0.95, "method": "test", "exact": exact}


def test_a_group_without_a_verdict_has_no_result() -> None:
    (one,) = written(answer())["groups"]
    assert one == {
        "values": ["north"],
        "missions": 40,
        "robots": 4,
        "passed": 30,
        "reward": 2.5,
        "success": as_json(0.6, 0.85),
        "mean": as_json(2.25, 2.75, exact=False),
        "compared": 40,
        "result": None,
        "loss": None,
        "p_loss": None,
        "p_failures": None,
        "because": [],
        "p_drift": None,
        "cells": [],
        "new": [],
        "evidence": {"world": -1.0, "bound": -1.0},
        "formulas": [],
    }


def test_a_group_with_a_verdict_has_its_figures() -> None:
    verdict = Verdict("degraded", 0.03, 0.004, 1.5, 0.2, 0.1, p_failures=0.25, because=("reward",))
    watched = robot("north", 5.0, 2.0, status(evidence(2.0, 7, 100.0), (CELL,), evidence(1.0, 9, 200.0)))
    judged = (Judged("always (x > 0)", 12, 3, -0.5),)
    north = group("north", verdict=verdict, region=Region((CELL,), (NEW,)), formulas=judged)
    (one,) = written(answer(groups=(north,), onsets=robots(watched)))["groups"]
    names = ("result", "loss", "p_loss", "p_failures", "because", "p_drift", "cells", "new")
    assert [one[name] for name in names] == [
        "degraded", 1.5, 0.004, 0.25, ["reward"], 0.03, [[2, 0]], [[3, 1]]
    ]  # fmt: skip
    assert one["evidence"] == {
        "world": 5.0,
        "bound": 2.0,
        "world_since": {"mission": 7, "time": 100.0},
        "bound_since": {"mission": 9, "time": 200.0},
    }
    assert one["formulas"] == [{"formula": "always (x > 0)", "missions": 12, "violated": 3, "least": -0.5}]


def test_robot_onset_comes_from_the_strongest_bound() -> None:
    told = replace(
        status(evidence(2.0), (CELL,), evidence(1.0, 4, 50.0), None, evidence(3.0, 6, 60.0)), new=(NEW,)
    )
    found = written(answer(robots=robots(robot("r1", 2.0, 3.0, told), robot("r2"))))
    assert found["robots"] == [
        {
            "robot": "r1",
            "missions": 10,
            "passed": 9,
            "world": 2.0,
            "bound": 3.0,
            "world_since": None,
            "bound_since": {"mission": 6, "time": 60.0},
            "cells": [[2, 0]],
            "new": [[3, 1]],
        },
        {"robot": "r2", "missions": 10, "passed": 9, "world": -1.0, "bound": -1.0},
    ]
    untestable = replace(told, bounds=((told.bounds[0][0], None),))
    (alone,) = document(answer(robots=robots(robot("r1", status=untestable))))["robots"]
    assert alone["bound_since"] is None


def test_page_lists_drifted_and_worse_robots_separately() -> None:
    one, two, three = (robot(name) for name in ("a", "b", "c"))
    groups = tuple(group(name) for name in ("a", "b", "c"))
    found = written(
        answer(
            groups=groups,
            onsets=robots(one, two, three, drifted=(one,), below=(two, three)),
            robots=robots(one, two, three, drifted=(two,), below=(one,)),
        )
    )
    assert (found["groups_drifted"], found["groups_below"]) == (["a"], ["b", "c"])
    assert (found["drifted"], found["below"], found["false_discovery_rate"]) == (["b"], ["a"], 0.1)


def test_the_question_and_the_counts_are_repeated() -> None:
    since = datetime(2025, 1, 2, tzinfo=timezone.utc)
    found = written(answer(copies=3, left_out={"damaged": 2}))
    names = ("format", "missions", "copies", "by", "since", "robot", "left_out", "lowest", "components")
    assert [found[name] for name in names] == [1, 40, 3, ["site"], None, None, {"damaged": 2}, [], None]
    asked = written(answer(question=Question("data", by=("site", "version"), since=since, robot="r1")))
    assert (asked["by"], asked["since"], asked["robot"]) == (
        ["site", "version"], "2025-01-02T00:00:00+00:00", "r1"
    )  # fmt: skip


def test_bounds_of_an_unmeasured_repair_are_null() -> None:
    one = replace(effect(), values=("north",))
    found = written(answer(repairs=(one, unknown()), accepted={"guard-1": "rain"}))["repairs"]
    assert found[0] == {
        "repair": "guard-1",
        "accepted_for": "rain",
        "values": ["north"],
        "verdict": one.verdict,
        "missions": [1200, 2400],
        "robots": [12, 24],
        "strata": 3,
        "reward": 0.5,
        "reward_bound": as_json(0.25, 0.75),
        "success": 0.05,
        "success_bound": as_json(0.01, 0.09),
    }
    names = ("reward", "success", "reward_bound", "success_bound", "strata")
    assert [found[1][name] for name in names] == [None, None, as_json(None, None), as_json(None, None), 0]
    assert written(answer(repairs=(one,)))["repairs"][0]["accepted_for"] is None


def test_components_have_the_effect_of_each_level() -> None:
    parts = Decomposition(
        "week",
        (
            Component("site", 2.0, 1.0, inf, 2, (0.5, -0.5)),
            Component("robot", nan, nan, nan, 9),
            Component("mission", 3.0, 2.0, 4.0, 40),
        ),
        (("north", "south"),),
        0.9,
    )
    assert written(answer(parts=parts))["components"] == {
        "season": "week",
        "confidence": 0.9,
        "rows": [
            {
                "of": "site", "variance": 2.0, "low": 1.0, "high": None, "levels": 2,
                "effects": {"north": 0.5, "south": -0.5},
            },
            {"of": "robot", "variance": None, "low": None, "high": None, "levels": 9, "effects": {}},
            {"of": "mission", "variance": 3.0, "low": 2.0, "high": 4.0, "levels": 40, "effects": {}},
        ],
    }  # fmt: skip


def test_clusters_have_their_cells_and_residuals() -> None:
    found = Clusters((Cluster(("r1", "r2"), (CELL, NEW), (-1.0, -0.5)),), ("r3",))
    shown = written(answer(clusters=found))
    assert shown["clusters"] == [
        {"robots": ["r1", "r2"], "cells": [[2, 0], [3, 1]], "residuals": [-1.0, -0.5]}
    ]
    assert shown["unclear"] == ["r3"]


def test_text_refuses_numbers_that_json_lacks() -> None:
    found = text(answer(groups=(group("Zoë"),), onsets=robots(robot("Zoë"))))
    assert '"Zoë"' in found
    assert found.endswith("}\n")
    assert found.startswith('{\n "format": 1,\n')
    with pytest.raises(ValueError, match="JSON compliant"):
        text(answer(groups=(group("a", reward=nan),)))
