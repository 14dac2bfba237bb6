"""The text of `tarl fleet`, line by line, for answers written down by hand."""

from __future__ import annotations

from dataclasses import replace
from datetime import date
from math import inf, nan

import pytest

from pytest_tarl.fleet import decomposition_words, repair_effect_words, words
from pytest_tarl.fleet.clusters import Cluster, Clusters
from pytest_tarl.fleet.components import Component
from pytest_tarl.fleet.decomposition import Decomposition
from pytest_tarl.fleet.mission_groups import Judged
from pytest_tarl.fleet.question import Mission, Question
from pytest_tarl.model import Bound
from tests.plugin.fleet.answers import (
    DAY,
    answer,
    bound,
    effect,
    evidence,
    group,
    robot,
    robots,
    status,
    unknown,
)

PLACE = ((2, 0), (2, 1))


def test_fleet_without_alarms_is_a_table_and_three_sentences() -> None:
    assert [*words.lines(answer())] == [
        "data: 40 missions of 1 robot, compared with 10 episodes of test_walk.py::test_walk",
        "",
        "  site   missions  robots  pass rate          mean reward                      verdict           where",
        "  north  40        4       75.0 % (60 to 85)  2.5 (2.25 to 2.75, approximate)  too few missions",
        "",
        "0 of 1 groups: changed over time (false discovery rate at most 10 % for each kind of evidence)",
        "",
        "0 of 1 robot: missions differ from the recording (false discovery rate at most 10 %)",
        (
            "0 of 1 robot: missions fall below a recorded bound (false discovery rate at most 10 % plus the risk that "
            "a recorded bound is wrong)"
        ),
        "",
        "note: ranges are one-sided bounds, each at 95 %; p is corrected for 1 group (Holm).",
        (
            "note: the false discovery rates assume that the number of a robot's missions does not "
            "depend on how they went."
        ),
    ]


def test_the_first_line_counts_robots_and_names_the_day() -> None:
    two = robots(robot("r1"), robot("r2"))
    found = answer(question=Question("data", since=date(2026, 3, 1)), missions=1234, robots=two)
    assert next(words.lines(found)).startswith("data: 1,234 missions of 2 robots since 2026-03-01, compared")


def test_no_group_is_tested_without_group_columns() -> None:
    found = answer(question=Question("data", by=()), groups=(group(),))
    assert not [line for line in words.lines(found) if "changed in time" in line]


@pytest.mark.parametrize(
    ("result", "expected"),
    [
        (None, "too few missions"),
        ("degraded", "degraded by 1.5 (p 0.004)"),
        ("drifted", "drifted (p 0.03)"),
        ("no difference", "no difference (p 0.03)"),
    ],
)
def test_degraded_group_states_its_loss_and_others_a_p_value(result: str | None, expected: str) -> None:
    assert words.verdict(group("north", result=result)) == expected


def test_the_table_names_the_region_with_new_cells() -> None:
    drifted = group("south", result="drifted", cells=((2, 0),))
    found = answer(groups=(replace(drifted, region=replace(drifted.region, novel=((2, 1),))),))
    assert [*words.lines(found)][3].endswith("drifted (p 0.03)  x 2-3")


def test_changed_group_uses_the_test_with_most_evidence() -> None:
    told = status(
        evidence(2.0, 7, 3 * DAY), PLACE, evidence(1.0, 4, 2 * DAY), None, evidence(3.0, 9, 5 * DAY)
    )
    for world, limit, log2, mission, day in ((12.0, 11.9, "2^12", 7, 4), (12.0, 12.0, "2^12", 9, 6)):
        one = robot("north", world, limit, told)
        found = answer(onsets=robots(one, drifted=(one,)))
        lines = [*words.lines(found)]
        assert lines[5].startswith("1 of 1 groups: changed over time (")
        assert lines[5].endswith("):")
        assert lines[6] == (
            f"  north: 9 of 10 missions passed, evidence {log2}, changed before mission {mission} "
            f"(1970-01-0{day} 00:00), x 2-3"
        )


def test_groups_with_more_evidence_come_first() -> None:
    every = [robot("a", 3.0, 1.0), robot("b", 1.0, 5.0), robot("c", 3.0, 2.0), robot("d")]
    found = answer(onsets=robots(*every, drifted=(every[2], every[0]), below=(every[1],)))
    named = [
        line.split(":")[0] for line in words.lines(found) if "evidence " in line and line.startswith("  ")
    ]
    assert named == ["  b", "  a", "  c"]


