"""The variables of the template of the fleet page and the data of its script, for answers written by hand."""

from __future__ import annotations

from dataclasses import replace
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pytest_tarl.errors import FleetError
from pytest_tarl.fleet import html
from pytest_tarl.fleet.clusters import Cluster, Clusters
from pytest_tarl.fleet.components import Component
from pytest_tarl.fleet.decomposition import Decomposition
from pytest_tarl.fleet.mission_groups import Judged
from pytest_tarl.fleet.question import Answer, Mission, Question
from pytest_tarl.fleet.residual_maps import ResidualMap
from pytest_tarl.report.sensor_regions import Vocabulary
from tests.plugin.fleet.answers import (
    CELLS,
    DAY,
    answer,
    bound,
    effect,
    evidence,
    group,
    mean_of_recording,
    robot,
    robots,
    status,
    unknown,
)
from tests.plugin.monitoring.missions import SENSORS

PLACE = ((2, 0), (2, 1))


def variables(found: Answer) -> dict[str, Any]:
    return html._context(found, Vocabulary(SENSORS, CELLS))


def data(found: Answer) -> dict[str, Any]:
    return html._data(found, Vocabulary(SENSORS, CELLS))


def test_the_title_of_the_page_names_the_requested_robot() -> None:
    assert variables(answer())["title"] == "data"
    assert variables(answer(question=Question("data", robot="r1")))["title"] == "data, r1"


def test_page_shows_the_known_period_of_missions() -> None:
    assert variables(answer())["period"] == "no time"
    assert variables(answer(period=(DAY, 40 * DAY)))["period"] == "1970-01-02 to 1970-02-10"


@pytest.mark.parametrize(
    ("groups", "found", "expected"),
    [
        (("no difference",), (), "0 of 1 robot named."),
        (("degraded",), (), "1 of 1 group differ from the recording; 0 of 1 robot named."),
        (("no difference", None), (), "0 of 2 groups differ from the recording; 0 of 1 robot named."),
        (
            ("no difference", "drifted"),
            ("g0",),
            "2 of 2 groups differ from the recording; 0 of 1 robot named.",
        ),
        (
            ("no difference", "drifted"),
            ("g1",),
            "1 of 2 groups differ from the recording; 0 of 1 robot named.",
        ),
    ],
)
def test_headline_separates_old_from_new_group_differences(
    groups: tuple[str | None, ...], found: tuple[str, ...], expected: str
) -> None:
    watched = [robot(f"g{n}") for n in range(len(groups))]
    changed = tuple(one for one in watched if one.name in found)
    shown = variables(
        answer(
            groups=tuple(group(f"g{n}", result=one) for n, one in enumerate(groups)),
            onsets=robots(*watched, below=changed),
        )
    )
    assert shown["headline"] == expected
    assert shown["differing"] == int(expected[0]) if "group" in expected else True


def test_a_robot_that_is_named_twice_counts_once() -> None:
    every = (robot("r1"), robot("r2"), robot("r3"))
    shown = variables(answer(robots=robots(*every, drifted=every[:2], below=every[1:2])))
    assert (shown["named"], shown["robots"], shown["rate"]) == (2, 3, "10 %")
    assert shown["headline"] == "2 of 3 robots named."


def test_cluster_links_to_thirty_robots_and_counts_the_rest() -> None:
    names = tuple(f"r{n:02}" for n in range(32))
    found = Clusters((Cluster(names, PLACE, (-0.5, -1.0)), Cluster(names[:30], (), ())))
    first, second = variables(answer(clusters=found))["clusters"]
    assert first == {"count": 32, "names": names[:30], "more": 2, "where": "x 2-3", "residual": "-0.75"}
    assert second == {"count": 30, "names": names[:30], "more": 0, "where": "no common cell", "residual": ""}


def test_the_page_lists_the_missions_with_the_lowest_reward() -> None:
    lowest = (Mission(1.5 * DAY, False, -12.3456789, 7), Mission(0.0, True, 3.0, 1))
    assert variables(answer(lowest=lowest))["lowest"] == [
        {"time": "1970-01-02 12:00", "result": "failed", "total": "-12.3457", "steps": 7},
        {"time": "no time", "result": "passed", "total": "3", "steps": 1},
    ]


def test_page_lists_formula_violations_by_group() -> None:
    one = group("north", formulas=(Judged("always(x > 1)", 1000, 10, -0.5678),))
    assert variables(answer(groups=(one,)))["formulas"] == [
        {"formula": "always(x > 1)", "group": "north", "violated": "10 of 1,000", "least": "-0.568"}
    ]


