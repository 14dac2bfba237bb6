"""Quick fixes: ignore a finding with a comment, accept it into the baseline, or apply an accepted repair."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from lsprotocol import types

from pytest_tarl.editor.positions import Places

ACCEPT = "tarl.accept"
APPLY = "tarl.apply"
_IGNORED = re.compile(r"#\s*tarl:\s*ignore\[([^\]]*)\]")


def fixes(
    uri: str, path: str, found: Sequence[types.Diagnostic], patches: Iterable[Path], places: Places
) -> list[types.CodeAction]:
    """Return quick fixes for the diagnostics at a place, and actions that apply repairs to the same file."""
    actions = []
    for diagnostic in found:
        data: Any = diagnostic.data
        if not isinstance(data, dict) or not data.get("new"):
            continue
        code = str(data["code"])
        actions.append(
            types.CodeAction(
                f"Ignore {code} on this line",
                types.CodeActionKind.QuickFix,
                diagnostics=[diagnostic],
                edit=types.WorkspaceEdit({uri: [_comment(path, diagnostic.range, code, places)]}),
            )
        )
        actions.append(
            types.CodeAction(
                f"Accept this {code} into the baseline",
                types.CodeActionKind.QuickFix,
                diagnostics=[diagnostic],
                command=types.Command("Accept into the baseline", ACCEPT, arguments=[data["fingerprint"]]),
            )
        )
    actions += [
        types.CodeAction(
            f"Apply the repair {patch.name}",
            types.CodeActionKind.QuickFix,
            command=types.Command("Apply the repair", APPLY, arguments=[str(patch)]),
        )
        for patch in patches
    ]
    return actions


def _comment(path: str, at: types.Range, code: str, places: Places) -> types.TextEdit:
    """Return the edit that adds an ignore comment, or adds the rule's code to an existing one."""
    number = at.end.line + 1
    line = places.line(path, number)
    known = _IGNORED.search(line)
    if known is not None:
        place = places.position(path, number, known.end(1) + 1)
        return types.TextEdit(types.Range(place, place), f", {code}")
    place = places.end_of_line(path, number)
    return types.TextEdit(types.Range(place, place), f"  # tarl: ignore[{code}]")
