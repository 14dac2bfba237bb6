"""Findings by package: code that runs on the robot first, tests and examples in a separate group."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from tarl_lint.model import Finding
from tarl_lint.report import closing_lines

TESTS_AND_EXAMPLES: Final = "Tests and examples"
_ASIDE: Final = re.compile(
    r"(?:^|/)(?:tests?|examples?|demos?|tutorials?|samples?)/|(?:^|/)(?:test_[^/]*|[^/]*_test)\.py$"
)


@dataclass(frozen=True)
class Group:
    """Findings that are shown together, in report order."""

    name: str
    findings: tuple[Finding, ...]

    @property
    def counted(self) -> str:
        """Return the counts of a group: `12 flows, 1 hazard`."""
        flows = sum(f.flow is not None for f in self.findings)
        counts = ((flows, "flow"), (len(self.findings) - flows, "hazard"))
        return ", ".join(closing_lines.many(count, noun) for count, noun in counts if count)


def grouped(findings: Sequence[Finding]) -> tuple[Group, ...]:
    """Return the findings by package, sorted by name. Packages whose code is not run on the robot come last."""
    aside = tuple(f for f in findings if _ASIDE.search(f.span.path))
    if len(aside) == len(findings):
        aside = ()  # findings only in examples and tests are grouped by package
    by_package: dict[str, list[Finding]] = {}
    for finding in findings:
        if finding not in aside:
            by_package.setdefault(finding.package, []).append(finding)
    groups = [Group(name, tuple(by_package[name])) for name in sorted(by_package)]
    return (*groups, Group(TESTS_AND_EXAMPLES, aside)) if aside else tuple(groups)