@pytest.mark.parametrize(("log2", "expected"), [(9.9, "955"), (10.0, "2^10"), (-1.0, "0.5"), (33.4, "2^33")])
def test_evidence_above_a_thousand_is_a_power_of_two(log2: float, expected: str) -> None:
    one = robot("r1", log2)
    found = answer(robots=robots(one, drifted=(one,)))
    assert f"  r1: 9 of 10 missions passed, evidence {expected}" in [*words.lines(found)]


def test_named_robots_are_counted_and_at_most_twenty_listed() -> None:
    every = tuple(robot(f"r{n:02}", 9.0, 5.0) for n in range(21))
    for count, more in ((20, []), (21, ["  the first 20; --json lists all"])):
        lines = [*words.lines(answer(robots=robots(*every, drifted=every[:count])))]
        start = lines.index(
            f"{count} of 21 robots: missions differ from the recording (false discovery rate at most 10 %), most "
            "evidence first:"
        )
        assert lines[start + 1 : start + 1 + len(more)] == more
        assert [line.split(":")[0] for line in lines if "evidence 512" in line] == [
            f"  r{n:02}" for n in range(20)
        ]
        below = [*words.lines(answer(robots=robots(*every, below=every[:count])))]
        assert sum("evidence 32" in line for line in below) == 20


def test_robot_below_a_bound_is_described_by_it() -> None:
    told = status(evidence(2.0, 7, 3 * DAY), (), evidence(1.0, 4, None))
    one = robot("r1", 5.0, 4.0, told)
    lines = [*words.lines(answer(robots=robots(one, below=(one,))))]
    assert "  r1: 9 of 10 missions passed, evidence 16, changed before mission 4 (no time)" in lines


def test_cluster_is_printed_with_place_and_residual() -> None:
    names = tuple(f"r{n:02}" for n in range(22))
    found = Clusters((Cluster(names, PLACE, (-0.5, -1.0)), Cluster(("s1",), (), ())), ("u1", "u2"), 1500)
    lines = [*words.lines(answer(clusters=found))]
    start = lines.index("Robots with similar drifts")
    assert lines[start - 1] == ""
    assert (
        lines[start + 1]
        == f"  22 robots ({', '.join(names[:20])} and 2 more): x 2-3, -0.75 reward a step there"
    )
    assert lines[start + 2] == "  1 robot (s1): no common cell"
    assert lines[start + 3] == "  2 robots (u1, u2): no cell stands out"
    assert lines[start + 4] == "  1,500 further robots with less evidence were not compared"
    twenty = [*words.lines(answer(clusters=Clusters((), names[:20])))]
    assert f"  20 robots ({', '.join(names[:20])}): no cell stands out" in twenty
    only = [*words.lines(answer(clusters=Clusters((), ("u1",))))]
    assert "  1 robot (u1): no cell stands out" in only
    assert not [line for line in only if "further robots" in line]


def test_formulas_with_more_violations_come_first() -> None:
    groups = (
        group("north", formulas=(Judged("always(x > 1)", 40, 10, -0.5), Judged("kept", 40, 0, 0.125))),
        group("south", formulas=(Judged("always(x > 1)", 1000, 500, -1.2345),)),
    )
    lines = [*words.lines(answer(groups=groups, onsets=robots(robot("north"), robot("south"))))]
    start = lines.index("always(x > 1): violated by 500 of 1,000 missions in south, least robustness -1.23")
    assert lines[start - 1] == ""
    assert lines[start + 1] == "always(x > 1): violated by 10 of 40 missions in north, least robustness -0.5"
    assert not [line for line in lines if line.startswith("kept")]
    kept = (group("north", formulas=(Judged("kept", 40, 0, 0.125),)),)
    assert "No mission violates a formula." in [*words.lines(answer(groups=kept))]
    assert "No mission violates a formula." not in [*words.lines(answer())]


def test_robot_report_lists_its_worst_missions() -> None:
    lowest = (Mission(1.5 * DAY, False, -12.3456789, 7), Mission(0.0, True, 3.0, 1))
    lines = [*words.lines(answer(question=Question("data", by=("site",), robot="r1"), lowest=lowest))]
    start = lines.index("missions of r1 with the lowest reward")
    assert lines[start + 1] == "  1970-01-02 12:00  failed  reward -12.3457  7 steps"
    assert lines[start + 2] == "  no time  passed  reward 3  1 steps"


