"""Patches as applied by `git apply` and `patch -p1`."""

from __future__ import annotations

import os
import py_compile
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.patch import _file_diff, apply_command, blob_id, readable, unified_diff, write
from pytest_tarl.patching.rewriting import rewrite
from tests.plugin.patching.repairs import MUD, TOPICS, HandMade, TinyRos, odometry, subscribing, terrain

HEADER = [
    "Repair of tests/test_x.py::test_delivers under the drift mud",
    "",
    "when: terrain\nepisodes: 46",
    "--- a/x",
    "@@ -1 +1 @@",
]
NODE = """\
# Größe
import rospy
from nav_msgs.msg import Odometry

pos = None


def callback(msg):
\tglobal pos
\tpos = msg.pose.pose.position.x


def step(pub):
\tpub.publish(5 * pos)  # ½ m


rospy.init_node("n")
rospy.Subscriber("/odom", Odometry, callback)
pub = rospy.Publisher("/vel", Odometry, queue_size=1)"""


def run(*command: str, cwd: Path) -> None:
    environment = {
        **os.environ,
        "GIT_CONFIG_GLOBAL": os.devnull,
        "GIT_CONFIG_SYSTEM": os.devnull,
        "LC_ALL": "C",
    }
    done = subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def repository(path: Path) -> Path:
    path.mkdir(parents=True, exist_ok=True)
    run("git", "init", "-q", cwd=path)
    return path


def patched(root: Path, changed: Mapping[Path, str]) -> Path:
    originals = {path: path.read_bytes() for path in changed}
    diff = unified_diff(originals, changed, root, HEADER)
    return write(diff, root / ".tarl" / "patches", "tests/test_x.py::test_delivers", "mud")


def shell(command: str, cwd: Path) -> None:
    run("sh", "-c", command, cwd=cwd)


def repaired(text: str) -> str:
    """Decode a file as Python does, analyse it, and change its constant 5 under the condition `mud`."""
    sources = {"node.py": text.replace("\r\n", "\n")}
    flows = subscribing(
        sources, "node.py", 'rospy.Subscriber("/odom", Odometry, callback)', "rospy.Subscriber"
    )
    analysis = HandMade(sources, flows)
    return rewrite(analysis, [Mutation(analysis.operand("5", 5, "5 *"), 12.0)], MUD, TOPICS)["node.py"]


@pytest.mark.parametrize("tool", ["git apply", "patch -p1"])
@pytest.mark.parametrize("ending", ["\n", "\r\n"])
@pytest.mark.parametrize("final", [True, False])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1"])
def test_the_patched_file_equals_the_simulated_file_and_runs(
    tmp_path: Path, tool: str, ending: str, final: bool, encoding: str
) -> None:
    cookie = "# -*- coding: latin-1 -*-\n" if encoding == "latin-1" else ""
    text = (cookie + NODE + ("\n" if final else "")).replace("\n", ending)
    root = repository(tmp_path / "robot")
    node = root / "node.py"
    node.write_bytes(text.encode(encoding))
    simulated = repaired(text)
    patch = patched(root, {node: simulated})
    if tool == "git apply":
        run("git", "apply", "--check", str(patch), cwd=root)
        shell(apply_command(patch, root), root)
    else:
        shell(f"patch -p1 < {patch}", root)
    assert node.read_bytes() == simulated.replace("\n", ending).encode(encoding)
    py_compile.compile(str(node), str(tmp_path / "node.pyc"), doraise=True)
    ros = TinyRos()
    space = ros.run({"node.py": node.read_text(encoding)}, "node.py")
    ros.deliver("/odom", odometry(1.0))
    for message in (None, True, False):
        if message is not None:
            ros.deliver("/terrain", terrain(message))
        space["step"](space["pub"])
    assert ros.published == [5.0, 12.0, 5.0]


def test_new_text_keeps_its_own_line_endings(tmp_path: Path) -> None:
    node = tmp_path / "node.py"
    node.write_bytes(b"a = 5\r\nb = 2\n")
    patch = patched(tmp_path, {node: "a = 7\r\nb = 2\n"})
    shell(apply_command(patch, tmp_path), tmp_path)
    assert node.read_bytes() == b"a = 7\r\nb = 2\n"


