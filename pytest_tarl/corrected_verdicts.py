"""`--tarl-holm`: verdicts that are corrected over all comparisons of a run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from pytest_tarl.learning.bounds import detectable_loss
from pytest_tarl.learning.drift import judged
from pytest_tarl.learning.multiple_testing import holm
from pytest_tarl.learning.permutation import least_p_value, permutations_for
from pytest_tarl.model import Comparison, Region, Verdict


def corrected(comparisons: Sequence[Comparison], alpha: float) -> list[Comparison]:
    """Return the comparisons of one run with p-values and verdicts corrected over all of them (Holm)."""
    verdicts = [one.verdict for one in comparisons]
    count = len(comparisons)
    p_drift, p_loss = (holm([getattr(one, name) for one in verdicts]) for name in ("p_drift", "p_loss"))
    return [
        _with_verdict(one, judged(replace(one.verdict, p_drift=drift, p_loss=loss), alpha), count, alpha)
        for one, drift, loss in zip(comparisons, p_drift, p_loss, strict=True)
    ]


def _with_verdict(comparison: Comparison, verdict: Verdict, tests: int, alpha: float) -> Comparison:
    before = comparison.verdict
    if tests > 1:
        verdict = replace(verdict, detectable_loss=_detectable(comparison, alpha / tests))
    note = (
        f"p values are corrected over the {tests} comparisons of this run (Holm); alone they are {before.p_loss:.2g} "
        f"for the loss and {before.p_drift:.2g} for the difference."
    )
    region = comparison.region if verdict.result != "no difference" else Region()
    notes = (*comparison.notes, note, *_hopeless(comparison, tests, alpha)) if tests > 1 else comparison.notes
    return replace(comparison, verdict=verdict, region=region, notes=notes)


def _hopeless(comparison: Comparison, tests: int, alpha: float) -> Iterator[str]:
    """Say so where no difference at all could have been significant among so many comparisons."""
    offline, online = (len(comparison.totals[world]) for world in ("offline", "online"))
    least = least_p_value(offline, online, permutations_for(alpha, tests))
    if tests * least >= alpha:
        yield (
            f"Whatever this test had found, it could not have been significant alone: {online} on-line and {offline} "
            f"off-line episodes give a p value of {least:.2g} at the least, which is {min(1.0, tests * least):.2g} "
            f"corrected over {tests} comparisons and not below {alpha:g}. Give --tarl-holm fewer tests at a time, more "
            "episodes with --tarl-episodes, or a larger --tarl-alpha."
        )


def _detectable(comparison: Comparison, alpha: float) -> float:
    """Return the loss that would have been seen at the first step of the correction, the strictest one."""
    offline, online = (np.array(comparison.totals[world]) for world in ("offline", "online"))
    return max(comparison.verdict.tolerance, detectable_loss(offline, online, alpha))
