"""JSON report of large systems: each statement occurs once, and flows refer to it by number."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Final

from tarl_lint.model import Finding, Step
from tarl_lint.report.json import statement
from tarl_lint.report.json2 import in_lines
from tarl_lint.report.line import Line
from tarl_lint.system import json
from tarl_lint.system.model import System

FORMAT_VERSION: Final = 2  # 2: numbered statements and shortest chains


def report(systems: Sequence[System], origin: str = "", target: str = "") -> Iterator[Line]:
    """Yield the document in ASCII, with one statement or system per line."""
    yield from in_lines(document(systems, origin, target))


def document(systems: Sequence[System], origin: str = "", target: str = "") -> dict[str, Any]:
    """Return all systems in the order of `system2.schema.json`."""
    steps: dict[Step, int] = {}

    def flow(finding: Finding) -> dict[str, Any]:
        """Return a flow by numbers; `chain` contains indices into the flow's `steps`."""
        found = finding.flow
        numbers = [steps.setdefault(step, len(steps)) for step in found.steps] if found is not None else []
        return {"steps": numbers, "chain": list(found.chain) if found is not None else []}

    head = json.document(systems, origin, target, flow)
    return {
        "format": FORMAT_VERSION,
        "tool": head["tool"],
        "steps": [statement(step) for step in steps],
        "systems": head["systems"],
    }
