"""Lines that commands print, for recordings and results written down by hand."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.commands import diff, show, summary
from pytest_tarl.commands.diff import FixtureDiff, Moved
from pytest_tarl.learning.tables import Edges, ListSample, Visits
from pytest_tarl.model import Bound, Guarantee, SitePlace, TaintList
from pytest_tarl.sensors import Sensor

X = Sensor("x", topic="/odom", field="pose.x", low=0, high=4, bins=4, unit="m")
SITE = SitePlace("m:f", "a.py", 7, "f(\n  1)", "data", "assign")
MOVED = SitePlace("m:f", "a.py", 9, "f(\n  1)", "data", "assign")
AWAY = SitePlace("m:f", "b.py", 9, "f(\n  1)", "data", "assign")


def difference(**changes: Any) -> FixtureDiff:
    every = {"loss": 2.0, "p_loss": 0.04, "success": (0.9, 0.75), "gone": (), "new": (), "moved": ()}
    return FixtureDiff(**{**every, "cells": (1, 2, 3), "same_sensors": True, **changes})


@pytest.mark.parametrize(
    ("loss", "p", "most", "expected"),
    [
        (2.0, 0.04, 0.0, True),
        (2.0, 0.05, 0.0, False),
        (0.0, 0.0, 0.0, False),
        (2.0, 0.0, 2.0, False),
        (2.0, 0.0, 1.9, True),
    ],
)
def test_recording_is_worse_if_its_loss_exceeds_the_tolerance(
    loss: float, p: float, most: float, expected: bool
) -> None:
    assert difference(loss=loss, p_loss=p).worse(0.05, most) is expected


@pytest.mark.parametrize(
    ("success", "p", "expected"),
    [
        ((0.9, 0.75), 0.04, True),
        ((0.9, 0.75), 0.05, False),
        ((0.9, 0.85), 0.0, False),
        ((0.75, 0.9), 0.0, False),
    ],
)
def test_recording_with_fewer_successes_is_worse(
    success: tuple[float, float], p: float, expected: bool
) -> None:
    found = difference(loss=-1.0, p_loss=0.9, success=success, p_failures=p)
    assert found.worse(0.05) is expected


def test_two_recordings_differ_if_their_sites_or_sensors_differ() -> None:
    assert not difference(moved=(Moved(SITE, MOVED),)).changed
    for one in ({"gone": (SITE,)}, {"new": (SITE,)}, {"same_sensors": False}):
        assert difference(**one).changed


def recording(test: str, episodes: int, total: float, sites: tuple[SitePlace, ...] = ()) -> Any:
    sample = SimpleNamespace(
        episodes=episodes,
        total=np.full(episodes, total),
        passed=np.array([True] * (episodes - 1) + [False]),
        cells=tuple((n,) for n in range(episodes)),
    )
    return SimpleNamespace(test=test, sample=sample, sensors=(X,), lists=(SimpleNamespace(sites=sites),))


def test_two_recordings_are_compared_by_reward_cells_and_sites() -> None:
    other = SitePlace("m:g", "a.py", 8, "g()", "data", "assign")
    found = diff.compared(recording("t", 4, 3.0, (SITE, other)), recording("t", 2, 1.0, (AWAY,)))
    assert (found.loss, found.success, found.cells) == (2.0, (0.75, 0.5), (2, 2, 0))
    assert (found.gone, found.new, found.moved) == ((other,), (), (Moved(SITE, AWAY),))
    same = diff.compared(recording("t", 4, 3.0, (SITE,)), recording("t", 4, 3.0, (SITE,)))
    assert (same.moved, same.loss, same.same_sensors) == ((), 0.0, True)


def test_diff_prints_the_changes_of_two_recordings() -> None:
    one, two = recording("t", 4, 3.0), recording("u", 2, 1.0)
    found = difference(gone=(SITE,), new=(AWAY,), moved=(Moved(SITE, MOVED), Moved(SITE, AWAY)))
    assert [*diff.lines(one, two, found)] == [
        "t → u",
        "  episodes   4 → 2",
        "  reward     3 → 1 per episode (less: p = 0.04)",
        "  success    90 % → 75 % (less: p = 1)",
        "  cells      2 in both, 1 gone, 3 new",
        "  gone       `f( 1)` of a.py:7: its slice is lost; verdict and region remain valid",
        "  new        `f( 1)` at b.py:9: it has no slice in the first recording",
        "  moved      `f( 1)` from line 7 to 9: its slice is kept",
        "  moved      `f( 1)` from a.py:7 to b.py:9: its slice is kept",
    ]
    lines = [*diff.lines(one, one, difference(same_sensors=False, gone=(SITE,) * 13))]
    assert (lines[0], lines[4]) == ("t", "  cells      not comparable: the sensors differ")
    assert (len(lines), lines[-1]) == (18, "             … and 1 more")
    assert len([*diff.lines(one, one, difference(gone=(SITE,) * 12))]) == 17


@pytest.mark.parametrize(
    ("sensor", "bins", "expected"),
    [
        (X, (1, 1, 3), "x: /odom pose.x, 0 to 4 m in 4 bins, 2 seen"),
        (Sensor("v", low=0, high=1, bins=2, expr="self.v"), (0,),
         "v: observed, node variable self.v, 0 to 1 in 2 bins, 1 seen"),
        (Sensor("light", topic="/l", field="data", categories=("day", "night")), (1, 0, 1),
         "light: /l data, seen day, night"),
        (Sensor("wet", topic="/w", field="data", edges=(0.5,), unit="l"), (0, 1, 1),
         "wet: /w data, below and above 0.5 l, 2 seen"),
        (Sensor("dry", topic="/d", field="data", edges=(2.0,)), (0, 0), "dry: /d data, below and above 2, 1 seen"),
        (Sensor("w", low=0, high=1, bins=2, expr="w"), (), "w: observed, node variable w, 0 to 1 in 2 bins, 0 seen"),
    ],
)  # fmt: skip
def test_sensor_is_described_with_origin_and_bins(
    sensor: Sensor, bins: tuple[int, ...], expected: str
) -> None:
    assert show.described(sensor, bins) == expected


def listed() -> tuple[TaintList, ListSample]:
    """Return a list of two sites; the first ran 3 times with a flow of 6, the second once with 0.5."""
    none = np.empty(0, np.int64)
    visits = Visits(
        np.zeros(4, np.int64),
        np.array([0, 1, 2, 3]),
        np.array([9, 2, 1, 1]),
        *(np.zeros(4) for _ in range(4)),
    )
    decided = SitePlace("m:g", "b.py", 12, "if " + "x" * 70 + ":", "control", "condition")
    recorded = ListSample(2, Edges(none, none, none, none), visits, np.array([[5.0, 0.5], [1.0, 0.0]]))
    return TaintList("/in", "/out", (SITE, decided)), recorded


def test_statements_are_listed_with_their_executions_and_mean_flow() -> None:
    heading, first, second = show._list(*listed(), 1500)
    assert heading.endswith(": 4 events, mean |f| 1.625, 1.5 kB")
    assert first == f"    a.py:7    ● {'f( 1)':<60}       3 × 2"
    assert second == f"    b.py:12   ◆ {'if ' + 'x' * 56}…       1 × 0.5"
    assert show._summary(*listed(), 1500) == f"{heading}, 2 statements in a.py, b.py"


def result(**changes: Any) -> dict[str, Any]:
    every: dict[str, Any] = {
        "test": "t.py::test|a",
        "drift": "mud",
        "verdict": {"result": "degraded", "loss": 1.2345, "p_loss": 0.0123},
        "region": [{"x": [1.0, 2.5], "wet": [1, 1]}, {"x": [4, 4]}],
        "culprits": [{"path": "a.py", "line": 7}],
        "repair": {
            "accepted": True,
            "guard": "wet",
            "edits": [{"code": "5", "value": 12.0}, {"code": "KP", "value": 0.5}],
        },
        "sites": [],
    }
    return every | changes


def test_a_result_becomes_a_row_of_a_table() -> None:
    assert summary._row(result()) == (
        "| `t.py::test¦a` | mud | ❌ degraded | 1.23 (p = 0.012) | x 1 to 2.5, wet 1; x 4 | `a.py:7` | "
        "5 → 12, KP → 0.5 where wet |"
    )
    quiet = {"result": "no difference", "loss": 1.0, "p_loss": 0.5}
    assert summary._row(result(verdict=quiet, repair=None)).endswith(
        "| ✅ no difference |  | x 1 to 2.5, wet 1; x 4 |  |  |"
    )
    drifted = {"result": "drifted", "loss": 1.0, "p_loss": 0.5}
    refused = result(verdict=drifted, repair={"accepted": False}, culprits=[], region=[])
    assert summary._row(refused) == "| `t.py::test¦a` | mud | ⚠️ drifted |  |  |  |  |"
    everywhere = {"accepted": True, "guard": "", "edits": [{"code": "5", "value": 12.0}]}
    assert summary._repair(everywhere) == "5 → 12"
    law = {"code": "KP", "value": -1.7, "what": "scale KP by (light / 2.0) to the power of -1.7"}
    follows = {"accepted": True, "guard": "", "edits": [law]}
    assert summary._repair(follows) == "scale KP by (light / 2.0) to the power of -1.7"


def test_chart_lists_the_largest_losses_in_file_order() -> None:
    sites = [
        {
            "path": f"src/{'ba'[n % 2]}.py",
            "line": 20 - n,
            "offline": 10.0,
            "online": 10.0 - n,
            "difference": float(-n),
        }
        for n in range(10)
    ]
    told = [*summary._picture(result(sites=sites))]
    assert told[0] == "```mermaid"
    assert told[2] == '  title "Utility by statement: designed (bars), mud (line)"'
    assert told[3] == (
        '  x-axis ["a.py:11", "a.py:13", "a.py:15", "a.py:17", "b.py:12", "b.py:14", "b.py:16", "b.py:18"]'
    )
    assert told[4] == f"  bar [{', '.join(['10'] * 8)}]"
    assert told[5] == "  line [1, 3, 5, 7, 2, 4, 6, 8]"


def shown(**changes: Any) -> Any:
    """Return a recording of two episodes of 3 and 4 steps with the two statements of `listed`."""
    taint_list, recorded = listed()
    sample = SimpleNamespace(
        episodes=2,
        steps=np.array([3, 4]),
        passed=np.array([True, False]),
        total=np.array([1.5, -2.5]),
        part_names=("speed", "care"),
        chain=SimpleNamespace(parts=np.array([[1.0, -2.0], [0.5, 0.25], [2.5, -0.75]])),
        judgements=None,
        cells=((0,), (3,), (1,)),
        lists=[recorded],
    )
    every = {"test": "t.py::test", "seed": 7, "design": (), "stated": None, "sensors": (X,)}
    return SimpleNamespace(**{**every, "sample": sample, "lists": [taint_list], **changes})


def test_recording_is_summarised_in_one_line() -> None:
    assert [*show.lines(shown(), 12_345, [1500])][:9] == [
        "t.py::test, seed 7",
        "  episodes   2, 7 steps, success 50 %",
        "  size       12.3 kB, of which 1.5 kB for 1 taint list",
        "  reward     -0.5 per episode, from -2.5 to 1.5",
        "             speed 2",
        "             care -1.25",
        "  cells      3",
        "             x: /odom pose.x, 0 to 4 m in 4 bins, 3 seen",
        "  /in → /out: 4 events, mean |f| 1.625, 1.5 kB",
    ]


def test_a_recording_of_a_permanent_drift_names_it() -> None:
    lines = [*show.lines(shown(design=("mud", "ice")), 1000, [500])]
    assert lines[1] == "  design     with the drift mud and ice, permanent"


def test_bounds_label_is_on_the_first_line_only() -> None:
    sure = Bound(0.9, 1.0, 0.95, "exact", True, 2)
    stated = Guarantee(2, 2, sure, 1.0, sure, 0.1, None, 0, True)
    bounds = [*show.lines(shown(stated=stated), 1000, [500])][4:7]
    assert bounds[0].startswith("  bounds     2 of 2 missions succeeded")
    assert bounds[1].startswith("             mean reward 1 per mission")
    assert bounds[2] == "             each bound holds separately"


def test_many_statements_are_listed_only_on_request() -> None:
    taint_list, recorded = listed()
    many = TaintList("/in", "/out", taint_list.sites * 7)  # 14 statements in each of two lists
    recorded = dataclasses.replace(recorded, width=14, flow=np.ones((2, 14)))
    given = shown(lists=[many, many])
    given.sample.lists = [recorded, recorded]
    told = [*show.lines(given, 9000, [1500, 2500])]
    assert told[2] == "  size       9.0 kB, of which 4.0 kB for 2 taint lists"
    assert told[-3].endswith(", 1.5 kB, 14 statements in a.py, b.py")
    assert told[-1] == "  tarl show --sites lists the 28 statements of the 2 taint lists."
    every = [*show.lines(given, 9000, [1500, 2500], every=True)]
    assert len(every) == len(told) - 3 + 2 * 15
    few = TaintList("/in", "/out", taint_list.sites * 6)  # 24 statements are few enough
    given = shown(lists=[few, few])
    given.sample.lists = [dataclasses.replace(recorded, width=12, flow=np.ones((2, 12)))] * 2
    assert len([*show.lines(given, 9000, [1500, 2500])]) == 8 + 2 * 13


def test_decrease_of_successes_is_reported_with_both_shares() -> None:
    verdict = {
        "result": "degraded",
        "because": ["success"],
        "success": {"offline": 0.975, "online": 0.5},
        "p_failures": 0.0123,
        "loss": 1.0,
        "p_loss": 0.5,
    }
    assert "| success 50 % instead of 97.5 % (p = 0.012) |" in summary._row(result(verdict=verdict))
    both = verdict | {"because": ["reward", "success"]}
    assert "| 1 (p = 0.5) |" in summary._row(result(verdict=both))
