"""A run with every kind of finding, for tests of reports."""

from dataclasses import replace
from pathlib import Path

from tarl_lint.model import Finding
from tarl_lint.read.discover import Notes
from tarl_lint.read.source import SourceError
from tarl_lint.report import render
from tarl_lint.report.line import View, plain
from tarl_lint.run.runner import Result, Statistics
from tarl_lint.suppress import Suppression


def everything(example, *, baseline: Path | None = Path("tarl-flows.json")) -> Result:
    """Return a run with two new flows into one call, an accepted flow, a hazard and a Python 2 file."""
    accepted = replace(example.finding("implicit", "joy"), status="accepted")
    hazard = Finding("TARL203", example.span("pos = data.pose"), "scan [raw] reaches nothing, 100 % lost.")
    return Result(
        findings=(example.finding(), example.finding("implicit", "scan"), accepted, hazard),
        errors=(SourceError("old.py", 3, "This is Python 2: port it."),),
        unused=(Suppression("node.py", 4, 7, "TARL102"),),
        texts={"node.py": example.text},
        statistics=Statistics(files=2, lines=30, notes=Notes(cpp_nodes=3)),
        baseline=baseline,
        failing=frozenset({"TARL101", "TARL203"}),
    )


def text_of(name: str, result: Result) -> str:
    return "".join(plain(line) + "\n" for line in render(name, result, View()))
