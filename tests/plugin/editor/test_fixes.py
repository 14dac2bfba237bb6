"""Quick fixes: a comment that ignores the finding, acceptance into the baseline, repairs of the file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("lsprotocol")

from lsprotocol import types

from pytest_tarl.editor.fixes import ACCEPT, APPLY, fixes
from pytest_tarl.editor.positions import Places

URI = "file:///pilot.py"
NEW = {"fingerprint": "f1", "code": "TARL101", "new": True}


def diagnostic(data: Any, line: int = 0, end: int | None = None) -> types.Diagnostic:
    last = line if end is None else end
    return types.Diagnostic(types.Range(types.Position(line, 0), types.Position(last, 3)), "m", data=data)


def made(text: str, *found: types.Diagnostic, patches: tuple[Path, ...] = ()) -> list[types.CodeAction]:
    return fixes(URI, "pilot.py", found, patches, Places(Path("/"), {"pilot.py": text}))


def edit(text: str, found: types.Diagnostic) -> tuple[int, int, str]:
    """Return the place and the text of the edit that ignores a finding."""
    (change,) = made(text, found)[0].edit.changes[URI]  # type: ignore[union-attr, index]
    assert change.range.start == change.range.end
    return change.range.start.line, change.range.start.character, change.new_text


def test_a_new_finding_can_be_ignored_or_accepted() -> None:
    found = diagnostic(NEW)
    ignore, accept = made("a = 1\n", found)
    assert (ignore.title, accept.title) == (
        "Ignore TARL101 on this line",
        "Accept this TARL101 into the baseline",
    )
    assert {ignore.kind, accept.kind} == {types.CodeActionKind.QuickFix}
    assert (ignore.diagnostics, accept.diagnostics) == ([found], [found])
    assert ignore.command is None
    assert accept.command == types.Command("Accept into the baseline", ACCEPT, arguments=["f1"])


@pytest.mark.parametrize("data", [None, [], {}, {**NEW, "new": False}, {"code": "TARL101"}])
def test_accepted_findings_and_other_diagnostics_have_no_fix(data: Any) -> None:
    assert made("a = 1\n", diagnostic(data)) == []


def test_finding_without_a_fix_does_not_shift_later_fixes() -> None:
    other = {**NEW, "code": "TARL201"}
    titles = [one.title for one in made("a\n", diagnostic(None), diagnostic(NEW), diagnostic(other))]
    assert [title.split()[1] for title in titles[::2]] == ["TARL101", "TARL201"]
    assert len(titles) == 4


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a = 1\nb = 2\n", (0, 5, "  # tarl: ignore[TARL101]")),
        ("🤖 = 1", (0, 6, "  # tarl: ignore[TARL101]")),
        ("a = 1  # tarl: ignore[TARL201]\n", (0, 29, ", TARL101")),
        ("a = 1  #tarl:ignore[TARL201, TARL102]  # why\n", (0, 36, ", TARL101")),
        ("🤖 = 1  # tarl: ignore[TARL201]\n", (0, 30, ", TARL101")),
        ("a = 1  # ignore[TARL201]\n", (0, 24, "  # tarl: ignore[TARL101]")),
    ],
)
def test_ignore_comment_is_added_or_extended(text: str, expected: tuple[int, int, str]) -> None:
    assert edit(text, diagnostic(NEW)) == expected


def test_comment_of_a_long_statement_is_on_its_last_line() -> None:
    assert edit("f(\n    a,\n)\n", diagnostic(NEW, 0, 2)) == (2, 1, "  # tarl: ignore[TARL101]")


def test_repairs_of_a_file_apply_without_a_finding() -> None:
    first, second = Path("/p/one.patch"), Path("/p/two.patch")
    shown = made("a\n", patches=(first, second))
    assert [one.title for one in shown] == ["Apply the repair one.patch", "Apply the repair two.patch"]
    assert [one.command for one in shown] == [
        types.Command("Apply the repair", APPLY, arguments=[str(path)]) for path in (first, second)
    ]
    assert {one.kind for one in shown} == {types.CodeActionKind.QuickFix}
    assert len(made("a\n", diagnostic(NEW), patches=(first,))) == 3
