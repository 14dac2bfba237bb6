"""Find modules in flows that are not searched, because the marker does not name them."""

from __future__ import annotations

from collections.abc import Iterator

from pytest_tarl.modules_in_flows import uses
from pytest_tarl.repairing.request import Order


def unnamed_modules(order: Order) -> Iterator[str]:
    """Yield a sentence for each such module."""
    told = {(order.root / shown).resolve() for shown in order.analysis.sources}
    for use in uses(order.analysis, order.root):
        if use.file not in told:
            told.add(use.file)
            place = use.file.relative_to(order.root.resolve()).as_posix()
            yield (
                f"a flow passes through {place} at {use.path}:{use.line}, but the marker does not name that "
                "file, so its constants were not searched: add it to nodes and record again"
            )