def test_frequent_lines_between_two_changes_are_kept() -> None:
    """difflib by default does not match lines that are frequent in a file of at least 200 lines."""
    lines = [f"x{n} = 0\n" for n in range(300)]
    for blank in (10, 20, 30, 40, 101, 102):
        lines[blank] = "\n"
    after = [*lines]
    after[100], after[103] = "y = 1\n", "z = 1\n"
    diff = _file_diff("node.py", "".join(lines).encode(), "".join(after).encode()).splitlines()
    changes = ["-x100 = 0", "+y = 1", " ", " ", "-x103 = 0", "+z = 1"]
    around = [f" x{n} = 0" for n in (97, 98, 99, 104, 105, 106)]
    assert diff[4:] == ["@@ -98,10 +98,10 @@", *around[:3], *changes, *around[3:]]


def test_mixed_line_endings_are_kept_in_unchanged_lines(tmp_path: Path) -> None:
    node = tmp_path / "node.py"
    node.write_bytes(b"a = 5\r\nb = 2\nc = 3\r\n")
    patch = patched(tmp_path, {node: "a = 5\nb = 2\nd = 4\nc = 3\n"})
    shell(apply_command(patch, tmp_path), tmp_path)
    assert node.read_bytes() == b"a = 5\r\nb = 2\nd = 4\r\nc = 3\r\n"


@pytest.mark.parametrize("at", [".", "examples/shuttle", "examples/shuttle/src", "examples", "other"])
def test_a_patch_applies_from_anywhere_in_the_repository(tmp_path: Path, at: str) -> None:
    top = repository(tmp_path / "robot")
    root = top / "examples" / "shuttle"
    node = root / "src" / "my node.py"
    node.parent.mkdir(parents=True)
    (top / "other").mkdir()
    node.write_text("a = 5\n")
    patch = patched(root, {node: "a = 7\n"})
    assert b"--- a/examples/shuttle/src/my node.py\t\n" in patch.read_bytes()
    shell(apply_command(patch, top / at), top / at)
    assert node.read_text() == "a = 7\n"


def test_the_command_that_applies_a_patch_is_usually_short(tmp_path: Path) -> None:
    root = repository(tmp_path / "robot")
    (root / "node.py").write_text("a = 5\n")
    patch = patched(root, {root / "node.py": "a = 7\n"})
    assert apply_command(patch, root) == f"git apply .tarl/patches/{patch.name}"


@pytest.mark.parametrize("nested", ["src/driver", "elsewhere/../src/driver"])
def test_patch_of_a_nested_repository_is_applied_there(tmp_path: Path, nested: str) -> None:
    root = tmp_path / "workspace"
    (root / "elsewhere").mkdir(parents=True)
    inner = repository(root / nested)
    node = inner / "node.py"
    node.write_text("a = 5\n")
    patch = patched(root, {node: "a = 7\n"})
    assert apply_command(patch, root) == f"git -C src/driver apply ../../.tarl/patches/{patch.name}"
    shell(apply_command(patch, root), root)
    assert node.read_text() == "a = 7\n"


def test_a_patch_applies_without_a_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nodes = [tmp_path / "src" / name for name in ("a.py", "b.py")]
    nodes[0].parent.mkdir()
    for node in nodes:
        node.write_text("a = 5\n")
    patch = patched(tmp_path, dict.fromkeys(nodes, "a = 7\n"))
    shell(apply_command(patch, tmp_path / "src"), tmp_path / "src")
    assert [node.read_text() for node in nodes] == ["a = 7\n"] * 2
    shell(f"patch -R -p1 < {patch}", tmp_path)
    monkeypatch.setattr(shutil, "which", lambda name: None)
    shell(apply_command(patch, tmp_path / "src"), tmp_path / "src")
    assert [node.read_text() for node in nodes] == ["a = 7\n"] * 2


def test_a_symbolic_link_into_the_sources_is_followed(tmp_path: Path) -> None:
    root = repository(tmp_path / "robot")
    (root / "install").mkdir()
    (root / "node.py").write_text("a = 5\n")
    (root / "install" / "node.py").symlink_to(root / "node.py")
    patch = patched(root, {root / "install" / "node.py": "a = 7\n"})
    shell(apply_command(patch, root), root)
    assert (root / "node.py").read_text() == "a = 7\n"
    assert (root / "install" / "node.py").is_symlink()


def test_files_of_two_repositories_are_refused(tmp_path: Path) -> None:
    nodes = [repository(tmp_path / name) / "node.py" for name in ("one", "two")]
    for node in nodes:
        node.write_text("a = 5\n")
    with pytest.raises(RepairError, match="several repositories"):
        patched(tmp_path, dict.fromkeys(nodes, "a = 7\n"))


