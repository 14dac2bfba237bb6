"""Each operator and the instant of loss, by the definition: few signals, so that each takes milliseconds."""

from __future__ import annotations

import pytest

pytest.importorskip("rtamt")

from pytest_tarl.formulas.parsing import formula
from pytest_tarl.formulas.robustness import course, lost_at, robustness
from pytest_tarl.formulas.signals import Timeline
from tests.plugin.formulas import oracle
from tests.plugin.formulas.test_meaning import NAMES, read, samples

ORDER = [4, 8, 12, 16, 20]


@pytest.mark.parametrize(
    ("text", "values", "lost"),
    [
        ("always (x > 0)", [(0, 1.0)], None),
        ("always (x > 0)", [(0, -1.0)], 4),
        ("always (x > 0)", [(0, 1.0), (7, -1.0)], 8),
        ("always (x > 0)", [(0, 1.0), (8, -1.0)], 8),
        ("always (x > 0)", [(0, 1.0), (9, -1.0)], 12),
        ("always (x > 0)", [(0, 1.0), (20, -1.0)], 20),
        ("always (x > 0)", [(0, 1.0), (21, -1.0)], None),
        ("eventually (x > 0)", [(0, -1.0)], None),
        ("eventually[0:9ns] (x > 0)", [(0, -1.0)], 12),
        ("eventually[0:9ns] (x > 0)", [(0, -1.0), (9, 1.0)], None),
        ("(x > 0) -> always (y > 0)", [(0, 1.0), (6, -1.0)], None),
        ("(x > 0) until (y > 0)", [(0, 1.0), (6, -1.0)], 8),
    ],
)
def test_formula_is_lost_when_no_future_can_satisfy_it(
    text: str, values: list[tuple[int, float]], lost: int | None
) -> None:
    line = Timeline(NAMES)
    line.give("y", 1.0 if "->" in text else -1.0, 0)
    for time, value in values:
        line.give("x", value, time)
    assert lost_at(course(formula("here", text, NAMES), line.samples(NAMES)), ORDER) == lost
    assert lost_at(course(formula("here", text, NAMES), line.samples(NAMES)), []) is None


WORLDS = [
    oracle.World({"x": [1.0, 2.0, -1.0, 3.0, -2.0, 1.0], "y": [-1.0, -2.0, 2.0, -3.0, 1.0, -1.0]}, 5),
    oracle.World({"x": [-2.0, -2.0, 1.0, 1.0, 3.0, -1.0], "y": [3.0, -1.0, -1.0, 2.0, -2.0, 0.0]}, 5),
    oracle.World({"x": [0.0, 1.0, 1.0, -3.0, 2.0, 2.0], "y": [1.0, 0.0, -2.0, -1.0, 3.0, -3.0]}, 5),
]
WINDOWS = (None, (0, 0), (0, 2), (1, 3), (2, 2))
X, Y = (">", "x", 0), (">", "y", 0)
INNER = [
    *[(kind, window, X) for kind in ("always", "eventually", "once", "historically") for window in WINDOWS],
    *[(kind, window, X, Y) for kind in ("until", "since") for window in WINDOWS],
]


@pytest.mark.parametrize("outer", ["", "always", "eventually"])
@pytest.mark.parametrize("inner", INNER, ids=lambda inner: f"{inner[0]}{inner[1] or ''}")
def test_each_temporal_operator_equals_its_definition(inner: oracle.Tree, outer: str) -> None:
    """Generated formulas seldom have an operator of the past that no earlier value can decide."""
    for tree in (inner, ("not", inner)):
        whole = (outer, None, tree) if outer else tree
        parsed = read(whole)
        if parsed is None:
            assert inner[0] in ("once", "historically", "since")
            assert not outer
            continue
        for world in WORLDS:
            assert robustness(course(parsed, samples(world)), world.end) == oracle.value(whole, world)
