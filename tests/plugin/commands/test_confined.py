"""For any patch, `tarl apply` writes only tested text and only inside the project, and changes all files or none."""

from __future__ import annotations

import hashlib
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from pytest_tarl.commands import applying, replacing
from pytest_tarl.commands.cli import main
from pytest_tarl.patching.patch import SEAL, TITLE, unified_diff, write

Printed = pytest.CaptureFixture[str]
NODE = (
    "import rospy\n\nGAIN = 5\nlow = 1\nhigh = 2\n\n\ndef step(x):\n    missing = low\n    return GAIN * x\n"
)
DONE = NODE.replace("    return GAIN * x\n", "    return 2.4 * GAIN * x\n")
OTHER = "a = 1\nb = 2\n"
OTHER_DONE = "a = 1\nb = 3"  # no final line feed, so that the line with a backslash is fuzzed, too
VICTIM = "a = 'not yours'\n"


def made(root: Path, changes: dict[str, str]) -> bytes:
    """Return the patch that a repair would write for these new texts."""
    originals = {root / name: (root / name).read_bytes() for name in changes}
    header = [f"{TITLE}0.1.0: 5 → 12 at node.py:9", "test: test_it.py::test_it", "drift: mud"]
    header += [f"fixture: {'0' * 64} .tarl/utility/it.npz", "again: pytest test_it.py"]
    diff = unified_diff(originals, {root / name: text for name, text in changes.items()}, root, header)
    return write(diff, root / ".tarl" / "patches", "test_it.py::test_it", "mud").read_bytes()


def sealed(content: bytes) -> bytes:
    """Give a forged patch a valid digest, as an attacker could."""
    line = re.compile(rb"# " + SEAL.encode() + rb": [0-9a-f]{64}\n")
    return line.sub(
        lambda _: (
            b"# %s: %s\n" % (SEAL.encode(), hashlib.sha256(line.sub(b"", content)).hexdigest().encode())
        ),
        content,
    )


