"""Severity and identity of findings, for formats that need them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Literal

from tarl_lint.fingerprints import digest
from tarl_lint.model import Finding
from tarl_lint.read.source import SourceError
from tarl_lint.run.runner import Result

Level = Literal["note", "warning", "error"]


def own_level(code: str) -> Level:
    """Return the level of a rule: note for flows, warning for hazards and unreadable files."""
    return "note" if code.startswith("TARL1") else "warning"


def level(code: str, result: Result) -> Level:
    """Return the level of a new finding: error if it fails the run."""
    return "error" if code in result.failing else own_level(code)


def told_apart(findings: Sequence[Finding]) -> Iterator[tuple[Finding, str]]:
    """Yield findings with unique identities: the fingerprint, with a number if several findings share it."""
    seen: Counter[str] = Counter()
    for finding in findings:
        base = finding.fingerprint or digest((finding.code, finding.span.path, finding.message))
        seen[base] += 1
        yield finding, f"{base}:{seen[base]}"


def of_error(error: SourceError) -> str:
    """Return the identity of an unreadable file."""
    return digest(("TARL001", error.path))
