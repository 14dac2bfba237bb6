"""Patches of one text are merged, undone again, or conflict on named lines."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.changes import Replacement
from pytest_tarl.patching.merge import combined, conflicts, constants, same_change, separated
from pytest_tarl.patching.patch import split_lines

TEXT = b"a\nb\nc\nd\n"


def change(start: int, old: str, new: str) -> Replacement:
    return Replacement(start, tuple(split_lines(old.encode())), tuple(split_lines(new.encode())))


B, D = change(1, "b\n", "B\nBB\n"), change(3, "d\n", "")
BEFORE_C, BEFORE_C_TOO = change(2, "", "x\n"), change(2, "", "y\n")


@pytest.mark.parametrize(
    ("wanted", "expected"),
    [
        ([], "a\nb\nc\nd\n"),
        ([B, D], "a\nB\nBB\nc\n"),
        ([D, B], "a\nB\nBB\nc\n"),
        ([B, B], "a\nB\nBB\nc\nd\n"),
        ([BEFORE_C, BEFORE_C_TOO], "a\nb\nx\ny\nc\nd\n"),
        ([BEFORE_C_TOO, BEFORE_C], "a\nb\ny\nx\nc\nd\n"),
        ([BEFORE_C, B], "a\nB\nBB\nx\nc\nd\n"),
        ([BEFORE_C, change(2, "", "w\nx\n")], "a\nb\nw\nx\nc\nd\n"),  # one insertion contains the other
        ([change(0, "", "top\n"), change(4, "", "end\n")], "top\na\nb\nc\nd\nend\n"),
    ],
)
def test_separated_patches_undo_merged_changes(wanted: list[Replacement], expected: str) -> None:
    merged = combined(TEXT, wanted)
    assert merged == expected.encode()
    assert separated(merged, wanted) == TEXT


@pytest.mark.parametrize(
    ("wanted", "line"),
    [
        ([change(1, "z\n", "B\n")], 2),
        ([change(0, "a\nb\n", "A\n"), change(1, "b\nc\n", "C\n")], 2),
        ([change(3, "d\ne\n", "")], 4),
        ([change(1, "b\n", "B\n"), change(1, "b\n", "C\n")], 2),
    ],
)
def test_changes_of_other_lines_cannot_be_merged(wanted: list[Replacement], line: int) -> None:
    with pytest.raises(RepairError, match=rf"^Line {line} has changed"):
        combined(TEXT, wanted)


@pytest.mark.parametrize("content", [b"a\nB\nc\nd\n", b"a\nB\nBB!\nc\nd\n", b"B\nBB\nc\nd\n", b"a\nB\n", b""])
def test_a_text_without_the_changes_cannot_be_separated(content: bytes) -> None:
    assert separated(content, [B]) is None


def test_changes_that_overlap_cannot_be_separated() -> None:
    assert separated(b"x\nx\n", [change(0, "a\nb\n", "x\n"), change(1, "", "x\n")]) is None


@given(st.data())
def test_merging_disjoint_changes_can_always_be_undone(data: st.DataObject) -> None:
    lines = st.lists(st.sampled_from(["p\n", "q\n"]), max_size=3).map("".join)
    at, wanted, text = 0, [], ""
    for _ in range(data.draw(st.integers(0, 4))):
        kept, old, new = data.draw(lines.filter(bool)), data.draw(lines), data.draw(lines)
        at += kept.count("\n")
        wanted.append(change(at, old, new))
        at += old.count("\n")
        text += kept + old
    text += data.draw(lines)
    content = text.encode()
    assert separated(combined(content, wanted), wanted) == content


class Given(SimpleNamespace):
    """A patch that differs from every other one."""

    __hash__ = object.__hash__
    __eq__ = object.__eq__


def patch(name: str, *replacements: Replacement, file: str = "n.py", before: str = "0", **told: Any) -> Any:
    facts = told.get("constant", [])
    return Given(
        name=name,
        base=told.get("base", "."),
        files=(SimpleNamespace(name=file, before=before, replacements=replacements),),
        told=lambda key: [*facts] if key == "constant" else [],
    )


def lines(*patches: Any) -> list[str]:
    return [str(one) for one in conflicts(patches)]


C_AND_D, OTHER_C = change(2, "c\nd\n", "e\n"), change(2, "c\n", "f\n")


def test_patches_conflict_on_their_first_common_line() -> None:
    one, two = patch("one", B, C_AND_D), patch("two", D)
    assert lines(one, two) == ["n.py:4 is changed in two ways, by one and by two"]
    assert lines(two, one) == ["n.py:4 is changed in two ways, by two and by one"]
    assert lines(patch("one", C_AND_D), patch("two", OTHER_C)) == [
        "n.py:3 is changed in two ways, by one and by two"
    ]


def test_each_conflicting_line_is_named_once() -> None:
    three = [
        patch(name, change(1, "b\n", new)) for name, new in (("one", "x\n"), ("two", "y\n"), ("three", "z\n"))
    ]
    assert lines(*three) == [
        f"n.py:2 is changed in two ways, by {first} and by {second}"
        for first, second in (("one", "two"), ("one", "three"), ("two", "three"))
    ]  # fmt: skip
    wide = patch("wide", change(0, "a\nb\nc\nd\n", "e\n"))
    assert lines(wide, patch("both", B, D)) == [
        "n.py:2 is changed in two ways, by wide and by both",
        "n.py:4 is changed in two ways, by wide and by both",
    ]


@pytest.mark.parametrize(
    ("one", "two"),
    [
        (patch("one", B), patch("two", D)),
        (patch("one", B), patch("two", B)),
        (patch("one", BEFORE_C), patch("two", BEFORE_C_TOO)),
        (patch("one", B), patch("two", BEFORE_C)),
        (patch("one", BEFORE_C), patch("two", C_AND_D)),
        (patch("one", C_AND_D), patch("two", D, file="m.py")),
        (patch("one", C_AND_D), patch("two", D, before="1")),
    ],
    ids=["apart", "the same", "two insertions", "next line", "before a change", "other file", "other text"],
)
def test_patches_without_a_common_line_do_not_conflict(one: Any, two: Any) -> None:
    assert lines(one, two) == []


def test_patches_of_one_constant_conflict_on_its_definition() -> None:
    one = patch("one", B, constant=["src/n.py:7 column 3", "n.py:9 column 1", "src/n.py:7 column 3"])
    two = patch("two", D, constant=["n.py:8 column 1", "src/n.py:7 column 3"])
    assert constants(one) == ["src/n.py:7 column 3", "n.py:9 column 1"]
    assert lines(one, two) == ["src/n.py:7 is changed in two ways, by one and by two"]
    assert lines(one, patch("two", D, constant=["src/n.py:7 column 3"], base="..")) == []
    assert lines(one, patch("two", D, constant=["src/n.py:7 column 4"])) == []
    odd = ["no line"]
    assert lines(patch("one", B, constant=odd), patch("two", D, constant=odd)) == []
    # a common line was named already
    both = [patch(name, change(1, "b\n", name), constant=["n.py:1 column 1"]) for name in ("one", "two")]
    assert lines(*both) == ["n.py:2 is changed in two ways, by one and by two"]


def test_patches_with_the_same_files_make_the_same_change() -> None:
    one, two = patch("one", B), patch("two", D)
    assert same_change(one, SimpleNamespace(files=one.files))  # type: ignore[arg-type]
    assert not same_change(one, two)
