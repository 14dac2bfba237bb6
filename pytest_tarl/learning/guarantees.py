"""State bounds for future episodes in the worlds from which a test samples."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pytest_tarl.learning.bounds import (
    Range,
    episodes_for_quantile,
    mean_of,
    quantile_low,
    rate,
    rate_sequence,
)
from pytest_tarl.learning.tables import Sample
from pytest_tarl.model import Guarantee

CONFIDENCE = 0.95  # default `confidence` of the marker
QUANTILE = 0.05


def stated(
    passed: Sequence[bool],
    totals: Sequence[float],
    *,
    confidence: float | None = None,
    declared: Range | None = None,
    anytime: bool = False,
    varied: bool = True,
) -> Guarantee:
    """Return bounds for future episodes, computed from these; the confidence is that of a single bound.

    Set `anytime` if the number of episodes depends on their results; quantiles then have no bound. Raise ValueError if
    a total is outside the declared range.
    """
    sure, count = confidence or CONFIDENCE, len(passed)
    success = (rate_sequence if anytime else rate)(sum(passed), count, sure)
    return Guarantee(
        episodes=count,
        passed=sum(passed),
        success=success,
        average=float(np.mean(totals)),
        mean=mean_of(totals, sure, declared, anytime=anytime),
        share=QUANTILE,
        quantile=None if anytime else quantile_low(totals, QUANTILE, sure),
        needed=0 if anytime else episodes_for_quantile(QUANTILE, sure),
        varied=varied,
        declared=None if declared is None else (declared.low, declared.high),
    )


def varies(sample: Sample) -> bool:
    """Return whether any two episodes differ in steps, results or rewards."""
    chain = sample.chain
    rows = np.bincount(chain.episode, minlength=sample.episodes)
    if np.ptp(sample.total) or np.ptp(sample.steps) or np.ptp(sample.passed.astype(int)) or np.ptp(rows):
        return True
    return any(
        bool(np.ptp(column.reshape(sample.episodes, -1), axis=0).any())
        for column in (chain.cell, chain.next_cell, chain.count, chain.reward)
        if column.size
    )
