"""Patches on files whose lines have moved."""

from __future__ import annotations

import pytest

from pytest_tarl.patching.changes import FilePatch, Hunk, MisfitError, Replacement
from pytest_tarl.patching.patch import blob_id

TWIN = b"x = 1\ny = 2\n"
ABOVE, BETWEEN = b"a\nb\nc\nd\ne\n", b"g\nh\n"
BEFORE = (
    ABOVE + b"f\n" + BETWEEN.join((b"k\n", TWIN, TWIN, TWIN, b"z\n"))
)  # TWIN stands at lines 9, 13 and 17
AFTER = ABOVE + b"F\n" + BETWEEN.join((b"k\n", TWIN, b"x = 7\ny = 2\n", TWIN, b"z\n"))
PATCH = FilePatch(
    "node.py",
    blob_id(BEFORE),
    blob_id(AFTER),
    (
        Hunk(5, (("-", b"f\n"), ("+", b"F\n"), (" ", b"k\n"))),
        Hunk(13, (("-", b"x = 1\n"), ("+", b"x = 7\n"), (" ", b"y = 2\n"))),
    ),
)


def test_patch_can_be_applied_and_undone() -> None:
    assert PATCH.exact(BEFORE) == PATCH.applied(BEFORE) == AFTER
    assert PATCH.reverse.exact(AFTER) == PATCH.reverse.applied(AFTER) == BEFORE
    assert PATCH.exact(BEFORE + b"\n") is None


@pytest.mark.parametrize("lines", range(3, 12))
def test_ambiguous_hunk_uses_the_previous_offset(
    lines: int,
) -> None:
    above = b"".join(b"# %d\n" % n for n in range(lines))
    assert PATCH.applied(above + BEFORE) == above + AFTER


def test_removed_lines_move_the_next_hunk_up() -> None:
    moved = FilePatch("node.py", "", "", tuple(Hunk(hunk.start + 20, hunk.lines) for hunk in PATCH.hunks))
    assert moved.applied(BEFORE) == AFTER


def test_unplaced_hunk_is_named_by_its_line() -> None:
    with pytest.raises(MisfitError) as raised:
        PATCH.applied(BEFORE.replace(b"x = 1", b"x = 3"))
    assert raised.value.args == (14,)


def test_hunks_are_placed_in_order() -> None:
    both = FilePatch("node.py", "", "", (PATCH.hunks[1], PATCH.hunks[0]))
    with pytest.raises(MisfitError):
        both.applied(BEFORE)


def test_replacements_name_changed_lines_without_context() -> None:
    assert PATCH.replacements == (
        Replacement(5, (b"f\n",), (b"F\n",)),
        Replacement(13, (b"x = 1\n",), (b"x = 7\n",)),
    )
    assert PATCH.replacements[1].end == 14