@contextmanager
def robot() -> Iterator[tuple[Path, Path]]:
    """Make a project of two files beside an unrelated file; yield the project and the path of the patch."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder).resolve() / "robot"
        (root / ".tarl" / "patches").mkdir(parents=True)
        (root / "node.py").write_text(NODE)
        (root / "other.py").write_text(OTHER)
        (root.parent / "victim.py").write_text(VICTIM)
        (root.parent / "node.py").write_text(NODE)
        (root.parent / "other.py").write_text(OTHER)
        os.chdir(root)
        try:
            yield root, root / ".tarl" / "patches" / "forged.patch"
        finally:
            os.chdir(before)


def texts(folder: Path) -> dict[str, bytes]:
    """Return the content of all files below a folder except patches."""
    found = (path for path in folder.rglob("*") if path.is_file() and path.suffix != ".patch")
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}


AS_IT_WAS = {
    "robot/node.py": NODE.encode(),
    "robot/other.py": OTHER.encode(),
    "victim.py": VICTIM.encode(),
    "node.py": NODE.encode(),
    "other.py": OTHER.encode(),
}
AS_TESTED = {**AS_IT_WAS, "robot/node.py": DONE.encode(), "robot/other.py": OTHER_DONE.encode()}
with robot() as (_root, _):
    PATCH = made(_root, {"node.py": DONE, "other.py": OTHER_DONE})
BODY = PATCH.index(b"diff --git ")


def refused(content: bytes, *flags: str) -> None:
    """Apply a patch and check that it either gives the tested text, or changes nothing and prints one sentence."""
    with robot() as (root, place):
        place.write_bytes(content)
        code = main(["apply", *flags, str(place)])
        assert texts(root.parent) == (AS_TESTED if code == 0 else AS_IT_WAS)
        assert code in (0, 1, 2)


TIMES = 1500 if os.environ.get("TARL_SLOW") else 60
FUZZ = settings(max_examples=TIMES, deadline=None, suppress_health_check=[HealthCheck.too_slow])
PLACES = st.integers(0, len(PATCH) - 1)


@FUZZ
@given(st.lists(st.tuples(PLACES, st.integers(0, 255)), min_size=1, max_size=3), st.booleans(), st.booleans())
@example(
    [(PATCH.index(b"missing") + 3, ord("D"))], True, False
)  # a former error: `misDing = …` was applied with exit code 0
@example([(PATCH.index(b"2.4 * GAIN") + 2, ord("5"))], True, False)  # valid text that was never tested
@example([(PATCH.index(b"2.4 * GAIN") + 2, ord("5"))], True, True)
@example([(BODY, 0)], True, False)  # a former error: the file was taken for a part of the header
@example([(PATCH.index(b"-    return") + 1, ord("\\"))], True, False)
def test_patches_with_changed_bytes_are_refused_or_harmless(
    changes: list[tuple[int, int]], resealed: bool, forced: bool
) -> None:
    content = bytearray(PATCH)
    for at, value in changes:
        content[at] = value
    refused(sealed(bytes(content)) if resealed else bytes(content), *["--force"] * forced)


@FUZZ
@given(PLACES, st.integers(0, 40), st.binary(max_size=20), st.booleans(), st.booleans())
@example(PATCH.rindex(b"\\ No newline"), 0, b"\\\n", True, True)
@example(BODY, len(PATCH), b"", True, True)
@example(PATCH.index(b"@@ "), len(PATCH), b"", True, True)
def test_truncated_and_spliced_patches_are_refused_or_harmless(
    at: int, length: int, put: bytes, resealed: bool, forced: bool
) -> None:
    content = PATCH[:at] + put + PATCH[at + length :]
    refused(sealed(content) if resealed else content, *["--force"] * forced)


LINES = PATCH.splitlines(keepends=True)
WORDS = st.sampled_from(
    [".", "..", "../..", "/", "/etc", "/abs", "-", "a/../..", "\x00", "\x1b[2J", "~", "n" * 300, "node.py"]
)
PATHS = st.lists(WORDS, min_size=1, max_size=3).map("/".join) | st.text(max_size=8)


@FUZZ
@given(st.integers(0, len(LINES) - 1), st.sampled_from(["value", "drop", "double", "swap"]), PATHS)
@example(next(at for at, line in enumerate(LINES) if b"relative to" in line), "value", "..")
@example(next(at for at, line in enumerate(LINES) if b"relative to" in line), "value", "\x00")
@example(next(at for at, line in enumerate(LINES) if b"relative to" in line), "value", "n" * 300)
@example(next(at for at, line in enumerate(LINES) if b"fixture" in line), "value", "0 " + "n" * 300)
@example(next(at for at, line in enumerate(LINES) if b"fixture" in line), "value", f"{'0' * 64} /")
def test_patches_with_rewritten_lines_are_refused_or_harmless(at: int, how: str, text: str) -> None:
    lines = list(LINES)
    key, colon, _ = lines[at].partition(b": ")
    value = text.encode("utf-8", "surrogatepass")
    match how:
        case "value":
            lines[at] = (key + colon if colon else key[:4]) + value + b"\n"
        case "drop":
            del lines[at]
        case "double":
            lines.insert(at, lines[at])
        case _:
            lines[at - 1], lines[at] = lines[at], lines[at - 1]
    refused(sealed(b"".join(lines)))


@FUZZ
@given(PATHS | st.sampled_from(["../victim.py", "../node.py", ".git/hooks/x.py", ".tarl", "robot"]))
@example("../node.py")
@example(".")
def test_file_names_outside_the_project_are_refused(name: str) -> None:
    shown = name.encode("utf-8", "surrogatepass")
    with robot() as (root, place):
        made_for = (root / name).resolve() if "\0" not in name else root
        content = PATCH.replace(b"a/node.py", b"a/" + shown).replace(b"b/node.py", b"b/" + shown)
        place.write_bytes(sealed(content))
        code = main(["apply", "--force", str(place)])
        inside = made_for == root / "node.py"
        assert texts(root.parent) == (AS_TESTED if inside and code == 0 else AS_IT_WAS)
        assert code == 0 if name == "node.py" else code in (1, 2) or inside


CLOSED = [
    ".git/hooks/step.py",
    "lib/.git/step.py",
    ".git/../.git/step.py",
    "lib/.GIT/step.py",
    ".tarl/step.py",
    "lib/.tarl/cache/step.py",
]


@pytest.mark.parametrize("name", CLOSED)
def test_files_inside_git_and_tarl_folders_are_refused(name: str, capsys: Printed) -> None:
    with robot() as (root, place):
        for folder in (".git/hooks", "lib/.git", "lib/.GIT", "lib/.tarl/cache"):
            (root / folder).mkdir(parents=True, exist_ok=True)
        (root / name).write_text(NODE)
        content = made(root, {"node.py": DONE})
        place.write_bytes(sealed(content.replace(b"/node.py", b"/" + name.encode())))
        before = texts(root.parent)
        assert main(["apply", "--force", str(place)]) == 2
        assert f"it changes {name!r}, which no repair does" in capsys.readouterr().err
        assert texts(root.parent) == before


@pytest.mark.parametrize("folder", [".git/hooks", ".tarl/cache"])
def test_links_into_git_and_tarl_folders_are_refused(folder: str, capsys: Printed) -> None:
    with robot() as (root, place):
        (root / folder).mkdir(parents=True)
        (root / "node.py").rename(root / folder / "step.py")
        (root / "node.py").symlink_to(f"{folder}/step.py")
        place.write_bytes(PATCH)
        before = texts(root.parent)
        assert main(["apply", "--force", str(place)]) == 1
        assert f"leads out of {root}: node.py is" in capsys.readouterr().err
        assert texts(root.parent) == before


@pytest.mark.parametrize("base", ["..", "/abs", "../..", "sub/../..", "/"])
def test_the_header_cannot_name_a_file_outside_the_project(base: str, capsys: Printed) -> None:
    with robot() as (root, place):
        stated = str(root.parent) if base == "/abs" else base
        place.write_bytes(sealed(PATCH.replace(b"relative to: .\n", b"relative to: %s\n" % stated.encode())))
        assert main(["apply", str(place)]) == 1
        assert f"forged.patch leads out of {root}" in capsys.readouterr().err
        assert texts(root.parent) == AS_IT_WAS


def test_paths_may_leave_the_folder_but_not_the_repository(capsys: Printed) -> None:
    with robot() as (root, place):
        (root.parent / ".git").mkdir()
        place.write_bytes(made(root, {"../node.py": DONE}))
        assert main(["apply", "--force", str(place)]) == 0
        assert (root.parent / "node.py").read_text() == DONE
    with robot() as (root, place):
        (root / ".git").mkdir()
        place.write_bytes(made(root, {"../node.py": DONE}))
        assert main(["apply", "--force", str(place)]) == 1
        assert f"leads out of {root}" in capsys.readouterr().err
        assert (root.parent / "node.py").read_text() == NODE


def test_the_folder_named_by_the_user_is_the_project() -> None:
    with robot() as (root, place):
        place.write_bytes(PATCH)
        assert main(["apply", str(place), "--directory", ".."]) == 0
        assert (root.parent / "node.py").read_text() == DONE
        assert (root / "node.py").read_text() == NODE


def file_link(root: Path) -> None:
    (root / "node.py").unlink()
    (root / "node.py").symlink_to("../node.py")


def folder_link(root: Path) -> None:
    (root.parent / "lib").mkdir()
    (root.parent / "lib" / "node.py").write_text(NODE)
    (root / "sub").symlink_to("../lib")


def chain_of_links(root: Path) -> None:
    (root / "node.py").unlink()
    (root / "step").symlink_to(root.parent)
    (root / "node.py").symlink_to("step/node.py")


@pytest.mark.parametrize(
    ("link", "name"), [(file_link, "node.py"), (folder_link, "sub/node.py"), (chain_of_links, "node.py")]
)
def test_links_out_of_the_project_are_refused(
    link: Callable[[Path], None], name: str, capsys: Printed
) -> None:
    with robot() as (root, place):
        (root / "sub").mkdir()
        (root / "sub" / "node.py").write_text(NODE)
        content = made(root, {name: DONE})
        (root / "sub" / "node.py").unlink()
        (root / "sub").rmdir()
        link(root)
        place.write_bytes(content)
        before = texts(root.parent)
        assert main(["apply", "--force", str(place)]) == 1
        assert f"leads out of {root}: {name} is" in capsys.readouterr().err
        assert texts(root.parent) == before


def test_links_within_the_project_are_followed() -> None:
    with robot() as (root, place):
        (root / "sub").mkdir()
        (root / "node.py").rename(root / "sub" / "real.py")
        (root / "node.py").symlink_to("sub/real.py")
        place.write_bytes(PATCH)
        assert main(["apply", str(place)]) == 0
        assert (root / "sub" / "real.py").read_text() == DONE
        assert (root / "node.py").is_symlink()


def swapped_file(root: Path) -> None:
    (root / "other.py").unlink()
    (root / "other.py").symlink_to("../other.py")


def swapped_folder(root: Path) -> None:
    (root / "sub").rename(root / "was")
    (root / "sub").symlink_to("..")


def edited(root: Path) -> None:
    (root / "other.py").write_text(OTHER + "c = 4\n")


@pytest.mark.skipif(not replacing.RELATIVE, reason="nothing is opened relative to a folder on this system")
@pytest.mark.parametrize("swap", [swapped_file, swapped_folder, edited])
def test_a_file_changed_between_check_and_write_is_detected(
    swap: Callable[[Path], None], capsys: Printed, monkeypatch: pytest.MonkeyPatch
) -> None:
    with robot() as (root, place):
        (root / "sub").mkdir()
        (root / "sub" / "other.py").write_text(OTHER)
        place.write_bytes(made(root, {"node.py": DONE, "other.py": OTHER_DONE, "sub/other.py": OTHER_DONE}))
        replace = replacing.replace_all

        def late(changes: list[replacing.Change]) -> None:
            swap(root)
            replace(changes)

        monkeypatch.setattr(applying, "replace_all", late)
        assert main(["apply", str(place)]) == 1
        assert "changed during the command" in capsys.readouterr().err
        assert (root / "node.py").read_text() == NODE
        assert (root.parent / "other.py").read_text() == OTHER
        assert not list(root.rglob(".*.new")) + list(root.rglob(".*.old"))


@pytest.mark.parametrize("file", range(3))
def test_all_files_or_none_are_changed_wherever_writing_stops(
    file: int, capsys: Printed, monkeypatch: pytest.MonkeyPatch
) -> None:
    with robot() as (root, place):
        (root / "third.py").write_text(OTHER)
        place.write_bytes(made(root, {"node.py": DONE, "other.py": OTHER_DONE, "third.py": OTHER_DONE}))
        rename, calls = replacing._rename, list[str]()

        def failing(one: replacing._Opened, suffix: str) -> None:
            calls.append(suffix)
            if len(calls) == file + 1:
                raise OSError(5, "Input/output error", str(one.change.path))
            rename(one, suffix)

        monkeypatch.setattr(replacing, "_rename", failing)
        before = texts(root)
        assert main(["apply", str(place)]) == 2
        assert "no file was changed" in capsys.readouterr().err
        assert texts(root) == before


KILLED = """
import os, signal, sys
from pytest_tarl.commands import replacing
from pytest_tarl.commands.cli import main
rename, calls = replacing._rename, []
def kill(one, suffix):
    if calls:
        os.kill(os.getpid(), signal.SIGKILL)
    calls.append(suffix)
    rename(one, suffix)
