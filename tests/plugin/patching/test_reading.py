"""A written patch is read back unchanged for any lines and line endings; suggestions replace only changed lines."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from pytest_tarl.errors import RepairError
from pytest_tarl.patching import reading, suggesting
from pytest_tarl.patching.patch import BASE, SEAL, TITLE, unified_diff, write

LINES = st.lists(st.sampled_from(["a = 1", "b = 2", "-- c", "++ d", "@@ e", "\\ f", ""]), max_size=12)
TEXTS = st.tuples(LINES, st.sampled_from(["", "\n"])).map(lambda made: "\n".join(made[0]) + made[1])


def patch(root: Path, before: str, after: str) -> reading.Patch:
    """Write the patch of a repair of node.py and read it."""
    (root / "node.py").write_bytes(before.encode())
    file = root / "node.py"
    header = [f"{TITLE}0.1.0: 5 → 12 at node.py:9", "test: test_it.py::test_*", "drift: mud", "reward: 3 → 5"]
    header += [f"fixture: {'0' * 64} .tarl/utility/it.npz"]
    diff = unified_diff({file: before.encode()}, {file: after}, root, header)
    return reading.read(write(diff, root / ".tarl" / "patches", "test_it.py::test_it", "mud"))


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
def test_other_files_are_not_read_as_patches(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "x.patch"
    path.write_bytes(content)
    with pytest.raises(RepairError, match="is not a patch of TARL"):
        reading.read(path)