def test_page_notes_do_not_begin_with_note() -> None:
    first, *_ = variables(answer())["notes"]
    assert first.startswith("ranges are one-sided bounds")


def test_components_of_unknown_variance_have_no_share() -> None:
    site = Component("site", 0.3, 0.15, 0.6, 2, (-0.25, 0.25))
    parts = Decomposition(
        "month",
        (
            site,
            Component("season", -0.1, 0.0, 0.0, 3, (0.0, 0.0, 0.0)),
            Component("robot", nan, nan, nan, 4),
            Component("mission", 0.5, 0.4, inf, 1),
        ),
        (("a", "b"), ("1", "2", "3")),
    )
    shown = variables(answer(parts=parts))["components"]
    assert shown[0] == {
        "name": "site",
        "share": "37.5 %",
        "width": 37.5,
        "variance": "0.3",
        "interval": "0.15 to 0.6",
        "lowest": "a -0.25",
    }
    assert (shown[1]["name"], shown[1]["share"], shown[1]["width"]) == ("season (month)", "0.0 %", 0.0)
    assert (shown[1]["variance"], shown[1]["lowest"]) == ("0", "")
    assert (shown[2]["share"], shown[2]["variance"], shown[2]["width"]) == ("", "", 0.0)
    assert shown[2]["interval"] == "cannot be told apart from the others"
    assert (shown[3]["share"], shown[3]["interval"]) == ("", "only one")
    assert variables(answer())["components"] == []


def test_page_shows_repair_intervals_or_why_they_are_absent() -> None:
    helps, nothing = variables(
        answer(repairs=(effect(values=("wet",)), unknown()), accepted={"guard-1": "mud"})
    )["repairs"]
    assert helps == {
        "repair": "guard-1",
        "accepted": "mud",
        "group": "wet",
        "verdict": "helps",
        "tag": "helps",
        "reward": "+0.5",
        "interval": "+0.25 to +0.75",
        "success": "+5.0 points",
        "missions": "1,200 with, 2,400 without",
    }
    assert (nothing["group"], nothing["tag"], nothing["reward"]) == ("all missions", "no-difference", "")
    assert nothing["success"] == ""
    assert nothing["interval"] == "no missions without a repair at the same site in the same week"
    harms, none = variables(
        answer(repairs=(replace(effect(low=-2), reward_bound=bound(-2, -1)), effect(low=-0.5)))
    )["repairs"]
    assert (harms["tag"], none["tag"], none["verdict"]) == ("harms", "no-difference", "no effect shown")


def test_page_stores_robots_in_columns() -> None:
    told = status(evidence(2.0, 7, 3 * DAY), PLACE)
    every = (robot("r1"), robot("r2", 9.123, 1.0, told), robot("r3", 3.0, 2.0))
    found = data(
        answer(
            question=Question("the data", by=("site",)),
            robots=robots(*every, drifted=(every[2], every[1]), below=(every[1],)),
            clusters=Clusters((Cluster(("r2", "r3"), ((1, 0),), (-1.0,)),)),
            period=(1.0, 2.0),
        )
    )
    assert found["robots"] == {
        "name": ["r1", "r2", "r3"],
        "missions": [10, 10, 10],
        "passed": [9, 9, 9],
        "world": [-1.0, 9.12, 3.0],
        "bound": [-1.0, 1.0, 2.0],
    }
    first, second = found["named"]
    assert first == {"index": 1, "mission": 7, "time": 3 * DAY, "where": "x 2-3", "like": ["r3"], "cells": []}
    assert (second["index"], second["mission"], second["time"]) == (2, None, None)
    assert (second["where"], second["like"]) == ("x 1-2, wet false", ["r2"])
    assert (found["by"], found["period"], found["command"]) == (["site"], [1.0, 2.0], "tarl fleet 'the data'")
    assert found["weak"] == 3.322  # log2 of 1 / 0.1
    assert found["recorded"] == pytest.approx(mean_of_recording(), abs=1e-6)


@pytest.mark.parametrize(("world", "limit", "mission"), [(5.0, 4.9, 7), (5.0, 5.0, 9), (5.0, 6.0, 9)])
def test_page_onset_comes_from_the_test_with_most_evidence(world: float, limit: float, mission: int) -> None:
    told = status(evidence(2.0, 7, 3 * DAY), (), evidence(1.0, 4, DAY), evidence(3.0, 9, 5 * DAY))
    assert html._since(robot("r1", world, limit, told)) == (
        mission,
        (mission - 4) * DAY if mission == 7 else 5 * DAY,
    )


