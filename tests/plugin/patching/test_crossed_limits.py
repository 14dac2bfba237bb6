"""A changed limit must not lie beyond the opposite limit."""

from __future__ import annotations

import ast

import pytest

from pytest_tarl.patching.crossed_limits import crosses
from pytest_tarl.patching.document import document


def limit(text: str, code: str, value: float) -> bool:
    source = document("node.py", f"y = {text}\n")
    places = [node for node in source.expressions.values() if ast.unparse(node) == code]
    return crosses(source, places[0], value)


CROSSED = [
    ("max(0.0, min(1.0, x))", "0.0", 1.2),
    ("max(0.0, min(1.0, x))", "1.0", -0.1),
    ("min(1.0, max(0.0, x))", "0.0", 1.2),
    ("min(max(x, -1.0), 2.0)", "2.0", -3.0),
    ("max(-1.0, min(1.0, x))", "-1.0", 1.5),
    ("np.clip(x, -1.0, 1.0)", "1.0", -1.1),
    ("self.clamp(x, 0, 10)", "0", 11),
    ("2 * max(0.1, min(0.5, a + b)) + c", "0.5", 0.05),
]
KEPT = [
    ("max(0.0, min(1.0, x))", "0.0", 1.0),
    ("max(0.0, min(1.0, x))", "1.0", 7.0),
    ("max(0.0, min(limit, x))", "0.0", 5.0),  # the opposite limit is not known
    ("max(0.0, x)", "0.0", 5.0),
    ("max(0.0, max(1.0, x))", "0.0", 5.0),  # both are lower limits
    ("max(0.0, min(1.0, x, z))", "0.0", 5.0),
    ("np.clip(x, -1.0, 1.0)", "-1.0", -9.0),
    ("np.clip(3.0, -1.0, 1.0)", "3.0", 9.0),  # the clamped value itself
    ("min(1.0, 2.0 * x)", "2.0", 0.5),
    ("max(0.0, min(1.0, 4.0 * x))", "4.0", 90.0),
    ("hypot(1.0, x)", "1.0", 9.0),
    ("max(0.0, x, min(1.0, z))", "0.0", 5.0),
    ("max(0.0, min(1.0, x)) + 2.0", "2.0", 5.0),
    ("clip(x, 1.0)", "1.0", -5.0),
]


@pytest.mark.parametrize(("text", "code", "value"), CROSSED)
def test_two_limits_cross_if_one_passes_the_other(text: str, code: str, value: float) -> None:
    assert limit(text, code, value)


@pytest.mark.parametrize(("text", "code", "value"), KEPT)
def test_other_values_and_places_do_not_cross(text: str, code: str, value: float) -> None:
    assert not limit(text, code, value)
