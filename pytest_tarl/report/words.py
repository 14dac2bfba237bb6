"""Sentences shared by terminal and page: verdict, numbers, repair, commands."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterable, Iterator, Sequence
from itertools import accumulate
from pathlib import Path
from statistics import fmean

from pytest_tarl.learning.bounds import mean_of
from pytest_tarl.learning.effect_size import effect_size
from pytest_tarl.model import (
    Attempt,
    Comparison,
    Edit,
    LossInterval,
    OperandEffect,
    Partial,
    Reason,
    Repair,
    Slice,
)
from pytest_tarl.report.guarantees import percent
from pytest_tarl.report.regions import Vocabulary

SIGNIFICANT = 0.05  # p-value above which a loss is not reported
CONFIDENCE = 0.95  # confidence of the interval around an average
NEGLIGIBLE = 0.01  # share of the total loss below which a part's loss is not reported
SHORTEST = 16  # minimum number of characters shown of a code line
REASONS: dict[Reason, str] = {
    "": "no reason was recorded",
    "no operand helps": "no change of a single constant restores the reward",
    "gain too small": "the best change found gains too little",
    "nominal gets worse": "the best change found makes the designed world worse",
    "budget": "the search reached its limit of episodes",
    "time": "the search reached its time limit",
    "interrupted": "the search was interrupted",
    "not confirmed": "its gain was not confirmed on further seeds",
    "worse than unrepaired": "on fresh seeds the best change found earns less than no repair",
    "another test gets worse": "the best change found makes another recorded test of the node worse",
    "not over the whole range": "the best change found works only in a part of the drift's range",
    "not at its definition": "the best change found works only at a use, but --tarl-edit=definition was given",
    "fails too often": "with the best change found, missions still fail too often",
    "not shown": "the best change found may be sufficient, but 200 episodes are too few to show it",
    "cannot be written": "the best change found cannot be written to the source",
    "never tested": "the best change found was not tested, because other candidates used all acceptance tests",
    "a smaller step breaks it": "even a smaller step of the best change found makes the designed world worse",
}


ENDS: dict[Reason, str] = {
    "": "accepted",
    "gain too small": "dropped, it gains too little",
    "nominal gets worse": "dropped, the designed world gets worse",
    "not confirmed": "dropped, not confirmed on further seeds",
    "worse than unrepaired": "dropped, earns less than no repair",
    "another test gets worse": "dropped, another test of the node gets worse",
    "not over the whole range": "dropped, it works only in a part of the drift's range",
    "not at its definition": "dropped, it works only at a use of the constant",
    "fails too often": "dropped, missions fail too often",
    "not shown": "dropped, 200 episodes are too few to show that it is sufficient",
    "cannot be written": "dropped, it cannot be written to the source",
    "never tested": "not tested, because other candidates used all acceptance tests",
    "a smaller step breaks it": "not run, a smaller step already makes the designed world worse",
}


def amount(value: float | None) -> str:
    """Format a reward or utility with about three digits; `n/a` for none."""
    if value is None or not math.isfinite(value):
        return "n/a"
    if value == 0 or 0.1 <= abs(value) < 1000:
        return f"{value:.2f}"
    return f"{value:.0f}" if 1000 <= abs(value) < 1e6 else f"{value:.3g}"


def expected(value: float) -> float:
    """Round off floating-point noise: 12.0 for 11.999999999999998."""
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
    """Return the average total reward (Eq. 3) of `offline`, `online`, `repaired` or `nominal_repaired`."""
    totals = comparison.totals.get(world, ())
    return fmean(totals) if totals else None


def running_mean(totals: Sequence[float]) -> list[float]:
    """Return the average total reward after each episode (Eq. 3)."""
    return [total / count for count, total in enumerate(accumulate(totals), start=1)]


def world_name(comparison: Comparison) -> str:
    """Return the name of the deployed world."""
    return f"the drift scenario {comparison.drift!r}" if comparison.drift else "the deployed world"


def designed_world(comparison: Comparison) -> str:
    """Return the name of the recorded world."""
    return "old world" if comparison.permanent else "designed world"


def verdict_sentence(comparison: Comparison) -> str:
    """Return the conclusion of the comparison in one sentence."""
    verdict, world = comparison.verdict, world_name(comparison)
    if verdict.result == "degraded":
        loss = amount(verdict.loss)
        return f"In {world} an episode earns {loss} less than designed ({p_value(verdict.p_loss)})."
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


def loss_words(comparison: Comparison) -> str:
    """Format the loss with its interval and effect size; empty if there are too few episodes."""
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
    """Format the confidence of an interval; it is approximate without a declared range of totals."""
    return f"{'' if interval.exact else 'about '}{percent(interval.confidence)} confidence"


def deviations(effect: float) -> str:
    """Format an effect size; beyond 100 standard deviations its digits are meaningless."""
    size = abs(effect)
    return "over 100" if size > 100 else f"{size:.0f}" if size >= 10 else f"{size:.2g}"


def loss_interval(comparison: Comparison) -> str:
    """Format the confidence interval of the loss, `15.1 to 18.3`; empty if it is unbounded."""
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
    """Describe the region where the deployed world differs, with new situations listed separately; empty if none."""
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
    """Describe the region without the sensors whose values are all new."""
    without = comparison.region.without
    kept = [d for d in range(len(comparison.sensors)) if d not in without]
    short, chosen = (
        {tuple(cell[d] for d in kept) for cell in cells}
        for cells in (comparison.cells, comparison.region.cells)
    )
    named = Vocabulary([comparison.sensors[d] for d in kept], short).words(chosen)
    return f"{named}, regardless of {' and '.join(comparison.sensors[d].name for d in without)}"


def lost_words(comparison: Comparison, part: str) -> str:
    """Describe where a part of the reward is lost; empty if it is not, or if no situation stands out."""
    cells = comparison.lost.get(part, ()) if part in dict(lost_parts(comparison)) else ()
    return Vocabulary(comparison.sensors, comparison.cells).words(cells) if cells else ""


def lost_parts(comparison: Comparison) -> list[tuple[str, float]]:
    """Return the parts of the reward that decreased, with the difference per episode, the largest loss first."""
    changed = [(name, after - before) for name, (before, after) in comparison.parts.items()]
    least = NEGLIGIBLE * sum(by for _, by in changed if by < 0)
    return sorted(((name, by) for name, by in changed if by < least), key=lambda one: one[1])


def paper_region_words(comparison: Comparison) -> str:
    """Describe the paper's region; empty if there is none."""
    if not comparison.paper_region:
        return ""
    return Vocabulary(comparison.sensors, comparison.cells).words(comparison.paper_region)


