"""Sentences and documents of stress runs, for curves written down by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from pytest_tarl import Drift
from pytest_tarl.stressing import json_result, words
from pytest_tarl.stressing.findings import (
    Curve,
    Executed,
    Failure,
    Share,
    Sobol,
    Statements,
    Stress,
    confirmed,
    failure,
)
from pytest_tarl.stressing.guarantee import (
    Evidence,
    Guarantee,
)
from pytest_tarl.stressing.rays import Ray, rays
from tests.plugin.stressing.worlds import space_of

SPACE = space_of(
    mud=Drift.range(0.0, 4.0, nominal=4.0),
    slope=Drift.range(-1.0, 1.0, nominal=0.0),
    camera=Drift.choice("up", "down", "left"),
)
GIVEN = Guarantee(0.9, 0.5, (10.0,) * 20, 1.0)
MUD, FLAT, STEEP, DOWN, LEFT = rays(SPACE, {})


def seen(margin: float, result: Any = None, episodes: int = 8) -> Evidence:
    """Return evidence with this result, by default a clear one."""
    told = result or ("fails" if margin < 0 else "holds")
    return Evidence(told, margin, episodes, episodes, 0.0, 0.0)


def curve(ray: Ray, margins: dict[float, float] | None = None, **changes: Any) -> Curve:
    """Return a complete curve with these margins."""
    found = {t: seen(margin) for t, margin in (margins or {}).items()}
    return replace(Curve(ray, found, swept=True), **changes)


def stress(*curves: Curve, **changes: Any) -> Stress:
    one = Stress("t.py::test_a", "world", 0, SPACE, GIVEN, 200, 150, curves)
    return replace(one, **changes)


GOOD = {0.25: 1.0, 0.5: 0.75, 0.75: -0.25, 1.0: -1.0}


def test_boundary_lies_where_the_margin_vanishes() -> None:
    found = curve(MUD, GOOD, confirmed=0.75).boundary
    assert found is not None
    assert (found.at, found.near, found.far, found.monotone) == (pytest.approx(0.6875), None, 0.75, True)
    held = curve(MUD, GOOD, confirmed=0.75, held=0.7).boundary
    assert held is not None
    assert (held.at, held.near) == (0.7, 0.7)
    beyond = curve(MUD, GOOD, confirmed=0.6, held=0.6).boundary
    assert beyond is not None
    assert (beyond.at, beyond.near) == (0.6, None)
    at_once = curve(MUD, {0.5: -3.0}, confirmed=0.5).boundary
    assert at_once is not None
    assert at_once.at == pytest.approx(0.125)  # the margin at nominal is 1
    option = curve(DOWN, {1.0: -1.0}, confirmed=1.0).boundary
    assert option is not None
    assert option.at == 1.0
    assert curve(MUD, GOOD).boundary is None
    assert curve(MUD, {1.0: 1.0}, confirmed=0.5).boundary is None


def test_monotone_curve_stays_failed() -> None:
    found = curve(MUD, GOOD)
    assert (found.failing, found.bracket, found.monotone) == ([0.75, 1.0], (0.5, 0.75), True)
    found.evidence |= {0.9: seen(0.0, "open"), 0.1: seen(-0.1, "open")}
    assert (found.failing, found.bracket, found.monotone) == ([0.1, 0.75, 1.0], (0.0, 0.1), False)
    assert curve(MUD, {0.5: 1.0}).bracket is None
    assert curve(MUD, {0.5: 1.0}).monotone


@pytest.mark.parametrize(
    ("one", "expected"),
    [
        (curve(FLAT, GOOD, confirmed=0.75),
         "No failure found while slope ≥ -0.688 (boundary not beyond -0.75, monotone: checked)."),
        (curve(FLAT, GOOD, confirmed=0.75, held=0.5),
         "No failure found while slope ≥ -0.688 (boundary -0.75 to -0.5 at 90 %, monotone: checked)."),
        (curve(FLAT, {0.5: -1.0, 1.0: 1.0}, confirmed=0.5),
         ("No failure found while slope ≥ -0.25 "
          "(boundary not beyond -0.5, not monotone: the guarantee holds again at larger drifts).")),
        (curve(FLAT, GOOD),
         "No failure confirmed while slope ≥ -1; suspicious from slope = -0.75 on."),
        (curve(FLAT, swept=False), "Not examined from 0 to -1."),
        (curve(FLAT, {1.0: 1.0}), "No failure found while slope ≥ -1, the end of the range."),
    ],
)  # fmt: skip
def test_each_side_of_a_range_has_its_sentence(one: Curve, expected: str) -> None:
    other = curve(STEEP, GOOD, confirmed=0.75)
    ((name, sentences),) = words.directions(stress(one, other))
    assert name == "slope"
    assert sentences[0] == expected
    assert sentences[1].startswith("No failure found while slope ≤ 0.688 (boundary not beyond 0.75")


def test_a_range_without_failures_is_not_affected() -> None:
    harmless = [curve(ray, {0.5: 1.0, 1.0: 1.0}, held=0.5) for ray in (FLAT, STEEP)]
    ((_, sentences),) = words.directions(stress(*harmless))
    assert sentences == [
        "Not affected by slope: no failure found from -1 to 1 (4 values).",
        "The guarantee holds while slope ≥ -0.5 and slope ≤ 0.5 (90 % each).",
    ]
    ((_, sentences),) = words.directions(stress(curve(FLAT, swept=False), curve(STEEP, swept=False)))
    assert sentences == ["Not examined."]
    half = [curve(FLAT, {1.0: 1.0}), curve(STEEP, swept=False)]
    ((_, sentences),) = words.directions(stress(*half))
    assert sentences == [
        "No failure found while slope ≥ -1, the end of the range.",
        "Not examined from 0 to 1.",
    ]


@pytest.mark.parametrize(
    ("one", "expected"),
    [
        (curve(DOWN, {1.0: -1.0}, confirmed=1.0), "Fails with camera='down'."),
        (curve(DOWN, {1.0: -1.0}), "No failure confirmed with camera='down', but the option is suspicious."),
        (
            curve(LEFT, {1.0: 1.0}, held=1.0),
            "No failure found with camera='left'; the guarantee holds (90 %).",
        ),
        (curve(LEFT, {1.0: 1.0}), "No failure found with camera='left'."),
        (curve(LEFT, swept=False), "Not examined with camera='left'."),
    ],
)
def test_each_option_has_its_sentence(one: Curve, expected: str) -> None:
    assert [*words.directions(stress(one))] == [("camera", [expected])]


def combined(**changed: float) -> Failure:
    return failure(SPACE, {**SPACE.nominal, **changed})


def test_combinations_are_printed_with_the_nearest_first() -> None:
    far, near = combined(mud=1.0, slope=0.5), combined(mud=3.0, camera=1.0)
    whole = [curve(ray, {1.0: 1.0}) for ray in (MUD, FLAT, STEEP, DOWN, LEFT)]
    assert [*words.together(stress(*whole, combinations=(near, far), tried=3))] == [
        "Fails with mud=1 and slope=0.5 (distance 0.79), although no failure was found with each change alone.",
        "Fails with mud=3 and camera='down' (distance 1), although no failure was found with each change alone.",
    ]
    assert [*words.together(stress(*whole, tried=3))] == [
        "No combination was found that fails although each of its changes alone passes (3 tried)."
    ]
    assert [*words.together(stress(*whole))] == []
    many = tuple(combined(mud=3.4 + n / 10, slope=0.1 + n / 50) for n in range(6))  # none contains another
    assert [*words.together(stress(*whole, combinations=many))][5:] == [
        "1 more failing combination is in the JSON result."
    ]


def test_containing_combinations_are_only_counted() -> None:
    near, aside = combined(mud=3.0, slope=0.3), combined(mud=3.5, slope=0.75)
    chain = [combined(mud=3.0 - n / 10, slope=0.3 + n / 50) for n in range(1, 6)]
    found = [*words.together(stress(combinations=(*chain, aside, near)))]
    assert [one.split(" (")[0] for one in found] == [
        "Fails with mud=3 and slope=0.3",
        "Fails with mud=3.5 and slope=0.75",
        "5 more failing combinations are in the JSON result.",
    ]
    document = json_result.document(stress(combinations=(*chain, aside, near)))
    assert len(document["failures"]) == 7
    inside: dict[str, Any] = {"mud": (0.0, 4.0), "slope": (-1.0, 1.0)}
    (promised,) = words.broken_promises(stress(combinations=(*chain, near), must_hold=inside))
    assert (
        promised == "The guarantee fails with mud=3 and slope=0.3, but must_hold includes this combination."
    )


def test_json_lists_farther_failures() -> None:
    one = curve(MUD, {0.5: -1.0})
    for t in (0.9, 0.6, 0.5, 0.505):
        one.confirm(t)
    assert (one.confirmed, one.farther) == (0.5, (0.505, 0.6, 0.9))
    found = stress(one)
    assert [failure.point["mud"] for failure in found.failures] == [MUD.value(0.5)]
    document = json_result.document(found)
    assert [failure["drift"]["mud"] for failure in document["failures"]] == [
        MUD.value(0.5),
        MUD.value(0.6),
        MUD.value(0.9),
    ]
    assert document["directions"][0]["boundary"]["failed_at"] == MUD.value(0.5)


def test_expected_failure_must_be_clearly_nearer() -> None:
    near, nearer = combined(mud=3.0, slope=0.5), combined(mud=3.6, slope=0.25)  # distances 0.35 and 0.16
    told = "The guarantee probably already fails with mud=3.6 and slope=0.25 (distance 0.16); this is not confirmed."
    alone = "although no failure was found with each change alone"
    confirmed_one = f"Fails with mud=3 and slope=0.5 (distance 0.35), {alone}."
    assert [*words.together(stress(expected=(nearer, near), tried=3))] == [told]
    assert [*words.together(stress(combinations=(near,), expected=(nearer, near)))] == [confirmed_one, told]
    assert [*words.together(stress(combinations=(near,), expected=(near,)))] == [confirmed_one]
    document = json_result.document(stress(combinations=(near,), expected=(nearer,)))
    assert [one["drift"] for one in document["expected_failures"]] == [
        {"mud": 3.6, "slope": 0.25, "camera": "up"}
    ]


def test_an_expected_failure_of_one_direction_is_printed_only_if_the_direction_has_no_boundary() -> None:
    alone, both = combined(mud=2.0), combined(mud=3.0, slope=1.0)  # distances 0.5 and 0.56
    bounded, suspicious = curve(MUD, GOOD, confirmed=0.75), curve(MUD, GOOD)
    told = "The guarantee probably already fails with mud={} (distance {}); this is not confirmed."
    assert [*words.together(stress(suspicious, expected=(alone, both)))] == [told.format("2", "0.5")]
    assert [*words.together(stress(bounded, expected=(alone, both)))] == [
        told.format("3 and slope=1", "0.56")
    ]
    assert stress(bounded, expected=(alone,)).nearer is None


@pytest.mark.parametrize(
    ("changed", "alone"),
    [
        (curve(MUD, {0.75: -1.0}), False),
        (curve(MUD, {0.76: -1.0}), True),
        (curve(MUD, {1.0: 1.0}, swept=False), False),
        (curve(STEEP, {0.5: -1.0}), False),
        (curve(FLAT, {0.5: -1.0}), True),  # a failure on the other side of the range
        (curve(DOWN, {1.0: -1.0}), True),
    ],
)
def test_direction_is_safe_if_no_smaller_change_of_it_fails(changed: Curve, alone: bool) -> None:
    one = combined(mud=1.0, slope=0.5)
    others = [curve(ray, {1.0: 1.0}) for ray in (MUD, FLAT, STEEP, DOWN, LEFT) if ray is not changed.ray]
    (told,) = words.together(stress(*others, changed, combinations=(one,)))
    assert told.endswith("although no failure was found with each change alone.") is alone


def test_largest_variance_share_is_printed_first() -> None:
    shares = (Share("a", -0.001, 0.1, 0.25, 0.05), Share("b", 0.5, 0.1, 0.75, 0.1))
    (told,) = words.sobol_words(stress(sobol=Sobol(99, shares)))
    assert told == (
        "Shares of the margin's variance over the space: b 50 % alone, 75 % ± 10 % with combinations; "
        "a 0 % alone, 25 % ± 5 % with combinations (Sobol indices, 99 episodes)."
    )
    still = tuple(replace(one, total=0.0) for one in shares)
    assert [*words.sobol_words(stress(sobol=Sobol(99, still)))] == [
        "The margin varies nowhere in the space (99 episodes)."
    ]
    assert [*words.sobol_words(stress())] == []


def test_statements_that_ran_only_in_failures_are_listed() -> None:
    only = tuple(Executed("n.py", n, f"x = {n}", 9 - n) for n in range(6))
    told = [*words.statement_words(stress(statements=Statements(9, 30, only)))]
    assert told[0] == "n.py:0 ran in 9 of 9 failing episodes and in none of 30 others: x = 0"
    assert told[5:] == ["1 more statement that ran only in failures is in the JSON result."]
    assert len([*words.statement_words(stress(statements=Statements(9, 30, only[:5])))]) == 5
    assert [*words.statement_words(stress(statements=Statements(9, 30, ())))] == [
        "No statement ran only in failures (9 failing episodes, 30 others)."
    ]
    assert [*words.statement_words(stress())] == []


def test_the_lines_of_a_run_have_one_label_each() -> None:
    told = [*words.lines(stress(curve(FLAT, GOOD), curve(STEEP, GOOD), tried=1, ended="budget"))]
    assert told == [
        "t.py::test_a[world]: stress, 150 episodes",
        "  guarantee  At least 90 % of the episodes pass, and the mean reward is at most 0.5 below the recorded one.",
        "  slope      No failure confirmed while slope ≥ -1; suspicious from slope = -0.75 on.",
        "             No failure confirmed while slope ≤ 1; suspicious from slope = 0.75 on.",
        "  together   No combination was found that fails although each of its changes alone passes (1 tried).",
        "  The budget of 200 episodes did not suffice for the whole search: raise --tarl-stress-budget.",
    ]
    assert len([*words.lines(stress(curve(FLAT, GOOD), ended="nominal"))]) == 3
    assert [*words.ended_words(stress(ended="interrupted", seconds=2.5))] == [
        "Interrupted after 150 episodes: these are the results so far.",
        "A time limit is not reproducible; for the same number of episodes, use --tarl-stress-budget 150.",
    ]
    assert words.budget_words(stress(seconds=2.5)) == "2.5 s"


@pytest.mark.parametrize(
    ("one", "must_hold", "broken"),
    [
        (curve(MUD, confirmed=0.5), {"mud": (2.0, 4.0)}, True),
        (curve(MUD, confirmed=0.5), {"mud": (2.1, 4.0)}, False),
        (curve(MUD, confirmed=0.5), {"slope": (-1.0, 1.0)}, False),
        (curve(MUD), {"mud": (0.0, 4.0)}, False),
        (curve(STEEP, confirmed=0.5), {"slope": (-1.0, 0.5)}, True),
        (curve(STEEP, confirmed=0.5), {"slope": (-1.0, 0.4)}, False),
        (curve(DOWN, confirmed=1.0), {"camera": ("down",)}, True),
        (curve(DOWN, confirmed=1.0), {"camera": ("left",)}, False),
    ],
)
def test_failure_inside_a_must_hold_range_violates_it(
    one: Curve, must_hold: dict[str, Any], broken: bool
) -> None:
    assert bool(words.broken_promises(stress(one, must_hold=must_hold))) is broken


def test_suspicious_must_hold_value_is_undecided() -> None:
    found = stress(curve(MUD, GOOD), must_hold={"mud": (1.0, 4.0)})
    assert words.undecided_promises(found) == [
        "Undecided: mud=1 is within must_hold and suspicious, but no failure was confirmed."
    ]
    assert [line for line in words.lines(found) if line.startswith("  must_hold  Undecided: mud=1")]
    assert words.undecided_promises(replace(found, must_hold={"mud": (1.1, 4.0)})) == []
    assert (
        words.undecided_promises(stress(curve(MUD, GOOD, confirmed=0.75), must_hold={"mud": (1.0, 4.0)}))
        == []
    )


@pytest.mark.parametrize(
    ("must_hold", "broken"),
    [
        ({"mud": (2.0, 4.0), "slope": (-0.5, 0.5)}, True),
        ({"mud": (2.0, 4.0), "slope": (-0.5, 0.1)}, False),  # outside in one direction
        ({"mud": (2.0, 4.0)}, False),  # only the nominal slope is promised
        ({}, False),
    ],
)
def test_inner_failing_combination_violates_must_hold(must_hold: dict[str, Any], broken: bool) -> None:
    found = stress(curve(MUD, GOOD), combinations=(combined(mud=3.0, slope=0.25),), must_hold=must_hold)
    told = "The guarantee fails with mud=3 and slope=0.25, but must_hold includes this combination."
    assert words.broken_promises(found) == ([told] if broken else [])


def test_combination_with_an_option_is_checked_against_must_hold() -> None:
    found = stress(combinations=(combined(mud=3.0, camera=1.0),))
    inside = replace(found, must_hold={"mud": (2.0, 4.0), "camera": ("down",)})
    assert "mud=3 and camera='down'" in words.broken_promises(inside)[0]
    assert not words.broken_promises(replace(inside, must_hold={"mud": (2.0, 4.0), "camera": ("left",)}))


def test_failures_are_sorted_by_their_distance_from_nominal() -> None:
    both = combined(mud=3.9, slope=0.05)
    found = stress(
        curve(MUD, confirmed=0.5), curve(FLAT, GOOD), curve(DOWN, confirmed=1.0), combinations=(both,)
    )
    assert [one.names for one in found.failures] == [("mud", "slope"), ("mud",), ("camera",)]
    assert [one.distance for one in confirmed(found.curves)] == [0.5, 1.0]


def test_the_json_document_lists_the_values_of_each_direction() -> None:
    found = json_result.document(
        stress(curve(MUD, GOOD, confirmed=0.75, held=0.5), curve(DOWN, {1.0: -1.0}), seconds=2.0)
    )
    mud, down = found["directions"]
    assert (mud["nominal"], mud["farthest"], mud["kind"], mud["held_up_to"]) == (4.0, 0.0, "range", 2.0)
    assert mud["boundary"] == {
        "estimate": pytest.approx(1.25),
        "held_up_to": 2.0,
        "failed_at": 1.0,
        "confidence": 0.9,
        "monotone": True,
    }
    assert [one["value"] for one in mud["margins"]] == [3.0, 2.0, 1.0, 0.0]
    assert (down["nominal"], down["farthest"], down["kind"]) == ("up", "down", "choice")
    assert (down["boundary"], down["suspicious"], mud["suspicious"]) == (None, True, False)
    assert (found["budget"], found["seconds"], found["statements"]) == (None, 2.0, None)
