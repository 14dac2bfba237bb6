"""Closing lines of a report: counts, findings that are gone, and code that was not analysed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any, Final

from tarl_lint.baseline import Accepted, Baseline
from tarl_lint.catalog import CLIENT_WORDS
from tarl_lint.files import shown
from tarl_lint.fingerprints import OfFlow, OfHazard, topic_text
from tarl_lint.model import Cut, Finding, Flow
from tarl_lint.report.line import Line, View, one_line
from tarl_lint.run.runner import UNREADABLE, Result
from tarl_lint.suppress import XML, YAML, Suppression

_CLASSES: Final = 5  # maximum number of classes outside the analysed files that the report names individually
_SHOWN: Final = 20  # maximum number of vanished findings that are named individually


def closing(result: Result) -> Iterator[Line]:
    """Yield the counts of findings, then what was not analysed."""
    counts = (_count_flows(result), _count_hazards(result), _count_files(result))
    for text in filter(None, counts):
        yield ((text, "strong"),)
    yield from silenced(result)
    yield from not_analysed(result)
    yield from _beyond(result)


def hints(result: Result, view: View) -> Iterator[Line]:
    """Yield the next command, if there are new findings."""
    if not result.new or result.baseline:
        return
    flows = [f.flow for f in result.new if f.flow]
    if len(flows) > 1 and not view.show_paths:
        yield (("--show-paths shows the statements of each flow.", "quiet"),)
    if 0 < view.most_flows < len(flows):
        yield ((f"--max-paths 0 shows all {len(flows)} flows.", "quiet"),)
    yield (("--write-baseline accepts these findings: later runs report only new ones.", "quiet"),)


def is_single(result: Result) -> bool:
    """Return whether there is a single new flow, whose statements the report then shows."""
    return sum(f.flow is not None for f in result.new) == 1


def not_analysed(result: Result) -> Iterator[Line]:
    """Yield one line about code that was not analysed; no line if everything was analysed."""
    missed = list(_missed(result))
    if missed:
        yield ((f"Not analysed: {', '.join(missed)}.", "quiet"),)


def _beyond(result: Result) -> Iterator[Line]:
    """Yield the installed packages that were followed, and the classes outside the files at which flows ended."""
    if result.followed:
        yield ((f"Followed into installed packages: {', '.join(result.followed)}.", "quiet"),)
    if result.ended:
        packages = sorted({name.partition(".")[0] for name in result.ended})
        setting = "follow-installed = [" + ", ".join(f'"{name}"' for name in packages) + "]"
        named = ", ".join(result.ended[:_CLASSES])
        more = f" and {len(result.ended) - _CLASSES} more" if len(result.ended) > _CLASSES else ""
        yield (
            (
                f"Not followed: data that is passed to classes outside the linted files, {named}{more} ({setting}).",
                "quiet",
            ),
        )


def silenced(result: Result) -> Iterator[Line]:
    """Yield one line about findings that are silenced on request."""
    counts = ((len(result.silenced), "comments"), (result.left_out, "per-file-ignores"))
    parts = [f"{count} by {what}" for count, what in counts if count]
    if parts:
        yield ((f"Silenced: {', '.join(parts)}.", "quiet"),)
    if result.off_by_default:
        what = many(result.off_by_default, "flow")
        yield ((f"Not shown: {what} from a request to its own response (--extend-select TARL103).", "quiet"),)


def _count_files(result: Result) -> str:
    """Return the summary of a run in which no rule for flows or hazards is enabled."""
    if result.kinds or result.reports_hazards:
        return ""
    return f"{many(result.statistics.files, 'file')} read; no rule for flows or hazards is enabled."


def _count_flows(result: Result) -> str:
    if not result.kinds:
        return ""
    flows = [f for f in result.new if f.flow]
    files = result.statistics.files
    accepted = _accepted(result, sum(f.status == "accepted" and f.flow is not None for f in result.findings))
    new = "new " if result.baseline else ""
    if not flows and not result.has_endpoints and not result.baseline:
        return f"No flow: nothing in {many(files, 'file')} subscribes or publishes."
    if not flows:
        what = "flow" if result.baseline else "flow from a subscription to a publish call"
        only = f"{result.kinds[0]} " if len(result.kinds) == 1 else ""
        further = "further " if result.left_out or result.silenced else ""
        return f"No {further}{new}{only}{what} in {many(files, 'file')}{accepted}."
    kinds = Counter(f.flow.kind for f in flows if f.flow)
    return f"{many(len(flows), new + 'flow')} in {_share(flows, files)}: {_listed(kinds)}{accepted}."


def _count_hazards(result: Result) -> str:
    hazards = Counter(f.code for f in result.new if not f.flow)
    known = sum(f.status == "accepted" and f.flow is None for f in result.findings)
    if not hazards and not known and (result.kinds or not result.reports_hazards):
        return ""
    new = "new " if result.baseline else ""
    found = f"{many(hazards.total(), new + 'hazard')}: {_listed(hazards)}" if hazards else f"No {new}hazard"
    files = "" if result.kinds else f" in {many(result.statistics.files, 'file')}"
    return f"{found}{files}{_accepted(result, known)}."


def _accepted(result: Result, known: int) -> str:
    return f" ({known} accepted in {shown(result.baseline)})" if result.baseline and known else ""


def _share(flows: list[Finding], files: int) -> str:
    """Return the number of files in which flows end: `1 file`, `2 of 12 files`."""
    hit = len({f.span.path for f in flows})
    return many(files, "file") if hit == files else f"{hit} of {many(files, 'file')}"


def _listed(counts: Counter[Any]) -> str:
    return ", ".join(f"{count} {name}" for name, count in sorted(counts.items()))


def numbers(accepted: Baseline) -> str:
    """Return the counts of a baseline: `14 flows`, `14 flows and 1 hazard`."""
    flows = sum(e.count for e in accepted.entries if isinstance(e.fingerprint, OfFlow))
    hazards = sum(e.count for e in accepted.entries if isinstance(e.fingerprint, OfHazard))
    return many(flows, "flow") + (f" and {many(hazards, 'hazard')}" if hazards else "")


def many(count: int, noun: str) -> str:
    """Return a count with its noun: `1 flow`, `2 flows`."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _missed(result: Result) -> Iterator[str]:
    notes = result.statistics.notes
    if result.errors:
        verb = "is" if len(result.errors) == 1 else "are"
        python = "" if any(e.path.endswith((*XML, *YAML)) for e in result.errors) else " as Python 3"
        yield f"{many(len(result.errors), 'file')} that {verb} not readable{python} ({UNREADABLE})"
    if cut := result.statistics.cut:
        yield f"parts of {many(len(cut), 'large program')} ({_named(cut)})"
    if notes.unreadable:
        yield f"{many(len(notes.unreadable), 'unreadable place')} ({', '.join(notes.unreadable[:3])})"
    if notes.cpp_nodes:
        yield many(notes.cpp_nodes, "C++ node")
    if notes.unread_nodes:
        verb = "was" if notes.unread_nodes == 1 else "were"
        yield f"{many(notes.unread_nodes, 'node')} that {verb} not read"
    if notes.remapping_launch_files:
        yield f"remaps in {many(notes.remapping_launch_files, 'launch file')}"
    if not result.follows_clients and (asking := sum(map(_asks, result.texts.values()))):
        yield f"what clients of services and actions send and receive in {many(asking, 'file')} (clients = true)"
    if unknown := unknown_topics(result):
        yield f"the names of {many(unknown, 'topic')} computed at run time"


