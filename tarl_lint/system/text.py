"""Text report of systems: a table of nodes, flows across nodes, hazards, and the files that were not read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from tarl_lint.files import shown
from tarl_lint.report import closing_lines
from tarl_lint.report.closing_lines import many
from tarl_lint.report.line import Glyphs, Line, View
from tarl_lint.report.text import errors, heading
from tarl_lint.run.runner import Result
from tarl_lint.system.chain_lines import in_line, statements
from tarl_lint.system.counts import statistics
from tarl_lint.system.details import details
from tarl_lint.system.flow_chains import limited, shown_chains, slashed
from tarl_lint.system.model import Chain, Instance, Role, System
from tarl_lint.system.one_sided_names import one_sided

HEADINGS: Final = ("node", "program", "subscribes", "publishes")
SHOWN: Final = 4  # maximum number of similar topics that a message suggests
WIDEST: Final = 44  # maximum width of a list of topics (columns)

_ROLES: Final[tuple[Role, Role]] = ("subscribes", "publishes")
# role that no known node has → the heading; a verb for what users of the name do; a verb for what other nodes may
# do
_MISSING: Final[Mapping[Role, tuple[str, str, str]]] = {
    "publishes": ("No publisher", "heard by", "publish"),
    "serves": ("No server", "called by", "offer"),
    "performs": ("No action server", "used by", "offer"),
}


def report(
    systems: Sequence[System], result: Result, view: View, origin: str = "", target: str = ""
) -> Iterator[Line]:
    """Yield the lines of all systems. With `origin` or `target`, only the chains between these topics.

    The lines at the end concern all systems: unreadable files, silenced findings, entries of the baseline that
    are gone.
    """
    chains = [shown_chains(system.hops, origin, target, view.most_flows) for system in systems]
    for number, (system, found) in enumerate(zip(systems, chains, strict=True)):
        if number:
            yield ()
        yield from _system(system, found, view, origin, target)
    found_by_system = [found for found, _ in chains]
    closing = list(_closing(systems, found_by_system, result, view, brief=bool(origin or target)))
    if closing:
        yield ()
        yield from closing


def _closing(
    systems: Sequence[System], chains: Sequence[Sequence[Chain]], result: Result, view: View, *, brief: bool
) -> Iterator[Line]:
    if view.statistics:
        yield from statistics(systems, chains, result)
    if not brief:
        yield from errors(result)
    elif result.errors:
        yield from closing_lines.not_analysed(result)
    if not result.reports_hazards:
        yield (("No rule about launch files (TARL3) is enabled.", "quiet"),)
    yield from closing_lines.silenced(result)
    yield from closing_lines.vanished(result, view)


def _system(
    system: System, chains: tuple[Sequence[Chain], bool], view: View, origin: str, target: str
) -> Iterator[Line]:
    tests = sum(one.node.kind == "test" for one in system.instances)
    unread = sum(one.interface is None for one in system.instances) - tests
    count = many(len(system.instances) - tests, "node") + (f", {many(tests, 'test')}" if tests else "")
    name = f"{shown(system.file)}, names as in the code" if system.file.is_dir() else shown(system.file)
    yield ((name, "strong"), (f": {count}{f', {unread} not read' if unread else ''}", ""))
    if not (origin or target):
        yield from _table(system, view.glyphs)
    all_found, more = chains
    found, rest = limited(all_found, view.most_flows, more=more)
    yield ()
    if found or rest:
        yield (("Flows across nodes:", "strong"),)
        for chain in found:
            yield (("  ", ""), *in_line(chain, view.glyphs))
            if view.show_paths or view.all_steps:
                yield from statements(chain, view)
        if rest:
            yield ((f"  {rest}", "quiet"),)
    else:
        yield ((_nothing(system, origin, target), ""),)
    yield from _findings(system)
    if not (origin or target):
        yield from _lonely(system)
        yield from _problems(system)


def _nothing(system: System, origin: str, target: str) -> str:
    """Return the message that there is no chain; it names topics that do not exist."""
    if not (origin or target):
        return "No flows across nodes."
    known = {name for one in system.instances for role in _ROLES for name, _ in one.named(role)}
    known |= {name for one in system.instances for name in one.touched}
    missing = [slashed(one) for one in (origin, target) if one and slashed(one) not in known]
    if missing:
        last = {one.rpartition("/")[2] for one in missing}
        close = sorted(name for name in known if name.rpartition("/")[2] in last)
        meant = f" Did you mean {' or '.join(close[:SHOWN])}?" if close else ""
        return f"No node that was read uses {' or '.join(missing)}.{meant}"
    ends = [f"{word} {slashed(one)}" for word, one in (("from", origin), ("to", target)) if one]
    return f"Nothing flows {' '.join(ends)}."


def _table(system: System, glyphs: Glyphs) -> Iterator[Line]:
    rows = [_row(one, glyphs) for one in system.instances]
    if not rows:
        return
    counted = [HEADINGS, *rows]
    widths = [max(len(row[column]) for row in counted if column < len(row) - 1 or len(row) == len(HEADINGS))
              for column in range(len(HEADINGS))]  # fmt: skip
    for number, row in enumerate(counted):
        text = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=False)).rstrip()
        yield ((text, "quiet" if not number or len(row) < len(HEADINGS) else ""),)
        more = details(system.instances[number - 1], system.settings, glyphs) if number else ""
        if more:
            yield ((f"  {more}", "quiet"),)


def _row(instance: Instance, glyphs: Glyphs) -> tuple[str, ...]:
    """Return the cells of a node; for an unread node, with the reason."""
    node = instance.node
    where = f"{node.package}/{node.executable}" if node.package else node.executable
    name = f"{instance.name} ({node.condition})" if node.condition else instance.name
    if instance.interface is None and not instance.seen:
        return name, where, f"not read: {instance.unread}"
    where = f"{where} (C++, not read)" if instance.seen else where
    subscribed, published = ([name for name, _ in instance.named(role)] for role in _ROLES)
    return name, where, _listed(subscribed, glyphs), _listed(published, glyphs)


def _listed(names: Sequence[str], glyphs: Glyphs) -> str:
    return _cropped(", ".join(dict.fromkeys(names)), WIDEST, glyphs)


def _cropped(text: str, width: int, glyphs: Glyphs) -> str:
    return text if len(text) <= width else text[: width - len(glyphs.dots)] + glyphs.dots


def _findings(system: System) -> Iterator[Line]:
    new = [one for one in system.findings if one.status == "new"]
    if new:
        yield ()
        yield (("Hazards:", "strong"),)
        yield from ((("  ", ""), *heading(one)) for one in new)
    accepted = len(system.findings) - len(new)
    if accepted:
        yield ((f"{accepted} accepted by the baseline.", "quiet"),)


def _lonely(system: System) -> Iterator[Line]:
    """Yield the topics, services and actions that nodes use but no known node offers."""
    found = one_sided(system)
    for missing, (title, verb, may) in _MISSING.items():
        chosen = [one for one in found if one.missing == missing]
        if chosen:
            yield ()
            yield ((f"{title} here:", "strong"),)
        for one in chosen:
            types = f" ({' or '.join(one.types)})" if one.types else ""
            doubt = "" if one.certain else f"; a part that was not read may {may} it"
            yield (
                (f"  {one.name}", "place"),
                (f"{types}: {verb} {', '.join(one.users)}", ""),
                (doubt, "quiet"),
            )


def _problems(system: System) -> Iterator[Line]:
    if system.problems:
        yield ()
        yield (("Not known here:", "strong"),)
        for one in system.problems:
            place = f"{shown(one.file)}:{one.line}" if one.line else shown(one.file)
            yield ((f"  {place}", "place"), (f": {one.reason}", ""))
