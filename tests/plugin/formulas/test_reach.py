"""Whether an episode is long enough for each part of a formula, by the instants that its operators refer to."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import pytest

from pytest_tarl.formulas.reach import unjudged
from pytest_tarl.formulas.signals import NANOSECONDS

pytest.importorskip("rtamt")
PAST = "a part of it looks back from the beginning of the episode: put always or eventually before it"
START = "it is evaluated at the beginning of the episode only: put always or eventually before it"


@cache
def tree(text: str) -> Any:
    from pytest_tarl.formulas import grammar

    return grammar.tree(text, ("x", "y"))


def late(seconds: float) -> str:
    return f"a part of it is evaluated after {seconds:g} s at the earliest"


@pytest.mark.parametrize(
    ("text", "ends", "expected"),
    [
        ("x > 0", math.inf, START),
        ("x > 0 and y > 0", math.inf, START),
        ("always (x > 0)", 0, ""),
        ("x > 0 or always (y > 0)", 0, ""),
        ("always[2:5] (x > 0)", 2, ""),
        ("always[2:5] (x > 0)", 1.5, late(2)),
        ("eventually[2:5] (always[3:4] (x > 0))", 5, ""),
        ("eventually[2:5] (always[3:4] (x > 0))", 4, late(5)),
        ("not (eventually[3:4] (x > 0))", 2, late(3)),
        ("(always (x > 0)) and (eventually[3:4] (y > 0))", 2, late(3)),
        ("(x > 0) until[2:5] (y > 0)", 2, ""),
        ("(x > 0) until[2:5] (y > 0)", 1, late(2)),
        ("(eventually[3:4] (x > 0)) until[0:1] (y > 0)", 2, late(3)),
        ("(x > 0) until[2:3] (eventually[2:3] (y > 0))", 3, late(4)),
        ("once (x > 0)", 9, PAST),
        ("historically (x > 0)", 9, PAST),
        ("always (once (x > 0))", 9, ""),
        ("always (once[2:3] (x > 0))", 2, ""),
        ("always (once[2:3] (x > 0))", 1, PAST),
        ("always[0:1] (once[2:3] (x > 0))", 9, PAST),
        ("always[0:2] (once[2:3] (x > 0))", 9, ""),
        ("always ((x > 0) since[2:3] (y > 0))", 2, ""),
        ("always ((x > 0) since[2:3] (y > 0))", 1, PAST),
        ("(x > 0) since (y > 0)", 9, PAST),
    ],
)
def test_formula_parts_must_end_within_the_episode(text: str, ends: float, expected: str) -> None:
    assert unjudged(tree(text), ends * NANOSECONDS) == expected


@pytest.mark.parametrize(
    "text", ["always[2:5] (x > 0)", "(x > 0) until[2:5] (y > 0)", "always (once[2:3] (x > 0))"]
)
def test_endless_episode_evaluates_every_part_of_a_formula(text: str) -> None:
    assert unjudged(tree(text)) == ""
