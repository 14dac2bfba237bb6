"""How grave findings are and how they are told apart, for formats that ask for it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Literal

from tarl_lint.fingerprints import digest
from tarl_lint.model import Finding
from tarl_lint.runner import Result
from tarl_lint.source import SourceError

Level = Literal["note", "warning", "error"]


def own_level(code: str) -> Level:
    """Grade a rule by itself: that a flow exists is a note, hazards and unreadable files are warnings."""
    return "note" if code.startswith("TARL1") else "warning"


def level(code: str, result: Result) -> Level:
    """Grade a new finding in a run: what makes the run fail is an error."""
    return "error" if code in result.failing else own_level(code)


def told_apart(findings: Sequence[Finding]) -> Iterator[tuple[Finding, str]]:
    """Yield findings with an identity of their own: the fingerprint, numbered where several share it."""
    seen: Counter[str] = Counter()
    for finding in findings:
        base = finding.fingerprint or digest((finding.code, finding.span.path, finding.message))
        seen[base] += 1
        yield finding, f"{base}:{seen[base]}"


def of_error(error: SourceError) -> str:
    """Return the identity of a file that cannot be read."""
    return digest(("TARL001", error.path))