replacing._rename = kill
main(["apply", sys.argv[1]])
"""


@pytest.mark.parametrize("command", ["apply", "revert"])
def test_repeating_an_interrupted_command_completes_it(command: str, capsys: Printed) -> None:
    with robot() as (root, place):
        place.write_bytes(PATCH)
        subprocess.run([sys.executable, "-c", KILLED, str(place)], check=False, capture_output=True)
        assert ((root / "node.py").read_text(), (root / "other.py").read_text()) == (DONE, OTHER)
        assert main([command, str(place)]) == 0
        told = capsys.readouterr().out
        after = (DONE, OTHER_DONE) if command == "apply" else (NODE, OTHER)
        assert ((root / "node.py").read_text(), (root / "other.py").read_text()) == after
        assert ("node.py was already changed" in told) == (command == "apply")


def test_patch_without_a_digest_needs_the_exact_text(capsys: Printed) -> None:
    with robot() as (root, place):
        place.write_bytes(re.sub(rb"# " + SEAL.encode() + rb".*\n", b"", PATCH))
        assert main(["apply", str(place)]) == 0
        (root / "node.py").write_text("# of a robot\n" + NODE)
        (root / "other.py").write_text(OTHER)
        assert main(["apply", "--force", str(place)]) == 1
        assert "has no digest" in capsys.readouterr().err
        assert (root / "node.py").read_text() == "# of a robot\n" + NODE