def edit_words(edit: Edit) -> str:
    """Describe an edit: `→` replaces a number, `×` multiplies a named constant."""
    return edit.what or f"{edit.code} {'×' if edit.factor else '→'} {edit.value:g}"


def operand_words(operand: OperandEffect) -> str:
    """Describe the best change of an operand: a new value, or a factor if its own value is unknown."""
    return f"{operand.code} {'×' if operand.value is None else '→'} {operand.best:g}"


def repair_words(repair: Repair) -> str:
    """Describe the repair and its condition: `5 → 12 at traveller.py:30 where terrain`."""
    edits = ", ".join(f"{edit_words(edit)} at {edit.path}:{edit.line}" for edit in repair.edits)
    return f"{edits} {f'where {repair.guard}' if repair.guard else 'everywhere'}"


def partial_words(partial: Partial, comparison: Comparison) -> str:
    """Describe the gain of a partial repair and its effect on the designed world."""
    sure = f"about {percent(partial.confidence)} confidence"
    gained = f"{signed(partial.gain)} per episode, at least {signed(partial.low)} ({sure})"
    return (
        f"{gained}, of {amount(partial.lost)} lost; {designed_world(comparison)} "
        f"{signed(partial.designed)}, at least {signed(partial.designed_low)}"
    )


def refusal(repair: Repair) -> str:
    """Return why no repair was accepted."""
    return REASONS.get(repair.reason, repair.reason)


