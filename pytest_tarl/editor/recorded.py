"""Results of the last comparisons by line: utility, its difference under a drift, rank, and accepted repairs.

They are read from `.tarl/results/*.json`. Statements are matched by site ID and not by line number, so lines that moved
keep their figures.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pytest_tarl.files import read_regular
from tarl_lint.editing import Result
from tarl_lint.model import Step


@dataclass(frozen=True)
class Figures:
    """The figures of a statement in one comparison; utilities are in units of reward."""

    test: str
    drift: str
    offline: float
    online: float
    rank: int | None = None  # rank among the culprits, starting at 1

    @property
    def difference(self) -> float:
        """Return how much the statement's utility changes from the designed to the deployed world."""
        return self.online - self.offline


@dataclass(frozen=True)
class Recorded:
    """All comparisons of a project; `patches` maps edited files to the patches of accepted repairs."""

    by_site: Mapping[str, tuple[Figures, ...]] = field(default_factory=dict)
    patches: Mapping[str, tuple[Path, ...]] = field(default_factory=dict)


def read(root: Path) -> Recorded:
    """Read the results below `.tarl`; skip files that are damaged or in another format."""
    found = [_document(path, root) for path in sorted(root.joinpath(".tarl", "results").glob("*.json"))]
    sites: dict[str, list[Figures]] = {}
    patches: dict[str, list[Path]] = {}
    for figures, edited, patch in filter(None, found):
        for site, one in figures:
            sites.setdefault(site, []).append(one)
        for path in edited:
            patches.setdefault(path, []).append(patch)
    return Recorded(
        {site: tuple(one) for site, one in sites.items()}, {path: tuple(one) for path, one in patches.items()}
    )


def _document(path: Path, root: Path) -> tuple[list[tuple[str, Figures]], list[str], Path] | None:
    """Return the figures of one comparison, the files that its repair edits, and the patch."""
    try:
        document = json.loads(read_regular(path).decode("utf-8"))
        figures = list(_figures(document))
        repair = document.get("repair") or {}
        patch = root / str(repair.get("patch"))
        fits = repair.get("accepted") is True and patch.is_file()
        edited = sorted({str(edit["path"]) for edit in repair["edits"]}) if fits else []
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return None
    return figures, edited, patch


def _figures(document: Mapping[str, Any]) -> Iterator[tuple[str, Figures]]:
    ranks = {culprit["site"]: rank for rank, culprit in enumerate(document["culprits"], 1)}
    for site in document["sites"]:
        yield (
            str(site["site"]),
            Figures(
                str(document["test"]),
                str(document["drift"]),
                float(site["offline"]),
                float(site["online"]),
                ranks.get(site["site"]),
            ),
        )


def steps(result: Result, path: str) -> dict[str, Step]:
    """Return the statements of a file that belong to a flow, by site id."""
    flows = (finding.flow for finding in (*result.findings, *result.silenced) if finding.flow is not None)
    return {str(step.site): step for flow in flows for step in flow.steps if step.span.path == path}


def hover(figures: tuple[Figures, ...]) -> str:
    """Return a Markdown table of a statement's figures."""
    rows = []
    for one in figures:
        utilities = f"{one.offline:.4g} | {one.online:.4g} | {one.difference:+.4g}"
        rows.append(f"| `{one.test}` | {one.drift} | {utilities} | {one.rank or ''} |")
    head = "| test | drift | utility as designed | under the drift | difference | rank |"
    return "\n".join([head, "|---|---|---:|---:|---:|---:|", *rows])


def hint(figures: tuple[Figures, ...]) -> str:
    """Return the inlay hint for a statement; empty if no comparison ranks it."""
    ranked = [one for one in figures if one.rank is not None]
    return ", ".join(f"#{one.rank} {one.drift} {one.difference:+.3g}" for one in ranked)
