"""Report a comparison as JUnit properties and a GitHub annotation."""

from __future__ import annotations

import os
from pathlib import Path

from pytest_tarl.model import Comparison, Culprit
from pytest_tarl.report import amounts, repair_words, words

LEVELS = {"degraded": "error", "drifted": "warning"}
_IN_TEXT = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A"})
_IN_PROPERTY = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A", ":": "%3A", ",": "%2C"})


def properties(comparison: Comparison) -> tuple[tuple[str, str], ...]:
    """Return the known JUnit properties in a fixed order."""
    verdict, repair = comparison.verdict, comparison.repair
    found = {
        "tarl_verdict": verdict.result,
        "tarl_p_drift": f"{verdict.p_drift:.3g}",
        "tarl_p_loss": f"{verdict.p_loss:.3g}",
        "tarl_loss": amounts.amount(verdict.loss),
        "tarl_p_failures": f"{verdict.p_failures:.3g}" if "success" in verdict.because else "",
        "tarl_loss_interval": words.loss_interval(comparison),
        "tarl_region": words.region_words(comparison) if verdict.result != "no difference" else "",
        "tarl_culprit": _blamed(comparison.culprits[0]) if _guilty(comparison) else "",
        "tarl_patch": repair.patch if repair else "",
    }
    return tuple((name, value) for name, value in found.items() if value)


def annotation(comparison: Comparison, root: Path) -> str:
    """Return the GitHub workflow command that marks the first culprit's line; empty if there is no culprit.

    The path is relative to the checkout; `root` may be a subfolder of it.
    """
    if not _guilty(comparison):
        return ""
    culprit, level = comparison.culprits[0], LEVELS[comparison.verdict.result]
    title = f"{comparison.test}[{comparison.drift or 'online'}]: {comparison.verdict.result}"
    file = _in_checkout(root / culprit.site.path).translate(_IN_PROPERTY)
    place = f"file={file},line={culprit.site.line},title={title.translate(_IN_PROPERTY)}"
    return f"::{level} {place}::{_message(comparison).translate(_IN_TEXT)}"


def _message(comparison: Comparison) -> str:
    region, repair = words.region_words(comparison), comparison.repair
    culprit = comparison.culprits[0]
    blamed = "ranked first by its slice" if culprit.method == "slices" else "ranked first by simulation"
    lines = [words.verdict_sentence(comparison), f"Where: {region}." if region else ""]
    lines.append(f"{words.one_line(culprit.site.code)} is {blamed}.")
    if repair and repair.accepted:
        where = f" ({repair.patch})" if repair.patch else ""
        lines.append(f"Accepted repair: {repair_words.repair_words(repair)}{where}.")
    return "\n".join(line for line in lines if line)


def _guilty(comparison: Comparison) -> bool:
    return comparison.verdict.result in LEVELS and bool(comparison.culprits)


def _blamed(culprit: Culprit) -> str:
    return f"{culprit.site.path}:{culprit.site.line} {words.one_line(culprit.site.code)}"


def _in_checkout(path: Path) -> str:
    checkout = Path(os.environ.get("GITHUB_WORKSPACE") or Path.cwd())
    return (path.relative_to(checkout) if path.is_relative_to(checkout) else path).as_posix()