def test_text_that_the_encoding_cannot_represent_is_refused(tmp_path: Path) -> None:
    node = tmp_path / "node.py"
    node.write_bytes(b"# coding: ascii\na = 5\n")
    with pytest.raises(RepairError, match="encoded in ascii"):
        patched(tmp_path, {node: "# coding: ascii\na = 'ü'\n"})


def test_bytes_of_other_encodings_can_be_printed(tmp_path: Path) -> None:
    node = tmp_path / "node.py"
    node.write_bytes("# coding: latin-1\na = 5  # ü\n".encode("latin-1"))
    diff = unified_diff({node: node.read_bytes()}, {node: "# coding: latin-1\na = 7  # ü\n"}, tmp_path, [])
    assert "-a = 5  # \ufffd\n+a = 7  # \ufffd\n" in readable(diff)
    readable(diff).encode()


def test_a_patch_is_named_after_test_drift_and_content(tmp_path: Path) -> None:
    first = write("a", tmp_path, "tests/test_x.py::test_delivers", "mud")
    assert first.name == "tests-test-x-test-delivers-mud-ca978112.patch"
    assert write("a", tmp_path, "tests/test_x.py::test_delivers", "mud") == first
    assert write("b", tmp_path, "tests/test_x.py::test_delivers", None).name.startswith(
        "tests-test-x-test-delivers-online-"
    )
    assert len(list(tmp_path.iterdir())) == 2


def test_the_header_consists_of_comments(tmp_path: Path) -> None:
    (tmp_path / "node.py").write_text("a = 5\n")
    diff = unified_diff(
        {tmp_path / "node.py": b"a = 5\n"}, {tmp_path / "node.py": "a = 7\n"}, tmp_path, HEADER
    )
    head, _, body = diff.partition("diff --git ")
    assert all(line.startswith("#") for line in head.splitlines())
    index = f"index {blob_id(b'a = 5' + bytes([10]))}..{blob_id(b'a = 7' + bytes([10]))}"
    assert (
        body
        == f"a/node.py b/node.py\n{index}\n--- a/node.py\n+++ b/node.py\n@@ -1,1 +1,1 @@\n-a = 5\n+a = 7\n"
    )


line = st.sampled_from(
    ["a = 5", "", "\tb = 'ü'", "c\r", "x\x0cy", "d\u2028e", "--- a/x", "+++ b/x", "@@ -1 +1 @@"]
)
content = st.tuples(st.lists(line, max_size=12), st.booleans())


@settings(max_examples=60)
@given(before=content, after=content)
def test_applying_a_patch_gives_exactly_the_new_bytes(
    tmp_path_factory: pytest.TempPathFactory, before: tuple[list[str], bool], after: tuple[list[str], bool]
) -> None:
    old, new = ("\n".join(lines) + ("\n" if final and lines else "") for lines, final in (before, after))
    if "\r\n" in old and "\r\n" not in new:
        new += "\r\n"
    if not old or not new or old == new:
        return
    root = tmp_path_factory.mktemp("files")
    node = root / "node.py"
    node.write_bytes(old.encode())
    patch = patched(root, {node: new})
    shell(apply_command(patch, root), root)
    assert node.read_bytes() == new.encode()


@pytest.mark.parametrize("tops", [(), (".",), ("ws",), ("ws/src",), (".", "ws"), ("other",), (".", "other")])
@pytest.mark.parametrize("root", ["ws", "ws/src/pkg", "other"])
@pytest.mark.parametrize("names", [("ws/src/pkg/node.py",), ("ws/src/pkg/node.py", "ws/src/lib/helper.py")])
def test_the_printed_apply_command_works_in_any_folder(
    tmp_path: Path, tops: tuple[str, ...], root: str, names: tuple[str, ...]
) -> None:
    files = [tmp_path / name for name in names]
    for folder in ("ws/src/pkg", "ws/src/lib", "other", "ws/src/pkg/deep"):
        (tmp_path / folder).mkdir(parents=True, exist_ok=True)
    for top in tops:
        repository(tmp_path / top)
    for folder in (".", "ws", "ws/src", "ws/src/pkg", "ws/src/pkg/deep", "ws/src/lib", "other"):
        for file in files:
            file.write_text("a = 5\n")
        patch = patched(tmp_path / root, dict.fromkeys(files, "a = 7\n"))
        shell(apply_command(patch, tmp_path / folder), tmp_path / folder)
        assert [file.read_text() for file in files] == ["a = 7\n"] * len(files), folder
