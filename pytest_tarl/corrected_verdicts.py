"""`--tarl-holm`: correct the verdicts of a run for multiple comparisons."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from pytest_tarl.learning import drift
from pytest_tarl.learning.bounds import detectable_loss
from pytest_tarl.learning.permutation import least_p_value, permutations_for
from pytest_tarl.model import Comparison, Region, Verdict


def corrected(comparisons: Sequence[Comparison], alpha: float) -> list[Comparison]:
    """Return a run's comparisons with p-values corrected by Holm's method, and the resulting verdicts."""
    verdicts = drift.corrected([one.verdict for one in comparisons], alpha)
    return [
        _with_verdict(one, verdict, len(comparisons), alpha)
        for one, verdict in zip(comparisons, verdicts, strict=True)
    ]


def _with_verdict(comparison: Comparison, verdict: Verdict, tests: int, alpha: float) -> Comparison:
    before = comparison.verdict
    if tests > 1:
        verdict = replace(verdict, detectable_loss=_detectable(comparison, alpha / tests))
    note = (
        f"p-values are corrected for the {tests} comparisons of this run (Holm); uncorrected: {before.p_loss:.2g} "
        f"for the loss, {before.p_drift:.2g} for the difference."
    )
    region = comparison.region if verdict.result != "no difference" else Region()
    notes = (*comparison.notes, note, *_hopeless(comparison, tests, alpha)) if tests > 1 else comparison.notes
    return replace(comparison, verdict=verdict, region=region, notes=notes)


def _hopeless(comparison: Comparison, tests: int, alpha: float) -> Iterator[str]:
    """Yield a warning if even the largest difference could not be significant after the correction."""
    offline, online = (len(comparison.totals[world]) for world in ("offline", "online"))
    least = least_p_value(offline, online, permutations_for(alpha, tests))
    if tests * least >= alpha:
        yield (
            f"This test cannot reach significance: with {online} deployed and {offline} recorded episodes, the "
            f"smallest possible p-value is {least:.2g}, or {min(1.0, tests * least):.2g} corrected for {tests} "
            f"comparisons, which is not below {alpha:g}. Run --tarl-holm on fewer tests, raise --tarl-episodes, or "
            "raise --tarl-alpha."
        )


def _detectable(comparison: Comparison, alpha: float) -> float:
    """Return the detectable loss per episode at the first and strictest step of the correction."""
    offline, online = (np.array(comparison.totals[world]) for world in ("offline", "online"))
    return max(comparison.verdict.tolerance, detectable_loss(offline, online, alpha))
