"""Counts of launched systems."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from tarl_lint.report.closing_lines import counted, counts_of_findings
from tarl_lint.report.line import Line
from tarl_lint.run.runner import Result
from tarl_lint.system.model import Chain, System
from tarl_lint.system.one_sided_names import one_sided


def statistics(
    systems: Sequence[System], chains: Sequence[Sequence[Chain]], result: Result
) -> Iterator[Line]:
    """Yield the counts of a run, one per line. Nodes and flows count once for each launch file that has them.

    `chains` has the flows of each system across its nodes: with `--from` and `--to`, those between these topics.
    """
    nodes = [one for system in systems for one in system.instances if one.node.kind != "test"]
    kinds = Counter(chain.kind for found in chains for chain in found)
    lonely = Counter(one.missing for system in systems for one in one_sided(system))
    yield from counted(
        [
            *counts_of_findings(result),
            ("launch files", sum(not one.file.is_dir() for one in systems)),
            ("nodes", len(nodes)),
            ("nodes that were not read", sum(one.interface is None for one in nodes)),
            ("flows across nodes, explicit", kinds["explicit"]),
            ("flows across nodes, implicit", kinds["implicit"]),
            ("flows across nodes, through nodes that were not read", kinds["not read"]),
            ("subscribed topics without a publisher", lonely["publishes"]),
            ("called services without a server", lonely["serves"]),
            ("used actions without a server", lonely["performs"]),
            ("files analysed", result.statistics.files),
        ]
    )
