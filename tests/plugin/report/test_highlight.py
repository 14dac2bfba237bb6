from __future__ import annotations

import re
from difflib import unified_diff
from html import unescape

from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.report.highlight import code_html, patch_lines

DIFF = """\
--- a/node.py
+++ b/node.py
@@ -3,3 +3,3 @@ def f():
 kept = 1
-old = "<b>"
+new = 2
--- = 5
\\ No newline at end of file
"""


def text(html: str) -> str:
    return unescape(re.sub(r"<[^>]*>", "", html))


@given(st.text(st.characters(exclude_categories=["Cc", "Cs", "Zl", "Zp"])))
def test_highlighting_never_changes_the_text(code):
    assert text(code_html(code)) == code


def test_markup_in_code_is_escaped():
    assert "<script" not in code_html("x = '</code><script>alert(1)</script>'")


def test_patch_lines_have_old_and_new_line_numbers():
    found = [(line.kind, line.old, line.new, text(line.html)) for line in patch_lines(DIFF)]
    assert found == [
        ("file", None, None, "--- a/node.py"),
        ("file", None, None, "+++ b/node.py"),
        ("hunk", None, None, "@@ -3,3 +3,3 @@ def f():"),
        ("kept", 3, 3, "kept = 1"),
        ("removed", 4, None, 'old = "<b>"'),
        ("added", None, 4, "new = 2"),
        ("removed", 5, None, "-- = 5"),
        ("remark", None, None, "\\ No newline at end of file"),
    ]


def test_numbering_restarts_with_each_file():
    diff = "--- a/x\n+++ b/x\n@@ -1 +1 @@\n-a\n+b\n--- a/y\n+++ b/y\n@@ -7 +7,2 @@\n c\n+d\n"
    kinds = [line.kind for line in patch_lines(diff)]
    assert kinds == ["file", "file", "hunk", "removed", "added", "file", "file", "hunk", "kept", "added"]
    assert [line.new for line in patch_lines(diff)][-2:] == [7, 8]


TEXTS = st.lists(st.sampled_from(["a = 1", "b = 2", "c = 3", ""]), max_size=12)


@given(TEXTS, TEXTS, st.integers(0, 2))
def test_each_patch_line_is_found_at_its_numbers(before: list[str], after: list[str], around: int) -> None:
    made = list(unified_diff(before, after, "a/x", "b/x", lineterm="", n=around))
    found = list(patch_lines("\n".join(made)))
    assert len(found) == len(made)
    for line, written in zip(found, made, strict=True):
        kind = {"-": "removed", "+": "added", " ": "kept", "@": "hunk"}[written[:1]]
        assert line.kind == ("file" if written in ("--- a/x", "+++ b/x") else kind)
        if line.old is not None:
            assert before[line.old - 1] == written[1:]
        if line.new is not None:
            assert after[line.new - 1] == written[1:]
        assert (line.old is not None) == (line.kind in ("kept", "removed"))
        assert (line.new is not None) == (line.kind in ("kept", "added"))


def test_lines_after_a_hunk_belong_to_the_next_file() -> None:
    diff = "--- a/x\n+++ b/x\n@@ -1,3 +1,2 @@\n a\n b\n-c\n--- a/y\n+++ b/y\n@@ -1,2 +1,3 @@\n a\n b\n+c\n--- a/z\n"
    kinds = [line.kind for line in patch_lines(diff)]
    part = ["file", "file", "hunk", "kept", "kept"]
    assert kinds == [*part, "removed", *part, "added", "file"]
