"""Text report of systems: a table of nodes, flows across nodes, hazards, and what was not read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from tarl_lint.files import shown
from tarl_lint.model import Finding, Step
from tarl_lint.report.line import Glyphs, Line, Style, View, location
from tarl_lint.system.chains import chains, slashed
from tarl_lint.system.details import details
from tarl_lint.system.model import Chain, Hop, Instance, Role, System

HEADINGS: Final = ("node", "program", "subscribes", "publishes")
SHOWN: Final = 4  # maximum number of similar topics that a message suggests
WIDEST: Final = 44  # maximum width of a list of topics (columns)

_ROLES: Final[tuple[Role, Role]] = ("subscribes", "publishes")
_KINDS: Final[Mapping[str, Style]] = {"explicit": "explicit", "implicit": "implicit", "not read": "quiet"}


def report(systems: Sequence[System], view: View, origin: str = "", target: str = "") -> Iterator[Line]:
    """Yield the lines of all systems. With `origin` or `target`, only the chains between these topics."""
    for number, system in enumerate(systems):
        if number:
            yield ()
        yield from _system(system, view, origin, target)


def _system(system: System, view: View, origin: str, target: str) -> Iterator[Line]:
    tests = sum(one.node.kind == "test" for one in system.instances)
    unread = sum(one.interface is None for one in system.instances) - tests
    count = counted(len(system.instances) - tests, "node") + (f", {counted(tests, 'test')}" if tests else "")
    name = f"{shown(system.file)}, names as in the code" if system.file.is_dir() else shown(system.file)
    yield ((name, "strong"), (f": {count}{f', {unread} not read' if unread else ''}", ""))
    if not (origin or target):
        yield from _table(system, view.glyphs)
    found, more = chains(system.hops, origin, target)
    yield ()
    if found:
        yield (("Flows across nodes:", "strong"),)
        for chain in found:
            yield from _chain(chain, view)
        if more:
            yield (("  … and more: select them with --from and --to.", "quiet"),)
    else:
        yield ((_nothing(system, origin, target), ""),)
    yield from _findings(system)
    if not (origin or target):
        yield from _problems(system)


def counted(number: int, noun: str) -> str:
    """Return a number with its noun in singular or plural."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _nothing(system: System, origin: str, target: str) -> str:
    """Return a message that there is no chain, with the requested topics that do not exist."""
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
    """Return the cells of a node; for a node that was not read, the last cell is the reason."""
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


def _chain(chain: Chain, view: View) -> Iterator[Line]:
    arrow = f" {view.glyphs.arrow} "
    pieces: list[tuple[str, Style]] = [("  ", ""), (chain.hops[0].source, "place")]
    for hop in chain.hops:
        node: tuple[str, Style] = (hop.node, "")
        if hop.kind == "not read":
            node = (f"[{hop.node}, not read]", "quiet")
        pieces += [(arrow, ""), node, (arrow, ""), (hop.sink, "place")]
    yield (*pieces, (f"  {chain.kind}", _KINDS[chain.kind]))
    if view.show_paths or view.all_steps:
        for hop in chain.hops:
            yield from _steps(hop, view)


def _steps(hop: Hop, view: View) -> Iterator[Line]:
    """Yield the taint list of a hop: its shortest chain of statements, or all of them."""
    if not hop.findings or hop.findings[0].flow is None:
        return
    flow = hop.findings[0].flow
    named = f"    {hop.node}: {hop.source} {view.glyphs.arrow} {hop.sink}"
    yield (named, "quiet"), (f"  {hop.kind}", _KINDS[hop.kind])
    steps = flow.steps if view.all_steps or not flow.chain else [flow.steps[index] for index in flow.chain]
    for step in steps:
        yield _step(step, view.glyphs)


def _step(step: Step, glyphs: Glyphs) -> Line:
    sign = {"data": glyphs.data, "control": glyphs.control, "context": glyphs.context}[step.dependence]
    code = " ".join(step.code.split())
    return ((f"      {sign} ", step.dependence if step.dependence != "context" else "quiet"),
            (f"{location(step.span)}", "place"), (f"  {code}", ""))  # fmt: skip


def _findings(system: System) -> Iterator[Line]:
    new = [one for one in system.findings if one.status == "new"]
    if new:
        yield ()
        yield (("Hazards:", "strong"),)
        yield from map(_finding, new)
    accepted = len(system.findings) - len(new)
    if accepted:
        yield ((f"{accepted} accepted by the baseline.", "quiet"),)


def _finding(finding: Finding) -> Line:
    return (
        ("  ", ""),
        (location(finding.span), "place"),
        (f" {finding.code} ", "hazard"),
        (finding.message, ""),
    )


def _problems(system: System) -> Iterator[Line]:
    if system.problems:
        yield ()
        yield (("Not known here:", "strong"),)
        for one in system.problems:
            place = f"{shown(one.file)}:{one.line}" if one.line else shown(one.file)
            yield ((f"  {place}", "place"), (f": {one.reason}", ""))
