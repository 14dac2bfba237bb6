"""A written patch is read back unchanged for any lines and line endings; suggestions replace only changed lines."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from pytest_tarl.errors import RepairError
from pytest_tarl.patching import patch_reader, suggesting
from pytest_tarl.patching.patch import (
    BASE,
    QUOTE,
    SEAL,
    TITLE,
    seal,
    unified_diff,
    unquoted,
    write,
    write_partial,
)
from tarl_lint.explain import known_rules

ROOT = Path(__file__).parent.parent.parent.parent
LINES = st.lists(st.sampled_from(["a = 1", "b = 2", "-- c", "++ d", "@@ e", "\\ f", ""]), max_size=12)
TEXTS = st.tuples(LINES, st.sampled_from(["", "\n"])).map(lambda made: "\n".join(made[0]) + made[1])


def patch(root: Path, before: str, after: str) -> patch_reader.Patch:
    """Write the patch of a repair of node.py and read it."""
    (root / "node.py").write_bytes(before.encode())
    file = root / "node.py"
    header = [f"{TITLE}0.1.0: 5 → 12 at node.py:9", "test: test_it.py::test_*", "drift: mud", "reward: 3 → 5"]
    header += [f"fixture: {'0' * 64} .tarl/utility/it.npz"]
    diff = unified_diff({file: before.encode()}, {file: after}, root, header)
    return patch_reader.read(write(diff, root / ".tarl" / "patches", "test_it.py::test_it", "mud"))


@given(TEXTS, TEXTS)
@settings(max_examples=60)
@example("a = 1", "b = 2\n")
@example("a = 1\nb = 2", "a = 1\nb = 3")
def test_a_written_patch_is_read_back_unchanged(before: str, after: str) -> None:
    if before == after:
        return
    with tempfile.TemporaryDirectory() as folder:
        (file,) = patch(Path(folder).resolve(), before, after).files
    assert file.exact(before.encode()) == file.applied(before.encode()) == after.encode()
    assert file.reverse.exact(after.encode()) == before.encode()


def test_evidence_escapes_markdown_and_lists_every_fact_except_digests(tmp_path: Path) -> None:
    found = patch(tmp_path, "a = 1\nb = 2\n", "a = 1\nb = 3\n")
    assert {BASE, SEAL, "fixture"} <= {key for key, _ in found.facts}
    (comment,) = json.loads(suggesting.review(found))["comments"]
    assert (comment["path"], comment["line"], "start_line" in comment) == ("node.py", 2, False)
    assert "b = 3" in comment["body"]
    _, _, *facts = json.loads(suggesting.review(found))["body"].splitlines()
    assert facts == ["- test: test\\_it.py::test\\_\\*", "- drift: mud", "- reward: 3 → 5"]


@pytest.mark.parametrize("content", [b"", b"x = 1\n", b"diff --git a/x b/x\n", b"\xff\xfe"])
def test_files_that_are_not_patches_are_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "x.patch"
    path.write_bytes(content)
    with pytest.raises(RepairError, match="is not a patch of TARL"):
        patch_reader.read(path)


NODE = "import a\n\nx = 1\ny = 2\nz = 3\n"


def result(found: patch_reader.Patch) -> dict[str, Any]:
    """Return the only result of the patch as SARIF."""
    (run,) = json.loads(suggesting.sarif(found))["runs"]
    (one,) = run["results"]
    assert run["tool"]["driver"]["rules"][one["ruleIndex"]]["id"] == one["ruleId"]
    return dict(one)


def test_repair_rule_is_documented_but_not_a_lint_rule(tmp_path: Path) -> None:
    rule = result(patch(tmp_path, NODE, NODE.replace("y = 2", "y = 4")))["ruleId"]
    assert rule not in known_rules()
    assert f"the rule `{rule}`" in (ROOT / "docs" / "ci.md").read_text()


def test_result_is_located_at_the_last_removed_lines(tmp_path: Path) -> None:
    found = patch(tmp_path, NODE, "import a\nimport b\n\nx = 9\ny = 2\nz = 8\nmore = 1\n")
    (location,) = result(found)["locations"]
    assert location["physicalLocation"]["region"] == {
        "startLine": 5,
        "startColumn": 1,
        "endLine": 6,
        "endColumn": 1,
    }
    (only,) = result(patch(tmp_path, NODE, NODE + "more = 1\n"))["locations"]
    assert only["physicalLocation"]["region"]["startLine"] == 6
    assert only["physicalLocation"]["artifactLocation"] == {"uri": "node.py", "uriBaseId": "%SRCROOT%"}


def test_sarif_fix_replaces_whole_lines(tmp_path: Path) -> None:
    one = result(patch(tmp_path, NODE, NODE.replace("y = 2", "y = 4")))
    ((change,),) = (fix["artifactChanges"] for fix in one["fixes"])
    assert change["replacements"] == [
        {
            "deletedRegion": {"startLine": 4, "startColumn": 1, "endLine": 5, "endColumn": 1},
            "insertedContent": {"text": "y = 4\n"},
        }
    ]
    assert one["fixes"][0]["description"]["text"] == "5 → 12 at node.py:9"
    assert one["message"]["text"] == (
        "test_it.py::test_* earns less than designed under the drift mud. Reward ."
    )


def test_insertions_are_suggested_together_with_a_neighbouring_line(tmp_path: Path) -> None:
    found = patch(tmp_path, NODE, NODE.replace("y = 2\n", "y = 2\nfirst = 1\nsecond = 2\n"))
    (comment,) = json.loads(suggesting.review(found))["comments"]
    assert (comment["line"], comment["body"]) == (4, "```suggestion\ny = 2\nfirst = 1\nsecond = 2\n```")
    start = patch(tmp_path, NODE, "top = 1\n" + NODE)
    (comment,) = json.loads(suggesting.review(start))["comments"]
    assert (comment["line"], comment["body"]) == (1, "```suggestion\ntop = 1\nimport a\n```")


def test_suggestion_fence_is_longer_than_any_in_the_text(tmp_path: Path) -> None:
    found = patch(tmp_path, "a = 1\n", "a = '````'\n")
    assert "`````suggestion\na = '````'\n`````\n" in suggesting.markdown(found)
    assert "`node.py`, line 1:" in suggesting.markdown(found)
    several = suggesting.markdown(patch(tmp_path, "a = 1\nb = 2\n", "c = 3\n"))
    assert "`node.py`, lines 1 to 2:\n\n```suggestion\nc = 3\n```\n" in several


def rewritten(root: Path, *changes: tuple[str, str]) -> Path:
    """Write a patch of node.py, replace texts in it, and seal it again."""
    (root / "node.py").write_text(NODE)
    file = root / "node.py"
    header = [f"{TITLE}0.1.0: a repair", "test: test_it.py::test_it"]
    diff = unified_diff({file: NODE.encode()}, {file: NODE.replace("y = 2", "y = 3")}, root, header)
    path = write(diff, root / ".tarl" / "patches", "test_it.py::test_it", "mud")
    text = path.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    lines = [line for line in text.splitlines(keepends=True) if not line.startswith(f"# {SEAL}:")]
    at = next(number for number, line in enumerate(lines) if line.startswith("diff "))
    digest = seal("".join(lines).encode())
    path.write_text("".join([*lines[:at], f"# {SEAL}: {digest}\n", *lines[at:]]))
    return path


def test_a_patch_with_a_newly_computed_seal_is_read(tmp_path: Path) -> None:
    found = patch_reader.read(rewritten(tmp_path))
    assert found.sealed
    assert found.told("test") == ["test_it.py::test_it"]
    assert [file.name for file in found.files] == ["node.py"]


@pytest.mark.parametrize(
    "changes",
    [
        [("@@ -2,4 +2,4 @@", "@@ -2,5 +2,4 @@")],
        [("@@ -2,4 +2,4 @@", "@@ -2,4 +2,3 @@")],
        [("@@ -2,4 +2,4 @@", "@@ -x,4 +2,4 @@")],
        [("@@ -2,4 +2,4 @@", "@@ -0,4 +2,4 @@")],
        [("-y = 2", "*y = 2")],
        [("+++ b/node.py", "+++ b/other.py")],
        [("--- a/node.py", "--- a/other.py")],
        [("--- a/node.py\n", "")],
        [("# test: ", "test: ")],
    ],
    ids=[
        "old length",
        "new length",
        "no number",
        "line 0",
        "sign",
        "new name",
        "old name",
        "no name",
        "header",
    ],
)
def test_edited_patch_counts_as_damaged(tmp_path: Path, changes: list[tuple[str, str]]) -> None:
    path = rewritten(tmp_path)
    changes = [(old.replace("@@ -2,4 +2,4 @@", hunk(path)), edited(new, path)) for old, new in changes]
    with pytest.raises(RepairError, match="is damaged: it was cut or edited"):
        patch_reader.read(rewritten(tmp_path, *changes))


def hunk(path: Path) -> str:
    """Return the line of a patch that begins its only hunk."""
    return next(line for line in path.read_text().splitlines() if line.startswith("@@ "))


def edited(new: str, path: Path) -> str:
    """Return the line that begins the hunk with the numbers changed as in `new`, given for -2,4 +2,4."""
    if not new.startswith("@@ "):
        return new
    _, old, fresh, *_ = hunk(path).split()
    start, _, count = old.removeprefix("-").partition(",")
    begin, _, size = fresh.removeprefix("+").partition(",")
    first, second = new.split()[1:3]
    one = "x" if "x" in first else "0" if first.startswith("-0") else start
    return f"@@ -{one},{int(count) + (first.endswith('5'))} +{begin},{int(size) - (second.endswith('3'))} @@"


def test_patch_with_two_sections_per_file_is_damaged(tmp_path: Path) -> None:
    path = rewritten(tmp_path)
    body = path.read_text().partition("diff --git")[2]
    with pytest.raises(RepairError, match="is damaged"):
        patch_reader.read(rewritten(tmp_path, (f"diff --git{body}", f"diff --git{body}diff --git{body}")))


def test_missing_patch_error_names_the_folder(tmp_path: Path) -> None:
    with pytest.raises(
        RepairError, match=r"gone\.patch cannot be read \(.*TARL writes patches to \.tarl/patches"
    ):
        patch_reader.read(tmp_path / "gone.patch")


def test_partial_repair_is_readable_only_by_tarl(tmp_path: Path) -> None:
    (tmp_path / "node.py").write_text(NODE)
    file = tmp_path / "node.py"
    header = [f"{TITLE}0.1.0: partial, a change", "partial: regains 4 of 9"]
    diff = unified_diff({file: NODE.encode()}, {file: NODE.replace("y = 2", "y = 3")}, tmp_path, header)
    path = write_partial(diff, tmp_path / ".tarl" / "patches", "test_it.py::test_a[b]", None)
    assert path.name == "test-it-test-a-b-online.partial"
    content = path.read_bytes()
    assert all(line.startswith(QUOTE) for line in content.splitlines())
    assert unquoted(content) == diff.encode()
    assert unquoted(diff.encode()) == diff.encode()
    found = patch_reader.read(path)
    assert found.told("partial") == ["regains 4 of 9"]
    (changed,) = found.files
    assert changed.exact(NODE.encode()) == NODE.replace("y = 2", "y = 3").encode()
    (tmp_path / "file").write_text("")
    with pytest.raises(RepairError, match="cannot be written"):
        write_partial(diff, tmp_path / "file", "t", "mud")


ODD = [
    "/abs.py",
    "a//b.py",
    "a/",
    "",
    ".",
    "a/./b.py",
    "../a.py",
    "a\\b.py",
    "a\x1b.py",
    "a/.git/b.py",
    ".TARL/b.py",
]


@pytest.mark.parametrize("name", ODD)
def test_file_names_outside_the_project_are_refused(name: str) -> None:
    assert not patch_reader._inside(name)


@pytest.mark.parametrize("name", ["a.py", "a/b c.py", "...py", "a/..b/.gitignore", "git/tarl.py", "ö.py"])
def test_file_names_inside_the_project_are_accepted(name: str) -> None:
    assert patch_reader._inside(name)
