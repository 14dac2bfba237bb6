"""Reports of systems with one finding or flow per line: concise, and the log of GitHub."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tarl_lint.files import shown
from tarl_lint.report import closing_lines
from tarl_lint.report import github as pull_request
from tarl_lint.report.line import Line, View, one_line
from tarl_lint.report.text import errors, heading
from tarl_lint.run.runner import Result
from tarl_lint.system.chain_lines import in_line
from tarl_lint.system.counts import statistics
from tarl_lint.system.flow_chains import limited, shown_chains
from tarl_lint.system.model import Chain, System


def concise(
    systems: Sequence[System], result: Result, view: View, origin: str = "", target: str = ""
) -> Iterator[Line]:
    """Yield one line per hazard and one line per flow across nodes, then the closing lines."""
    yield from errors(result)
    yield from map(heading, result.new)
    found = [shown_chains(system.hops, origin, target, view.most_flows) for system in systems]
    yield from flows(systems, found, view)
    yield from (line for line in closing_lines.vanished(result, view) if line)
    if view.statistics:
        yield from statistics(systems, [one for one, _ in found], result)
    yield from closing_lines.closing(result)


def github(
    systems: Sequence[System], result: Result, view: View, origin: str = "", target: str = ""
) -> Iterator[Line]:
    """Yield the annotations of the hazards; flows appear only in the log."""
    yield from pull_request.report(result, view)
    found = [shown_chains(system.hops, origin, target, view.most_flows) for system in systems]
    yield from flows(systems, found, view)


def flows(
    systems: Sequence[System], chains: Sequence[tuple[Sequence[Chain], bool]], view: View
) -> Iterator[Line]:
    """Yield a line for each flow across nodes: the launch file, then topics and nodes.

    `chains` has the chains of each system, and says for each whether there may be more.
    """
    for system, (all_found, more) in zip(systems, chains, strict=True):
        found, rest = limited(all_found, view.most_flows, more=more)
        place = one_line(shown(system.file))
        for chain in found:
            yield ((f"{place}: ", "place"), *in_line(chain, view.glyphs))
        if rest:
            yield ((f"{place}: ", "place"), (rest, "quiet"))
