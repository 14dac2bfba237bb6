"""`--tarl-holm`: verdicts that are corrected over all comparisons of a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from pytest_tarl.learning.drift import judged
from pytest_tarl.learning.holm import holm
from pytest_tarl.model import Comparison, Region, Verdict


def corrected(comparisons: Sequence[Comparison], alpha: float) -> list[Comparison]:
    """Return the comparisons of one run with p-values and verdicts corrected over all of them (Holm)."""
    verdicts = [one.verdict for one in comparisons]
    p_drift, p_loss = (holm([getattr(one, name) for one in verdicts]) for name in ("p_drift", "p_loss"))
    return [
        _with_verdict(one, judged(replace(one.verdict, p_drift=drift, p_loss=loss), alpha), len(comparisons))
        for one, drift, loss in zip(comparisons, p_drift, p_loss, strict=True)
    ]


def _with_verdict(comparison: Comparison, verdict: Verdict, tests: int) -> Comparison:
    before = comparison.verdict
    note = (
        f"p values are corrected over the {tests} comparisons of this run (Holm); alone they are {before.p_loss:.2g} "
        f"for the loss and {before.p_drift:.2g} for the difference."
    )
    region = comparison.region if verdict.result != "no difference" else Region()
    notes = (*comparison.notes, note) if tests > 1 else comparison.notes
    return replace(comparison, verdict=verdict, region=region, notes=notes)