def test_robot_onset_and_its_time_may_be_absent() -> None:
    assert html._since(robot("r1")) is None
    assert html._since(robot("r1", 5.0, 6.0, status(evidence(2.0)))) is None
    assert html._since(robot("r1", 5.0, 6.0, status(evidence(2.0, 3)))) == (3, 0.0)


def test_page_lists_the_cells_with_the_largest_residuals() -> None:
    one = robot("r1", 9.0)
    known = ResidualMap(
        "r1",
        np.array([-0.5, 2.0, 0.1, np.nan, 0.0, 0.0, 0.0, 0.0]),
        np.array([0.01, 4.0, 0.0, np.nan, 1.0, 1.0, 1.0, 1.0]),
    )
    found = answer(robots=robots(one, drifted=(one,)), clusters=Clusters(maps={"r1": known}))
    first, second, *others = data(found)["named"][0]["cells"]
    assert first == {"name": "x 0-1, wet false", "mean": -0.5, "error": 0.1}
    assert second == {"name": "x 0-1, wet true", "mean": 2.0, "error": 2.0}
    assert len(others) == 4  # neither the cell without variance nor the unknown one


def test_at_most_twelve_cells_are_listed() -> None:
    cells = tuple((x, wet) for x in range(4) for wet in range(5))
    every = ResidualMap("r1", np.arange(20.0), np.ones(20))
    found = answer(cells=cells)
    shown = html._residuals(found, every, Vocabulary(SENSORS, cells))
    assert [one["mean"] for one in shown] == [19.0 - n for n in range(12)]
    one = robot("r1", 9.0, status=status(evidence(2.0), cells))
    assert len(data(answer(cells=cells, robots=robots(one, drifted=(one,))))["cells"]) == 12


def test_cells_are_counted_over_named_robots_and_groups() -> None:
    told = status(evidence(2.0), ((0, 0), (2, 0)))
    every = tuple(robot(name, 5.0, status=told) for name in ("r1", "r2"))
    groups = (
        group("a", result="degraded", cells=((2, 0), (3, 1))),
        group("b", result="no difference", cells=((1, 1),)),
        group("c", result="no difference"),
    )
    watched = (robot("a", status=told), robot("b", status=told), robot("c", 9.0, status=told))
    found = answer(
        groups=groups,
        onsets=robots(*watched, drifted=watched[2:]),
        robots=robots(*every, robot("r3"), drifted=every),
    )
    names = {cell: Vocabulary(SENSORS, CELLS).words([cell]) for cell in CELLS}
    assert data(found)["cells"] == [
        {"name": names[2, 0], "robots": 2, "groups": 2},
        {"name": names[0, 0], "robots": 2, "groups": 1},
        {"name": names[3, 1], "robots": 0, "groups": 1},
    ]


def test_group_data_has_figures_and_onset() -> None:
    told = status(evidence(2.0, 7, 3 * DAY), PLACE)
    watched = robot("south", 5.126, 2.0, told)
    one = group("south", result="degraded", mean=bound(-inf, 2.75))
    (shown,) = data(answer(groups=(one,), onsets=robots(watched)))["groups"]
    assert shown == {
        "values": ["south"],
        "missions": 40,
        "robots": 4,
        "pass": 0.75,
        "passLow": 0.6,
        "passHigh": 0.85,
        "reward": 2.5,
        "low": None,
        "high": 2.75,
        "result": "degraded",
        "verdict": "degraded by 1.5 (p 0.004)",
        "found": True,
        "named": False,
        "evidence": 5.13,
        "since": None,
        "where": "",
    }
    (named,) = data(answer(groups=(group("south"),), onsets=robots(watched, drifted=(watched,))))["groups"]
    assert (named["found"], named["named"], named["since"], named["where"]) == (True, True, 3 * DAY, "x 2-3")
    assert named["result"] is None


def test_long_group_list_shows_differing_and_worst_groups(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(html, "MOST_GROUPS", 3)
    rewards = {"a": 5.0, "b": 9.0, "c": 1.0, "d": 8.0, "e": 2.0}
    groups = tuple(
        group(name, reward=reward, result="drifted" if name == "b" else "no difference")
        for name, reward in rewards.items()
    )
    watched = tuple(robot(name) for name in rewards)
    found = answer(groups=groups, onsets=robots(*watched, below=(watched[3],)))
    assert [one["values"] for one in data(found)["groups"]] == [["b"], ["c"], ["d"]]


def test_an_unwritable_page_is_reported_in_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(FleetError, match=r"The page .* cannot be written"):
        html.write(answer(), tmp_path / "missing" / "folder" / ("x" * 300))
