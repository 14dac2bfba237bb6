"""`tarl summary`: show the results of the last comparisons and stress runs as Markdown.

The output is meant for a pull request comment or the page of a CI job.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pytest_tarl.commands import margins_diff
from pytest_tarl.commands.margins_files import margins_in
from pytest_tarl.errors import FixtureError
from pytest_tarl.files import read_regular
from pytest_tarl.report.guarantee_words import percent
from pytest_tarl.stressing.margin_changes import compared

MARKS = {"degraded": "❌", "drifted": "⚠️"}
BARS = 8  # maximum number of statements in a chart


def markdown(folder: Path, since: str | None = None) -> str:
    """Return the results and margins in `folder` as Markdown.

    With `since`, compare the margins with those at this git revision. Raise FixtureError if there are no results or a
    file cannot be read.
    """
    paths = sorted(folder.glob("*.json"))
    margins = folder.parent / "margins"
    tables = [
        *([_comparisons([_read(path) for path in paths])] if paths else []),
        *([_margins(margins, since)] if any(margins.glob("*.json")) else []),
    ]
    if not tables:
        raise FixtureError(f"{folder}: no result found. Run pytest --tarl-online or --tarl-stress first.")
    return "\n\n".join("\n".join(lines) for lines in tables) + "\n"


def _margins(folder: Path, since: str | None) -> list[str]:
    """Return the margins as a table, compared with a revision if one is given."""
    now = margins_in(str(folder))
    before = [] if since is None else margins_in(f"{since}:{folder.as_posix()}")
    rows = compared(before, now)
    if since is None:
        return list(margins_diff.table(rows))
    notes = margins_diff.guarantees_changed(before, now)
    return [*margins_diff.markdown(rows, f"at {_plain(since)}"), *(f"\n{_plain(note)}" for note in notes)]


def _comparisons(documents: Sequence[Mapping[str, Any]]) -> list[str]:
    lines = [
        "| test | drift | verdict | loss per episode | where | first statement | repair |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [_row(document) for document in documents]
    for document in documents:
        if document["verdict"]["result"] == "degraded" and document["sites"]:
            lines += ["", *_picture(document)]
    return lines


def _read(path: Path) -> Mapping[str, Any]:
    try:
        document = json.loads(read_regular(path).decode("utf-8"))
        _row(document)
        tuple(_picture(document))
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise FixtureError(f"{path}: not a result of TARL ({error}). Compare again.") from None
    found: Mapping[str, Any] = document
    return found


def _row(document: Mapping[str, Any]) -> str:
    verdict = document["verdict"]
    result = str(verdict["result"])
    first = next(iter(document["culprits"]), None)
    cells = (
        f"`{_plain(document['test'])}`",
        _plain(document["drift"]),
        f"{MARKS.get(result, '✅')} {result}",
        _worse(verdict) if result == "degraded" else "",
        _plain("; ".join(_words(place) for place in document["region"])),
        f"`{_plain(first['path'])}:{first['line']}`" if first and result != "no difference" else "",
        _repair(document.get("repair")),
    )
    return f"| {' | '.join(cells)} |"


def _worse(verdict: Mapping[str, Any]) -> str:
    """Describe what decreased; results of earlier versions have only the loss."""
    if verdict.get("because") == ["success"]:
        before, after = (float(verdict["success"][world]) for world in ("offline", "online"))
        return f"success {percent(after)} instead of {percent(before)} (p = {verdict['p_failures']:.2g})"
    return f"{verdict['loss']:.3g} (p = {verdict['p_loss']:.2g})"


def _words(place: Mapping[str, Sequence[float]]) -> str:
    return ", ".join(
        f"{name} {low:g}" if low == high else f"{name} {low:g} to {high:g}"
        for name, (low, high) in place.items()
    )


def _repair(repair: Mapping[str, Any] | None) -> str:
    if not repair or not repair["accepted"]:
        return ""
    edits = ", ".join(
        _plain(edit.get("what") or f"{edit['code']} → {edit['value']:g}") for edit in repair["edits"]
    )
    where = f" where {_plain(repair['guard'])}" if repair.get("guard") else ""
    return f"{edits}{where}"


def _picture(document: Mapping[str, Any]) -> Iterator[str]:
    """Yield a Mermaid chart of the statements with the largest losses."""
    worst = sorted(document["sites"], key=lambda site: float(site["difference"]))[:BARS]
    shown = sorted(worst, key=lambda site: (str(site["path"]), int(site["line"])))
    names = ", ".join(f'"{Path(str(site["path"])).name}:{site["line"]}"' for site in shown)
    yield "```mermaid"
    yield "xychart-beta"
    yield f'  title "Utility by statement: designed (bars), {_plain(document["drift"])} (line)"'
    yield f"  x-axis [{names}]"
    yield f"  bar [{', '.join(format(float(site['offline']), '.4g') for site in shown)}]"
    yield f"  line [{', '.join(format(float(site['online']), '.4g') for site in shown)}]"
    yield "```"


def _plain(text: object) -> str:
    """Return a string without Markdown's special characters."""
    return str(text).translate(_HARMLESS)


_HARMLESS = str.maketrans('|`"\n<>', "¦'' ‹›")
