"""Sentences for terminal and page: verdict, loss, regions and places."""

from __future__ import annotations

import math
from pathlib import Path

from pytest_tarl.learning.effect_size import effect_size
from pytest_tarl.model import Comparison, LossInterval, Verdict
from pytest_tarl.report.amounts import amount, deviations, p_value
from pytest_tarl.report.guarantee_words import percent
from pytest_tarl.report.sensor_regions import Vocabulary

SIGNIFICANT = 0.05  # a loss is reported only if its p-value is at most this
NEGLIGIBLE = 0.01  # parts of the reward below this share of the total loss are not reported
SHORTEST = 16  # code lines are never cut to fewer characters than this


def world_name(comparison: Comparison) -> str:
    """Return the name of the deployed world."""
    return f"the drift scenario {comparison.drift!r}" if comparison.drift else "the deployed world"


def designed_world(comparison: Comparison) -> str:
    """Return the name of the recorded world."""
    return "old world" if comparison.permanent else "designed world"


def verdict_sentence(comparison: Comparison) -> str:
    """Return the conclusion in one sentence."""
    verdict, world = comparison.verdict, world_name(comparison)
    if verdict.failures_only:
        return f"In {world} {_successes(verdict)}."
    if verdict.result == "degraded":
        lost = f"In {world} an episode earns {amount(verdict.loss)} less than designed ({p_value(verdict.p_loss)})"
        return f"{lost}; {_successes(verdict)}." if "success" in verdict.because else f"{lost}."
    if verdict.result == "drifted":
        differs = f"{_capital(world)} differs from the designed one ({p_value(verdict.p_drift)})"
        if verdict.loss > 0 and verdict.p_loss < SIGNIFICANT:
            tolerated = f"within the tolerance of {amount(verdict.tolerance)}"
            return f"{differs}; an episode earns {amount(verdict.loss)} less, {tolerated}."
        return f"{differs}, but no loss of reward was found ({p_value(verdict.p_loss)})."
    seen = f"a loss of {amount(verdict.detectable_loss)} per episode would have been detected"
    if not math.isfinite(verdict.detectable_loss):
        seen = "too few episodes were run to detect any loss"
    return f"No difference was found between {world} and the designed one; {seen}."


def _successes(verdict: Verdict) -> str:
    """Format the decrease of the success rate."""
    before, after = (percent(share) for share in verdict.success)
    return f"missions succeed in {after} of the episodes, instead of {before} ({p_value(verdict.p_failures)})"


def loss_words(comparison: Comparison) -> str:
    """Format the loss and, if there are enough episodes, its interval and effect size."""
    offline, online = (comparison.totals.get(world, ()) for world in ("offline", "online"))
    if min(len(offline), len(online)) < 2:
        return ""
    effect = effect_size(offline, online)
    size = "" if math.isnan(effect) else f"{deviations(effect)} standard deviations"
    interval = loss_interval(comparison)
    verdict = comparison.verdict
    known = f"{_sure(verdict.interval)} {interval}" if verdict.interval and interval else ""
    return "; ".join(filter(None, (known, size)))


def _sure(interval: LossInterval) -> str:
    """Format an interval's confidence; approximate if no range is declared."""
    return f"{'' if interval.exact else 'about '}{percent(interval.confidence)} confidence"


def loss_interval(comparison: Comparison) -> str:
    """Format the interval of the loss, such as `15.1 to 18.3`."""
    interval = comparison.verdict.interval
    low, high = (interval.low, interval.high) if interval else (-math.inf, math.inf)
    if math.isinf(low) or math.isinf(high):
        return (
            ""
            if low == -high
            else f"at least {amount(low)}"
            if math.isinf(high)
            else f"at most {amount(high)}"
        )
    return f"{amount(low)} to {amount(high)}"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def region_words(comparison: Comparison) -> str:
    """Describe the region in which the worlds differ."""
    vocabulary, region = Vocabulary(comparison.sensors, comparison.cells), comparison.region
    novel = set(region.novel)
    known = [cell for cell in region.cells if cell not in novel]
    parts = [vocabulary.words(known)] if known and not region.without else []
    if region.cells and region.without:
        parts.append(_words_without(comparison))
    if novel:
        parts.append(f"not in the recording: {vocabulary.words(novel)}")
    if region.left:
        parts.append(f"no longer visited: {vocabulary.words(region.left)}")
    return "; ".join(parts)


def _words_without(comparison: Comparison) -> str:
    """Describe the region without the sensors that have only new values."""
    without = comparison.region.without
    kept = [d for d in range(len(comparison.sensors)) if d not in without]
    short, chosen = (
        {tuple(cell[d] for d in kept) for cell in cells}
        for cells in (comparison.cells, comparison.region.cells)
    )
    named = Vocabulary([comparison.sensors[d] for d in kept], short).words(chosen)
    return f"{named}, regardless of {' and '.join(comparison.sensors[d].name for d in without)}"


def lost_words(comparison: Comparison, part: str) -> str:
    """Describe where a part of the reward is lost."""
    cells = comparison.lost.get(part, ()) if part in dict(lost_parts(comparison)) else ()
    return Vocabulary(comparison.sensors, comparison.cells).words(cells) if cells else ""


def lost_parts(comparison: Comparison) -> list[tuple[str, float]]:
    """Return the parts of the reward that decreased, largest loss first."""
    changed = [(name, after - before) for name, (before, after) in comparison.parts.items()]
    least = NEGLIGIBLE * sum(by for _, by in changed if by < 0)
    return sorted(((name, by) for name, by in changed if by < least), key=lambda one: one[1])


def paper_region_words(comparison: Comparison) -> str:
    """Describe the region as the paper defines it; empty if there is none."""
    if not comparison.paper_region:
        return ""
    return Vocabulary(comparison.sensors, comparison.cells).words(comparison.paper_region)


def place(path: str, line: int, root: Path) -> str:
    """Return `path:line`; the path is relative if it is below `root`."""
    inside = Path(path)
    if inside.is_absolute() and inside.is_relative_to(root):
        inside = inside.relative_to(root)
    return f"{inside.as_posix()}:{line}"


def one_line(code: str, width: int | None = None) -> str:
    """Fold a multi-line statement into one line of at most `width` characters."""
    folded = " ".join(code.split())
    if width is None or len(folded) <= max(width, SHORTEST):
        return folded
    return folded[: max(width, SHORTEST) - 1].rstrip() + "…"
