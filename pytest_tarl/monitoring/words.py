"""Describe the status of a watch in sentences."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import datetime

from pytest_tarl.monitoring.stated import Bound
from pytest_tarl.monitoring.status import Evidence, Moment, Score, Status
from pytest_tarl.monitoring.watch import Watch
from pytest_tarl.report.sensor_regions import Vocabulary

SCORES = {
    "success": "the success of missions",
    "total": "the total reward",
    "residual": "the total reward, minus its expectation in each situation",
    "unknown": "the number of steps in unknown situations",
    "steps": "the number of steps",
}
SIDES = {
    "lower": "is lower than recorded",
    "higher": "is higher than recorded",
    "spread": "is more extreme than recorded",
}


def lines(watch: Watch, status: Status) -> Iterator[str]:
    """Yield the full report."""
    words = vocabulary(watch, status)
    yield f"{watch.fixture.test}: {_missions(status.missions)}, {_passed(status)}"
    for bound, evidence in status.bounds:
        yield f"  bound   {stated(bound)}: {found(evidence, status.alpha)}"
    yield f"  world   missions as recorded: {found(status.world, status.alpha)}"
    if status.drifted and status.lead is not None:
        yield f"          most of all {led(status.lead, words)}"
    if status.cells:
        yield f"  where   {words.words(status.cells)}"
    if status.new:
        yield f"  new     {words.words(status.new)}: no recorded episode visited it"
    yield f"  error   {promise(status)}"
    for note in status.notes:
        yield f"  note    {note}"


def headline(watch: Watch, status: Status) -> str:
    """Return the status as one line, for logs and diagnostics."""
    parts = [f"{_missions(status.missions)}, {_passed(status)}"]
    for bound, evidence in status.bounds:
        if evidence is not None:
            parts.append(f"{bound.what} bound: {found(evidence, status.alpha)}")
    parts.append(f"world: {found(status.world, status.alpha)}")
    if status.cells:
        parts.append(vocabulary(watch, status).words(status.cells))
    return "; ".join(parts)


def vocabulary(watch: Watch, status: Status) -> Vocabulary:
    """Return the vocabulary for describing cells in words."""
    return Vocabulary(watch.fixture.sensors, {*watch.fixture.sample.cells, *status.new})


def stated(bound: Bound) -> str:
    """Describe a bound."""
    if bound.what == "success":
        return f"at least {_percent(bound.least)} of missions pass ({_percent(bound.confidence)} confidence)"
    return f"a mission earns at least {bound.least:.4g} on average ({_percent(bound.confidence)} confidence)"


def found(evidence: Evidence | None, alpha: float) -> str:
    """Describe the evidence against a hypothesis, and when the difference began."""
    if evidence is None:
        return "nothing to test"
    now = f"evidence {_number(evidence.now)}, alarm at {1.0 / alpha:.4g}"
    if evidence.alarm is None:
        return now
    since = f", changed before {_moment(evidence.since)}" if evidence.since else ""
    highest = f", at most {_number(evidence.highest)}" if evidence.highest > evidence.now + 0.5 else ""
    return f"ALARM with {_moment(evidence.alarm)}{since} ({now}{highest})"


def led(score: Score, words: Vocabulary) -> str:
    """Describe the score with the most evidence."""
    what = (
        SCORES[score.name] if score.cell is None else f"the value of a visit to {words.words([score.cell])}"
    )
    return f"{what} {SIDES[score.side]}"


def promise(status: Status) -> str:
    """Describe the probability of a false alarm."""
    tested = [bound for bound, evidence in status.bounds if evidence is not None]
    text = f"probability that this watch ever raises a false alarm: at most {_percent(status.alpha)} (alpha)"
    if not tested:
        return text
    each = " and ".join(_percent(1.0 - bound.confidence) for bound in tested)
    which = "bounds themselves are" if len(tested) > 1 else "bound itself is"
    return f"{text}; {_percent(status.error)} including the {each} risk that the {which} wrong"


def _passed(status: Status) -> str:
    share = f" ({_percent(status.passed / status.missions)})" if status.missions else ""
    return f"{status.passed:,} passed{share}"


def _missions(count: int) -> str:
    return f"{count:,} mission{'s' if count != 1 else ''}"


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %"


def _number(log10: float) -> str:
    if log10 >= 5:
        return f"10^{log10:.0f}"
    value = 10.0**log10
    return f"{value:,.0f}" if value >= 10 else f"{value:.2g}"


def _moment(moment: Moment) -> str:
    if moment.time is None or moment.time <= 0:
        return f"mission {moment.mission:,}"
    return f"mission {moment.mission:,} ({datetime.fromtimestamp(moment.time):%Y-%m-%d %H:%M})"
