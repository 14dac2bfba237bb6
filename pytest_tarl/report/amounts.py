"""Format numbers: rewards with their intervals, p-values and effect sizes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import accumulate
from statistics import fmean

from pytest_tarl.learning.bounds import mean_of
from pytest_tarl.model import Comparison
from pytest_tarl.report.guarantee_words import percent

CONFIDENCE = 0.95  # confidence of the interval of an average


def amount(value: float | None) -> str:
    """Format a reward or utility with about three digits; None gives `n/a`."""
    if value is None or not math.isfinite(value):
        return "n/a"
    if value == 0 or 0.1 <= abs(value) < 1000:
        return f"{value:.2f}"
    return f"{value:.0f}" if 1000 <= abs(value) < 1e6 else f"{value:.3g}"


def expected(value: float) -> float:
    """Round away floating-point noise, such as 11.999999999999998."""
    return float(f"{value:.10g}")


def average(totals: Sequence[float]) -> str:
    """Format an average total reward with its confidence interval and number of episodes."""
    if len(totals) < 2:
        return f"{amount(fmean(totals)) if totals else 'n/a'} per episode, {len(totals)} episodes"
    found = mean_of(totals, (1.0 + CONFIDENCE) / 2)
    interval = f"about {percent(CONFIDENCE)} confidence {amount(found.low)} to {amount(found.high)}"
    return f"{amount(fmean(totals))} per episode, {interval}, {len(totals)} episodes"


def signed(value: float | None) -> str:
    """Format a difference with its sign."""
    text = amount(value)
    return text if text.startswith(("-", "n")) else f"+{text}"


def p_value(value: float) -> str:
    """Format a p-value as an equation or inequality: `p = 0.021`, `p < 0.001`."""
    if math.isnan(value):
        return "p unknown"
    return "p < 0.001" if value < 0.001 else f"p = {value:.2g}"


def atr(comparison: Comparison, world: str) -> float | None:
    """Return the average total reward (Eq. 3) in `offline`, `online`, `repaired` or `nominal_repaired`."""
    totals = comparison.totals.get(world, ())
    return fmean(totals) if totals else None


def running_mean(totals: Sequence[float]) -> list[float]:
    """Return the average total reward after each episode (Eq. 3)."""
    return [total / count for count, total in enumerate(accumulate(totals), start=1)]


def deviations(effect: float) -> str:
    """Format an effect size; above 100 standard deviations, show 100."""
    size = abs(effect)
    return "over 100" if size > 100 else f"{size:.0f}" if size >= 10 else f"{size:.2g}"
