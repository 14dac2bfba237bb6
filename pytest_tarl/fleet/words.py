"""Describe the answer of `tarl fleet` in lines of text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import datetime, timezone

from pytest_tarl.fleet import decomposition_words, repair_effect_words
from pytest_tarl.fleet.changed_robots import Robot, lower
from pytest_tarl.fleet.mission_groups import MOST, Group
from pytest_tarl.fleet.question import Answer
from pytest_tarl.model import Bound
from pytest_tarl.monitoring.status import Evidence
from pytest_tarl.report.sensor_regions import Vocabulary

NAMED = 20  # maximum number of robots to list


def lines(answer: Answer) -> Iterator[str]:
    """Yield the lines of the report."""
    question, found = answer.question, answer.robots
    words = Vocabulary(answer.fixture.sensors, answer.cells)
    since = f" since {question.since}" if question.since else ""
    yield (
        f"{question.data}: {answer.missions:,} missions of {_counted(len(found.every), 'robot')}{since}, compared with "
        f"{answer.fixture.sample.episodes} episodes of {answer.fixture.test}"
    )
    yield ""
    yield from _table(answer, words)
    yield from _onsets(answer, words)
    yield from _formulas(answer)
    yield ""
    yield from _named(answer, found.drifted, "missions differ from the recording", "")
    for one in found.drifted[:NAMED]:
        yield _robot(one, one.world, one.status.world if one.status else None, words)
    sure = " plus the risk that a recorded bound is wrong"
    yield from _named(answer, found.below, "missions fall below a recorded bound", sure)
    for one in found.below[:NAMED]:
        yield _robot(one, one.bound, lower(one.status) if one.status else None, words)
    yield from _clusters(answer, words)
    if answer.repairs:
        yield ""
        yield from repair_effect_words.lines(answer.repairs, answer.accepted)
    if answer.parts is not None:
        yield ""
        yield from decomposition_words.lines(answer.parts)
    if answer.lowest:
        yield ""
        yield f"missions of {question.robot} with the lowest reward"
        for mission in answer.lowest:
            result = "passed" if mission.passed else "failed"
            yield f"  {time(mission.time)}  {result}  reward {mission.total:.6g}  {mission.steps} steps"
    yield ""
    yield from notes(answer)


def _onsets(answer: Answer, words: Vocabulary) -> Iterator[str]:
    """Yield the groups whose missions changed, and when."""
    found = answer.onsets
    if not answer.question.by:
        return
    named = {one.name for one in (*found.drifted, *found.below)}
    rate = f"false discovery rate at most {100 * found.q:g} % for each kind of evidence"
    yield ""
    yield f"{len(named):,} of {len(found.every):,} groups: changed over time ({rate}){':' if named else ''}"
    ordered = sorted(
        (one for one in found.every if one.name in named),
        key=lambda one: (-max(one.world, one.bound), one.name),
    )
    for one in ordered[:NAMED]:
        below = one.bound >= one.world
        evidence = one.status and (lower(one.status) if below else one.status.world)
        yield _robot(one, max(one.world, one.bound), evidence or None, words)


def _clusters(answer: Answer, words: Vocabulary) -> Iterator[str]:
    """Yield the clusters of robots with similar drifts."""
    found = answer.clusters
    if not found.found and not found.unclear:
        return
    yield ""
    yield "Robots with similar drifts"
    for one in found.found:
        mean = sum(one.residuals) / max(1, len(one.residuals))
        where = (
            f"{words.words(one.cells)}, {mean:+.3g} reward a step there" if one.cells else "no common cell"
        )
        yield f"  {_counted(len(one.robots), 'robot')} ({_names(one.robots)}): {where}"
    if found.unclear:
        yield f"  {_counted(len(found.unclear), 'robot')} ({_names(found.unclear)}): no cell stands out"
    if found.left_out:
        yield f"  {found.left_out:,} further robots with less evidence were not compared"


def _names(names: Sequence[str]) -> str:
    more = f" and {len(names) - NAMED:,} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more


def _formulas(answer: Answer) -> Iterator[str]:
    """Yield the groups that violate a formula."""
    found = [(group, one) for group in answer.groups for one in group.formulas if one.violated]
    if not any(group.formulas for group in answer.groups):
        return
    yield ""
    if not found:
        yield "No mission violates a formula."
    for group, one in sorted(found, key=lambda pair: (-pair[1].violated / pair[1].missions, pair[0].values)):
        where = f" in {' '.join(group.values)}" if group.values else ""
        yield (
            f"{one.formula}: violated by {one.violated:,} of {one.missions:,} missions{where}, "
            f"least robustness {one.least:.3g}"
        )


def _table(answer: Answer, words: Vocabulary) -> Iterator[str]:
    titles = [*answer.question.by, "missions", "robots", "pass rate", "mean reward", "verdict", "where"]
    rows = [titles, *(_row(one, words) for one in answer.groups)]
    widths = [max(len(row[n]) for row in rows) for n in range(len(titles))]
    for row in rows:
        yield "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()


def _row(one: Group, words: Vocabulary) -> list[str]:
    region = (*one.region.cells, *one.region.novel)
    return [
        *one.values,
        f"{one.missions:,}",
        f"{one.robots:,}",
        f"{100 * one.passed / one.missions:.1f} % ({_interval(one.success, 100)})",
        f"{one.reward:.4g} ({_interval(one.mean, 1)})",
        verdict(one),
        words.words(region) if region else "",
    ]


def verdict(one: Group) -> str:
    """Return the verdict on a group in words."""
    if one.verdict is None:
        return "too few missions"
    if one.verdict.failures_only:
        before, after = (f"{100 * share:.1f} %" for share in one.verdict.success)
        return f"degraded: success {after} instead of {before} (p {one.verdict.p_failures:.2g})"
    if one.verdict.result == "degraded":
        return f"degraded by {one.verdict.loss:.3g} (p {one.verdict.p_loss:.2g})"
    return f"{one.verdict.result} (p {one.verdict.p_drift:.2g})"


def _interval(bound: Bound, unit: float) -> str:
    return f"{unit * bound.low:.4g} to {unit * bound.high:.4g}{'' if bound.exact else ', approximate'}"


def _named(answer: Answer, robots: Sequence[Robot], what: str, more: str) -> Iterator[str]:
    rate = f"false discovery rate at most {100 * answer.robots.q:g} %{more}"
    end = ", most evidence first:" if robots else ""
    yield f"{len(robots):,} of {_counted(len(answer.robots.every), 'robot')}: {what} ({rate}){end}"
    if len(robots) > NAMED:
        yield f"  the first {NAMED}; --json lists all"


def _robot(one: Robot, log2: float, evidence: Evidence | None, words: Vocabulary) -> str:
    text = f"  {one.name}: {one.passed:,} of {one.missions:,} missions passed, evidence {_evidence(log2)}"
    if evidence is not None and evidence.since is not None:
        text += f", changed before mission {evidence.since.mission:,} ({time(evidence.since.time or 0.0)})"
    if one.status is not None and one.status.cells:
        text += f", {words.words(one.status.cells)}"
    return text


def _evidence(log2: float) -> str:
    return f"2^{log2:.0f}" if log2 >= 10 else f"{2**log2:.3g}"


def time(seconds: float) -> str:
    """Return a time as day and minute in UTC."""
    return f"{datetime.fromtimestamp(seconds, timezone.utc):%Y-%m-%d %H:%M}" if seconds > 0 else "no time"


def _counted(count: int, what: str) -> str:
    return f"{count:,} {what}{'s' if count != 1 else ''}"


def notes(answer: Answer) -> Iterator[str]:
    """Yield the assumptions behind the report's numbers."""
    confidence = answer.groups[0].success.confidence
    yield (
        f"note: ranges are one-sided bounds, each at {100 * confidence:g} %; p is corrected for "
        f"{_counted(len(answer.groups), 'group')} (Holm)."
    )
    yield (
        "note: the false discovery rates assume that the number of a robot's missions does not depend on how they went."
    )
    if any(one.compared < one.missions for one in answer.groups):
        yield (
            f"note: if a group has more than {MOST:,} missions, its verdict uses {MOST:,} of them, chosen by their "
            "digests."
        )
    if any(one.outside for one in answer.groups):
        outside = sum(one.outside for one in answer.groups)
        yield (
            f"note: {outside:,} totals lie outside the recording's total_range; the bounds of their groups' means are "
            "approximate."
        )
    if answer.copies:
        yield f"note: {answer.copies:,} missions are in the data set more than once; each is counted once."
    for why, count in answer.left_out.items():
        yield f"note: {count:,} missions {why} cannot be compared and are left out."
