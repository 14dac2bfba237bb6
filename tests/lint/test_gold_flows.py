"""All findings in tests/cases, with every step, are those recorded under tests/lint/gold.

The marks in the cases tell which flows there are. The recorded lines tell in addition which statements they consist of,
their roles, the shortest chain, and what the rules report.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tarl_lint import engine
from tarl_lint.api import analyse
from tarl_lint.model import RULES, Finding, Flow, Span, Step
from tarl_lint.read import discover
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config
from tests.lint.gold_files import expected
from tests.lint.test_cases import CASES

GROUPS = ["", *sorted(path.name for path in CASES.iterdir() if path.is_dir() and path.name != "__pycache__")]
ROLES = {
    "register": "g",
    "receive": "v",
    "assign": "a",
    "call": "l",
    "return": "t",
    "condition": "n",
    "publish": "p",
}
PROBED = ("pid_with_windup", "gap_follower", "state_machine")  # cases whose constants are recorded, too


def described(findings: tuple[Finding, ...]) -> Iterator[str]:
    for finding in findings:
        yield f"{finding.span.path}:{finding.span.line}:{finding.span.column} {finding.code} {finding.message}"
        if finding.flow is not None:
            yield f"    {' '.join(parts(finding.flow))}"


def parts(flow: Flow) -> Iterator[str]:
    """Yield the ends of a flow, its steps as line, role and dependence, and the indices of its chain."""
    yield f"{flow.kind} {place(flow.source.span, flow.sink.span)} {flow.source.callback} {flow.source.api}"
    yield f"{flow.sink.qualname} {flow.sink.api}:"
    yield from (f"{place(s.span, flow.sink.span)}{ROLES[s.role]}{s.dependence[0]}" for s in flow.steps)
    if flow.chain:
        yield f"chain {' '.join(map(str, flow.chain))}"


def place(span: Span, beside: Span) -> str:
    return str(span.line) if span.path == beside.path else f"{span.path}:{span.line}"


def modules(folder: Path, config: Config) -> list[Module]:
    paths = [folder] if folder != CASES else sorted(CASES.glob("*.py"))
    files = discover.find(paths, config).files
    parsed = [
        parse(file.path.relative_to(CASES).as_posix(), file.path.read_bytes(), file.name) for file in files
    ]
    return [module for module in parsed if isinstance(module, Module)]


@pytest.mark.parametrize("group", GROUPS, ids=lambda name: name or "top")
def test_steps_of_all_findings_equal_the_gold_files(group):
    config = Config(root=CASES, select=RULES)
    lines = list(described(engine.lint(modules(CASES / group, config), config)))
    assert lines == expected(f"flows/{group or 'top'}.txt", "\n".join(lines) + "\n")


@pytest.mark.parametrize("case", PROBED)
def test_constants_and_conditions_equal_the_gold_files(case):
    analysis = analyse([CASES / "combined" / f"{case}.py"], root=CASES)

    def listed(steps: tuple[Step, ...]) -> list[str]:
        return [f"{step.span.line} {step.role} {step.site.text}" for step in steps]

    lines = ["timing:", *listed(analysis.timing), "deciding:", *listed(analysis.deciding), "sites:"]
    for step in analysis.sites:
        lines.append(f"{step.span.line} {step.site}")
        for one in analysis.operands(step.site):
            made = one.definition or one.span
            lines.append(
                f"    {one.span.column} {one.code} = {one.value} from {made.line}:{made.column} {one.setting}"
            )
    lines = [line.rstrip() for line in lines]
    assert lines == expected(f"constants/{case}.txt", "\n".join(lines) + "\n")