def best_words(repair: Repair) -> str:
    """Describe the best rejected candidate and its reward."""
    if repair.mean is None:
        return repair_words(repair)
    earned = f"{amount(repair.mean)} per episode, mean of {repair.episodes}"
    return f"{repair_words(repair)} ({earned})"


def attempt_words(attempt: Attempt) -> str:
    """Describe an attempt, its reward and its outcome."""
    outcome = ENDS.get(attempt.reason, attempt.reason)
    if not attempt.episodes:
        return f"{attempt.what}: {outcome}"
    kind = "fresh" if attempt.fresh else "known"
    return f"{attempt.what}: {outcome}, {amount(attempt.mean)} in {attempt.episodes} {kind} episodes"


def command(comparison: Comparison, *flags: str) -> str:
    """Return the command that repeats the comparison with the same seed."""
    drift = ["--tarl-drift", comparison.drift] if comparison.drift else []
    seed = ["--tarl-seed", str(comparison.seed)] if comparison.seed else []
    options = [*drift, *seed, *comparison.flags, *flags]
    return shlex.join(["pytest", comparison.target or comparison.test, "--tarl-online", *options])


def recording(comparison: Comparison) -> str:
    """Return the command that makes a permanent drift part of the design after its repair is applied."""
    drift = ["--tarl-drift", comparison.drift] if comparison.drift else []
    return shlex.join(["pytest", comparison.target or comparison.test, "--tarl-record", *drift])


def ways_out(comparison: Comparison) -> str:
    """Return advice for a repair that fails only in the designed world; empty without one."""
    repair = comparison.repair
    if repair is None or repair.accepted or comparison.permanent:
        return ""
    against = [one.what for one in repair.history if one.reason == "nominal gets worse"]
    if repair.reason != "nominal gets worse" and not against:
        return ""
    what = against[-1] if against else repair_words(repair)
    name = comparison.drift or "worn"
    return (
        f"{what} restores the reward in {world_name(comparison)} but makes the designed world worse. Declare a "
        "sensor that distinguishes the two worlds, so that the repair can be conditional; or, if the drift is "
        "permanent, declare it so: "
        f'drifts={{"{name}": Drift(…, permanent=True)}}'
    )


def repeat(comparison: Comparison) -> str:
    """Return the command that repeats the run, including searches."""
    searches = [search.method for search in comparison.searches if search.method != "structure"]
    methods = [method for method in searches if method != "ranking"]
    full = ["--tarl-localize", "full"] if len(methods) < len(searches) else []
    chosen = (
        [flag for method in methods for flag in ("--tarl-search", method)] if methods != ["sweep"] else []
    )
    return command(comparison, *(["--tarl-repair", *chosen, *full] if comparison.repair else []))


def next_steps(comparison: Comparison) -> Iterator[str]:
    """Yield the next command for the developer, if there is one."""
    if not comparison.lists:
        yield shlex.join(["pytest", comparison.target or comparison.test, "--tarl-record"])
    elif comparison.repair and comparison.repair.accepted and comparison.repair.patch:
        yield shlex.join(["git", "apply", comparison.repair.patch])
        if comparison.permanent:
            yield recording(comparison)
    elif comparison.verdict.result == "degraded" and comparison.repair is None and not _happened(comparison):
        yield command(comparison, "--tarl-repair")


def _happened(comparison: Comparison) -> bool:
    """Return whether the compared missions were recorded and cannot be run again."""
    return bool({"--tarl-log", "--tarl-bag"} & {*comparison.flags})


def peak(slices: Iterable[Slice]) -> Slice | None:
    """Return the slice that differs most between the worlds; None if none differs."""
    known = [one for one in slices if one.difference and not math.isnan(one.difference)]
    return max(known, key=lambda one: abs(one.difference), default=None)


def place(path: str, line: int, root: Path) -> str:
    """Return `path:line`, with the path relative to `root` if it is below."""
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
