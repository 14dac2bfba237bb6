"""The sweep moves constants on their own scales, too, and refines them there."""

from __future__ import annotations

import pytest

from pytest_tarl.patching.charts import SHARE, Chart, offset
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import charted, units
from tarl_lint.model import Operand, SiteId, Span


def operand(line: int, value: float) -> Operand:
    span = Span("node.py", line, 5, line, 9)
    return Operand(SiteId("node", "run", f"line {line}"), span, str(value), value, span)


@pytest.mark.parametrize(
    ("value", "chart", "low", "high"),
    [
        (0.95, SHARE, 0.992, 0.9955),
        (-0.012, offset(0.03), 0.05, 0.06),
        (0.0, offset(20.0), 40.0, 60.0),
        (0.0, offset(0.01), -0.02, -0.015),
    ],
)
def test_the_search_finds_a_value_that_no_factor_approaches(
    value: float, chart: Chart, low: float, high: float
) -> None:
    wanted, others = operand(3, value), [operand(line, 2.0) for line in range(4, 12)]
    size = abs(value - low)

    def run(candidate: Candidate, seed: int) -> Outcome:
        value_now = next((float(m.value) for m in candidate.mutations if m.operand == wanted), value)
        beyond = max(low - value_now, value_now - high, 0.0)
        total = 10.0 - 10.0 * min(beyond / size, 1.0)
        return Outcome(total, total >= 10.0)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(6)), 9.9, 9.9, 0.0, passing=True)
    trials = Trials(run, 120)
    search = Sweep([wanted, *others], mutations, (ALWAYS,), trials, goal, charts={wanted: chart})
    (mutation,) = next(search.candidates()).mutations
    assert mutation.operand == wanted
    assert low <= mutation.value <= high


def test_zero_changes_only_on_its_scale() -> None:
    zero, small = operand(3, 0.0), operand(4, 0.1)
    chart = offset(0.3)
    found = charted(units([zero, small]), {zero: chart, small: chart})
    assert [(unit.operands, unit.chart) for unit in found] == [
        ((zero,), chart),
        ((small,), None),
        ((small,), chart),
    ]