def test_each_note_appears_only_if_its_condition_holds() -> None:
    quiet = [*words.notes(answer())]
    assert len(quiet) == 2
    groups = (group("a", compared=39, outside=1200), group("b", outside=34), group("c"))
    found = [*words.notes(answer(groups=groups, copies=1001, left_out={"of another test": 2000}))][2:]
    assert found == [
        "note: if a group has more than 1,000 missions, its verdict uses 1,000 of them, chosen by their digests.",
        (
            "note: 1,234 totals lie outside the recording's total_range; the bounds of their groups' "
            "means are approximate."
        ),
        "note: 1,001 missions are in the data set more than once; each is counted once.",
        "note: 2,000 missions of another test cannot be compared and are left out.",
    ]


def test_repair_effect_is_printed_with_intervals() -> None:
    some = (
        effect(values=("wet",)),
        replace(effect("guard-2", -0.5, -0.75), reward_bound=bound(-0.75, -0.25)),
    )
    assert [*repair_effect_words.lines(some, {"guard-1": "mud"})] == [
        (
            "Repairs, against missions without a repair at the same site in the same week (simultaneous "
            "intervals at 95 %)"
        ),
        (
            "  guard-1 at wet: helps, reward +0.5 (+0.25 to +0.75), pass rate +5.0 points (+1 to +9), 1,200 missions "
            "of 12 robots with it and 2,400 of 24 without"
        ),
        (
            "  guard-2: harms, reward -0.5 (-0.75 to -0.25), pass rate +5.0 points (+1 to +9), 1,200 missions of 12 "
            "robots with it and 2,400 of 24 without"
        ),
        "  guard-1 was accepted in simulation for the drift mud",
    ]


def test_a_repair_without_an_interval_says_why() -> None:
    few = effect(reward_bound=bound(-inf, inf), success_bound=bound(-inf, inf))
    lines = [*repair_effect_words.lines((unknown(), few), {})]
    assert lines[1:] == [
        "  guard-1: not comparable (no missions without a repair at the same site in the same week)",
        (
            "  guard-1: too few robots (an interval needs 4 robots with the repair and 4 without), "
            "reward +0.5, pass rate +5.0 "
            "points, 1,200 missions of 12 robots with it and 2,400 of 24 without"
        ),
    ]


@pytest.mark.parametrize(
    ("found", "expected"), [(bound(0.01, 0.09), "+1 to +9"), (Bound(-inf, inf, 0.95, "t", False, 0), "")]
)
def test_confidence_interval_has_the_unit_of_its_score(found: Bound, expected: str) -> None:
    assert repair_effect_words.interval(found, 100) == expected


def component(name: str, variance: float, **changes: float) -> Component:
    return replace(Component(name, variance, variance / 2, variance * 2, 4), **changes)  # type: ignore[arg-type]


def test_each_variance_component_is_printed_with_its_lowest_values() -> None:
    site = replace(component("site", 0.3), effects=(-0.1, 0.4, -0.2, -0.1))
    version = component("version", -0.1, low=0.0, high=0.0)
    parts = Decomposition(
        "week",
        (
            version,
            site,
            component("season", 0.1, levels=1),
            component("robot", nan),
            component("mission", 0.5),
        ),
        (("1", "2"), ("d", "c", "b", "a"), ("w",)),
    )
    assert [*decomposition_words.lines(parts)] == [
        "Variance of a mission's reward, 0.9, by source (95 % intervals)",
        "  version           0.0 %  0 (0 to 0)",
        "  site             33.3 %  0.3 (0.15 to 0.6), lowest: b -0.2, a -0.1",
        "  season (week)   only one",
        "  robot           cannot be told apart from the others",
        "  within a robot   55.6 %  0.5 (0.25 to 1)",
    ]


def test_no_lowest_value_is_named_if_variance_may_be_zero() -> None:
    levels = ("a", "b", "c", "d")
    site = replace(component("site", 0.3), effects=(-0.1, 0.4, -0.2, -0.1))
    assert decomposition_words.lowest(site, levels) == "c -0.2, a -0.1"
    assert decomposition_words.lowest(replace(site, low=0.0), levels) == ""
    assert decomposition_words.lowest(replace(site, high=inf), levels) == ""
    assert decomposition_words.lowest(replace(site, effects=()), ()) == ""
    assert decomposition_words.lowest(replace(site, effects=(0.3, -0.3, 0.0, 0.0)), levels) == "b -0.3"


def test_zero_variance_gives_zero_shares() -> None:
    still = component("mission", 0.0, low=0.0, high=0.0)
    parts = Decomposition("week", (still, still), ())
    assert [*decomposition_words.lines(parts)][1] == "  within a robot    0.0 %  0 (0 to 0)"