def _asks(text: str) -> bool:
    return any(word in text for word in CLIENT_WORDS)


def _named(cut: Sequence[Cut]) -> str:
    """Return the names of programs by file and node, abbreviated if there are many."""
    names = [f"{c.path} as {c.node}" if c.node else c.path for c in cut]
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(names[:_SHOWN]) + more


def unknown_topics(result: Result) -> int:
    """Return the number of subscriptions and publish calls in flows with an unknown topic."""
    flows = [f.flow for f in result.findings if f.flow]
    ends = {e.span for flow in flows for e in (flow.source, flow.sink) if not e.topics}
    return len(ends)


def vanished(result: Result, view: View) -> Iterator[Line]:
    """Yield the accepted findings that are gone."""
    if not result.vanished or not result.baseline:
        return
    yield ((f"Accepted but no longer found, in {shown(result.baseline)}:", "strong"),)
    for entry in result.vanished[:_SHOWN]:
        yield ((f"  {in_words(entry, view.glyphs.arrow)}", ""),)
    if len(result.vanished) > _SHOWN:
        yield ((f"  and {len(result.vanished) - _SHOWN} more", "quiet"),)
    yield (("  Run --write-baseline to remove them.", "quiet"),)
    yield ()


def in_words(entry: Accepted, arrow: str) -> str:
    """Return an entry in words: `odom → cmd_vel, explicit, received by callback, published in travel (shuttle)`."""
    key = entry.fingerprint
    times = f", {entry.count} times" if entry.count > 1 else ""
    if isinstance(key, OfHazard):
        where = f" in {key.place}" if key.place else ""
        return f"{key.rule} {key.about.replace('→', arrow)}{where} ({key.package}){times}"
    by = f", received by {key.callback}" if key.callback else ""
    place = f", published in {key.place}" if key.place else ""
    return f"{key.source} {arrow} {key.sink}, {key.kind}{by}{place} ({key.package}){times}"


