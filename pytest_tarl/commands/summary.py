"""`tarl summary`: the results of the last comparisons as Markdown, for a comment on a pull request or a job's page."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pytest_tarl.errors import FixtureError

MARKS = {"degraded": "❌", "drifted": "⚠️"}
BARS = 8  # maximum number of statements in a chart


def markdown(folder: Path) -> str:
    """Return the results in a folder, `.tarl/results`, as Markdown.

    Raise FixtureError if there are none, or one of them cannot be read.
    """
    paths = sorted(folder.glob("*.json"))
    if not paths:
        raise FixtureError(f"{folder}: no result found. Run pytest --tarl-online first.")
    documents = [_read(path) for path in paths]
    lines = [
        "| test | drift | verdict | loss per episode | where | first statement | repair |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [_row(document) for document in documents]
    for document in documents:
        if document["verdict"]["result"] == "degraded" and document["sites"]:
            lines += ["", *_picture(document)]
    return "\n".join(lines) + "\n"


def _read(path: Path) -> Mapping[str, Any]:
    try:
        document = json.loads(path.read_text("utf-8"))
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
        f"{verdict['loss']:.3g} (p = {verdict['p_loss']:.2g})" if result == "degraded" else "",
        _plain("; ".join(_words(place) for place in document["region"])),
        f"`{_plain(first['path'])}:{first['line']}`" if first and result != "no difference" else "",
        _repair(document.get("repair")),
    )
    return f"| {' | '.join(cells)} |"


def _words(place: Mapping[str, Sequence[float]]) -> str:
    return ", ".join(
        f"{name} {low:g}" if low == high else f"{name} {low:g} to {high:g}"
        for name, (low, high) in place.items()
    )


def _repair(repair: Mapping[str, Any] | None) -> str:
    if not repair or not repair["accepted"]:
        return ""
    edits = ", ".join(f"{_plain(edit['code'])} → {edit['value']:g}" for edit in repair["edits"])
    where = f" where {_plain(repair['guard'])}" if repair.get("guard") else ""
    return f"{edits}{where}"


def _picture(document: Mapping[str, Any]) -> Iterator[str]:
    """Yield a Mermaid chart of the statements with the largest losses: designed (bars) and deployed utility (line)."""
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
    """Return a text without characters that end a table cell, a code span or a title."""
    return str(text).translate(_HARMLESS)


_HARMLESS = str.maketrans('|`"\n<>', "¦'' ‹›")
