"""The report of a designated test in one mode, and finished comparisons that are not reported yet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pytest_tarl.comparing import Online
from pytest_tarl.corrected_verdicts import corrected
from pytest_tarl.keeping import by_hand, keep
from pytest_tarl.model import Comparison
from pytest_tarl.report import ci, table, terminal, words
from pytest_tarl.report.table import Row


@dataclass(frozen=True)
class Account:
    """The report of a test: summary lines, reason for failure, patch to apply, and CI annotations."""

    lines: tuple[str, ...]
    problem: str = ""
    patch: Path | None = None
    interrupted: bool = False
    properties: tuple[tuple[str, str], ...] = ()
    annotation: str = ""
    row: Row = ()
    unrecorded: bool = False  # whether the test has no recording to compare with


@dataclass(frozen=True)
class Compared:
    """A finished comparison, to be reported as it is or after correction for multiple testing."""

    name: str  # base name of the files to write
    root: Path
    width: int
    comparison: Comparison
    online: Online
    episodes: Mapping[str, int]
    interrupted: bool = False

    def noted(self, note: str) -> Compared:
        """Return this comparison with one more note, before the others."""
        return replace(self, comparison=replace(self.comparison, notes=(note, *self.comparison.notes)))

    def told(self) -> Account:
        """Write the JSON result, the sample and the report page; return the report."""
        comparison = self.comparison
        kept = keep(comparison, self.online, self.episodes, self.root, self.name)
        lines = terminal.lines(comparison, width=self.width, root=self.root, page=kept.page)
        notes = [*kept.missing, *kept.unwritten, *by_hand(comparison.repair)]
        degraded = comparison.verdict.result == "degraded"
        written = comparison.repair.patch if comparison.repair else ""
        return Account(
            lines=(*lines, *notes),
            problem=f"degraded: {words.verdict_sentence(comparison)}" if degraded else "",
            patch=self.root / written if written else None,
            properties=(
                *ci.properties(comparison),
                *(("tarl_unwritten", one.strip()) for one in kept.unwritten),
            ),
            annotation=ci.annotation(comparison, self.root),
            row=table.row(comparison),
            interrupted=self.interrupted,
        )


def jointly(compared: Sequence[Compared], alpha: float) -> list[Compared]:
    """Return the comparisons with verdicts corrected for multiple testing at level `alpha`."""
    judged = corrected([one.comparison for one in compared], alpha)
    return [replace(one, comparison=comparison) for one, comparison in zip(compared, judged, strict=True)]
