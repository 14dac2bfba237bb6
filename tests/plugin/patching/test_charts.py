"""Scales on which constants are changed: the distance of a share from 1, and a term added to an offset."""

from __future__ import annotations

import pytest

from pytest_tarl.patching.charts import SHARE, Chart, Scale, distance, offset, step_to
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
def test_step_on_a_scale_can_be_recovered(chart: Chart, value: float, step: float, moved: float) -> None:
    mutation = stepped(operand(value), step, chart, mutations)
    assert mutation is not None
    assert mutation.value == pytest.approx(moved, rel=1e-3)
    assert chart.step(value, moved) == pytest.approx(step)


def test_step_that_changes_the_sign_is_not_applied() -> None:
    for chart in (SHARE, offset(0.3)):
        assert stepped(operand(0.9), 1.0, chart, mutations) is None
        assert stepped(operand(0.9), -1.0, chart, mutations) is None
    assert SHARE.step(0.9, 1.0) is None


@pytest.mark.parametrize(
    ("step", "moved"), [(1.0, 0.0), (1.5, 0.5), (5.0, 4.0), (0.5, -1.0), (0.2, -4.0), (2 / 3, -0.5)]
)
def test_steps_up_and_down_are_equal_multiples_of_the_size(step: float, moved: float) -> None:
    assert distance(step) == pytest.approx(moved)
    assert step_to(moved) == pytest.approx(step)


def test_scales_are_positive_and_have_two_digits() -> None:
    assert (offset(-0.01234), offset(3.0).size, Chart(Scale.SHIFT).size) == (
        Chart(Scale.SHIFT, 0.012),
        3.0,
        1.0,
    )


@pytest.mark.parametrize("step", [0.0, -0.5])
def test_negative_step_has_no_factor(step: float) -> None:
    assert SHARE.factor(0.5, step) is None
    assert offset(1.0).factor(0.5, step) is None
    assert SHARE.factor(0.0, 2.0) is None
    assert SHARE.factor(0.5, 0.5) == 0.0
    assert SHARE.step(0.5, 1.5) is None