def unmatched(result: Result) -> Iterator[Line]:
    """Yield a line for each name in the settings that no file mentions."""
    for sentence in result.unmatched:
        yield ((sentence, "error"),)


def unused(result: Result) -> Iterator[Line]:
    """Yield the comments that silence nothing."""
    for comment in result.unused:
        where = f"{one_line(comment.path)}:{comment.line}:{comment.column}"
        yield ((where, "place"), (f" note: {in_vain(comment)}", ""))
    if result.unused:
        yield ()


def in_vain(comment: Suppression) -> str:
    """Return why a comment silences nothing."""
    if not comment.rules:
        return f"there is no rule {comment.code}: correct or remove this comment."
    what = f"no {comment.code}" if comment.code else "no finding"
    return f"there is {what} here for this comment to silence: remove it."


def statistics(result: Result) -> Iterator[Line]:
    """Yield the counts of a run, one per line."""
    flows = [f.flow for f in result.findings if f.flow]
    steps = Counter(step.dependence for flow in flows for step in flow.steps)
    lengths = sorted(sum(s.dependence != "context" for s in flow.steps) for flow in flows)
    rows = [
        *counts_of_findings(result),
        ("subscriptions that reach a publish call", len({flow.source.id for flow in flows})),
        ("publish calls reached", len({flow.sink.id for flow in flows})),
        ("steps that pass on the value", steps["data"]),
        ("steps that are conditions", steps["control"]),
        ("steps of a flow, median", lengths[len(lengths) // 2] if lengths else 0),
        ("files analysed", result.statistics.files),
        ("lines analysed", result.statistics.lines),
    ]
    yield from counted(rows)
    if flows:
        yield (("Publish calls reached, by subscribed topic:", ""),)
        yield from counted(_reach(flows))


def counts_of_findings(result: Result) -> list[tuple[str, int]]:
    """Return rows for `counted`: findings of each rule, unreadable files, and silenced and accepted findings."""
    return [
        *sorted(Counter(f.code for f in result.findings).items()),
        (UNREADABLE, len(result.errors)),
        ("silenced by comments", len(result.silenced)),
        ("silenced by per-file-ignores", result.left_out),
        ("accepted in the baseline", sum(f.status == "accepted" for f in result.findings)),
    ]


def counted(rows: Sequence[tuple[str, int]]) -> Iterator[Line]:
    """Yield rows of a name and its number, one per line, then an empty line."""
    width = max(len(str(number)) for _, number in rows)
    for name, number in rows:
        yield ((f"{number:>{width}}", "strong"), (f"  {name}", ""))
    yield ()


def _reach(flows: Sequence[Flow]) -> list[tuple[str, int]]:
    """Return pairs of a topic and the number of publish calls that it reaches, largest number first."""
    pairs = {(topic_text(flow.source.topics), flow.sink.id, flow.sink.span) for flow in flows}
    counts = Counter(topic for topic, *_ in pairs)
    return sorted(counts.items(), key=lambda item: (-item[1], item[0]))
