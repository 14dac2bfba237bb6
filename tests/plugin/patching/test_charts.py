"""Scales on which constants are changed: the distance of a share from 1, and a term added to an offset."""

from __future__ import annotations

import pytest

from pytest_tarl.patching.charts import SHARE, Chart, offset
from pytest_tarl.patching.mutate import mutations, stepped
from tarl_lint.model import Operand, SiteId, Span


def operand(value: float) -> Operand:
    span = Span("node.py", 3, 5, 3, 9)
    return Operand(SiteId("node", "run", "line 3"), span, str(value), value, span)


@pytest.mark.parametrize(
    ("chart", "value", "step", "moved"),
    [
        (SHARE, 0.95, 5.0, 0.99),
        (SHARE, 0.95, 0.5, 0.9),
        (offset(0.03), -0.012, 5.0, 0.108),
        (offset(0.03), -0.012, 0.2, -0.132),
        (offset(0.3), 0.0, 2.0, 0.3),
        (offset(0.3), 0.0, 0.5, -0.3),
    ],
)
def test_a_step_changes_a_constant_on_its_scale_and_can_be_recovered_from_the_change(
    chart: Chart, value: float, step: float, moved: float
) -> None:
    mutation = stepped(operand(value), step, chart, mutations)
    assert mutation is not None
    assert mutation.value == pytest.approx(moved, rel=1e-3)
    assert chart.step(value, moved) == pytest.approx(step)


def test_a_step_of_one_and_a_step_that_changes_the_sign_are_not_applied() -> None:
    for chart in (SHARE, offset(0.3)):
        assert stepped(operand(0.9), 1.0, chart, mutations) is None
        assert stepped(operand(0.9), -1.0, chart, mutations) is None
    assert SHARE.step(0.9, 1.0) is None
