"""On a full disk or a read-only tree, the verdict still appears on the terminal and in JUnit, with advice."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from pytest_tarl import files
from tarl_lint.files import open_beside
from tests.plugin.tank import ONLINE, RECORD, changed, fixture_file

ADVICE = {
    errno.ENOSPC: "the disk or your quota is full: free some space and run the command again.",
    errno.EDQUOT: "the disk or your quota is full: free some space and run the command again.",
    errno.EFBIG: "the file is larger than its limit: raise the limit, for example with `ulimit -f unlimited`, and run "
    "the command again.",
    errno.EROFS: "make the folder writable, or work in a copy.",
    errno.EIO: (
        "something other than a regular file is at this path, or the disk fails: check the path and run the command "
        "again."
    ),
}


@pytest.fixture
def recorded(tank: pytest.Pytester) -> pytest.Pytester:
    """The tank with a recorded utility, a drift that breaks it and one that does nothing."""
    changed(tank, "test_tank", '{"clogged": 0.25}', '{"clogged": 0.25, "same": 1.0}')
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    return tank


def deny(monkeypatch: pytest.MonkeyPatch, number: int, *kept: str) -> None:
    """Make everything below `.tarl` read-only, except the kept folders."""

    def full(path: Path) -> tuple[int, Path]:
        if ".tarl" in path.parent.parts and path.parent.name not in kept:
            raise OSError(number, os.strerror(number), str(path.parent))
        return open_beside(path)

    monkeypatch.setattr("pytest_tarl.files.open_beside", full)
    monkeypatch.setattr("tarl_lint.files.open_beside", full)


def cases(path: Path) -> dict[str, ElementTree.Element]:
    return {one.attrib["name"]: one for one in ElementTree.parse(path).iter("testcase")}


def properties(case: ElementTree.Element) -> dict[str, str]:
    return {one.attrib["name"]: one.attrib["value"] for one in case.iter("property")}


@pytest.mark.parametrize("number", ADVICE)
def test_verdict_is_printed_without_files(
    recorded: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    deny(monkeypatch, number)
    told = recorded.runpytest(*ONLINE, "--junitxml=junit.xml")
    told.assert_outcomes(passed=1, failed=1, deselected=1)
    text = told.stdout.str()
    assert "test_fills[clogged]: degraded" in text
    assert "test_fills[same]: no difference" in text
    assert text.count(ADVICE[number]) == 2  # one sentence per test, not one per file
    assert "not written: .tarl/results/" in text
    assert ".tarl/online/" in text
    assert ".tarl/report/" in text
    assert "Traceback" not in text
    junit = cases(recorded.path / "junit.xml")
    worse, same = junit["test_fills[clogged]"], junit["test_fills[same]"]
    assert worse.find("failure") is not None
    assert same.find("failure") is None
    assert properties(worse)["tarl_verdict"] == "degraded"
    assert properties(same)["tarl_verdict"] == "no difference"
    assert ADVICE[number] in properties(same)["tarl_unwritten"]


def test_unwritable_patch_is_printed(recorded: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as limits:
        deny(limits, errno.ENOSPC)
        text = recorded.runpytest(*ONLINE, "--tarl-repair", "--tarl-drift=clogged").stdout.str()
    assert "repair   accepted" in text
    head, _, rest = text.partition("The patch could not be written below .tarl/patches.")
    assert head
    lines = rest.splitlines()[1:]
    last = next(at for at, line in enumerate(lines) if at and line and line[0] not in "# +-@di\\")
    by_hand = recorded.path / ".tarl" / "patches" / "by-hand.patch"
    by_hand.parent.mkdir(exist_ok=True)
    by_hand.write_text("\n".join(lines[:last]).rstrip("\n") + "\n")
    applied = recorded.run(sys.executable, "-m", "pytest_tarl", "apply", by_hand)
    assert applied.ret == 0, applied.stderr.str()
    assert "applied to keeper.py" in applied.stdout.str()


FIRST = "def test_fills(tarl, tarl_drift):"


def test_recording_reports_an_unwritable_path_before_the_first_episode(
    recorded: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    deny(monkeypatch, errno.ENOSPC)
    changed(recorded, "test_tank", FIRST, f"{FIRST}\n    1 / 0")
    told = recorded.runpytest(*RECORD)
    told.stdout.fnmatch_lines([f"*cannot be written*: {ADVICE[errno.ENOSPC]}"])
    assert "ZeroDivisionError" not in told.stdout.str()


def test_full_disk_keeps_the_old_recording(
    recorded: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = fixture_file(recorded).read_bytes()

    class Full:
        def __init__(self, handle: int, mode: str) -> None:
            self.handle = handle

        def __enter__(self) -> Full:
            return self

        def __exit__(self, *_: object) -> None:
            os.close(self.handle)

        def write(self, content: bytes) -> None:
            if content.strip(b"\0"):  # the check before the first episode writes zeros
                os.write(self.handle, content[: len(content) // 2])
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(files.os, "fdopen", Full)
    told = recorded.runpytest(*RECORD)
    monkeypatch.undo()
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines([f"*cannot be written*: {ADVICE[errno.ENOSPC]}"])
    assert fixture_file(recorded).read_bytes() == before
    assert [path.name for path in fixture_file(recorded).parent.iterdir()] == [fixture_file(recorded).name]


def test_a_limit_on_file_size_is_reported(
    recorded: pytest.Pytester, tmp_path_factory: pytest.TempPathFactory
) -> None:
    resource = pytest.importorskip("resource")  # not on Windows
    before = fixture_file(recorded).read_bytes()
    junit = tmp_path_factory.mktemp("outside") / "junit.xml"

    def run(*options: str) -> subprocess.CompletedProcess[str]:
        """Run pytest with a limit on file size of half a recording."""
        return subprocess.run(
            [sys.executable, "-B", "-m", "pytest", "-p", "no:cacheprovider", *options],
            cwd=recorded.path,
            capture_output=True,
            text=True,
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, [len(before) // 2] * 2),
        )

    told = run(*RECORD)
    assert told.returncode == 1, told.stdout + told.stderr
    assert f"cannot be written (File too large): {ADVICE[errno.EFBIG]}" in " ".join(told.stdout.split())
    assert fixture_file(recorded).read_bytes() == before
    told = run(*ONLINE, "--tarl-drift=clogged", f"--junitxml={junit}")
    assert told.returncode == 1, told.stdout + told.stderr
    assert "test_fills[clogged]: degraded" in told.stdout
    assert told.stdout.count(ADVICE[errno.EFBIG]) == 1
    assert [path.name for path in fixture_file(recorded).parent.iterdir()] == [fixture_file(recorded).name]


def mounting() -> bool:
    """Return whether this user may mount file systems."""
    tool = shutil.which("unshare")
    if tool is None:
        return False
    asked = subprocess.run(
        [tool, "-rm", "mount", "-t", "tmpfs", "none", "/mnt"], capture_output=True, check=False
    )
    return asked.returncode == 0


FULL = """
cp -a .tarl saved && mount -t tmpfs -o size=128k none .tarl && cp -a saved/utility .tarl/ || exit 99
cat /dev/zero > .tarl/ballast 2>/dev/null
"""
READ_ONLY = "mount --bind . . && mount -o remount,bind,ro . && cd . || exit 99\n"


@pytest.mark.skipif(not mounting(), reason="this user cannot mount a file system: unshare -rm is not allowed")
@pytest.mark.parametrize(("script", "number"), [(FULL, errno.ENOSPC), (READ_ONLY, errno.EROFS)])
def test_read_only_tree_is_reported(
    recorded: pytest.Pytester, tmp_path_factory: pytest.TempPathFactory, script: str, number: int
) -> None:
    junit = tmp_path_factory.mktemp("outside") / "junit.xml"
    command = (
        f"cd {recorded.path}\n{script}cd {recorded.path}\nexec {sys.executable} -m pytest -p no:cacheprovider"
    )
    command = f"{command} {' '.join(ONLINE)} --junitxml={junit}"
    told = subprocess.run(
        ["unshare", "-rm", "sh", "-c", command], capture_output=True, text=True, check=False
    )
    assert told.returncode == 1, told.stdout + told.stderr
    assert "test_fills[clogged]: degraded" in told.stdout
    assert "test_fills[same]: no difference" in told.stdout
    assert told.stdout.count(ADVICE[number]) == 2
    assert properties(cases(junit)["test_fills[clogged]"])["tarl_verdict"] == "degraded"
    assert properties(cases(junit)["test_fills[same]"])["tarl_verdict"] == "no difference"


@pytest.mark.skipif(not mounting(), reason="this user cannot mount a file system: unshare -rm is not allowed")
def test_recording_on_a_full_disk_is_refused_early(
    recorded: pytest.Pytester,
) -> None:
    changed(recorded, "test_tank", FIRST, f"{FIRST}\n    1 / 0")
    command = f"cd {recorded.path}\n{FULL}touch .tarl/empty || exit 99\n"
    command += f"exec {sys.executable} -m pytest -p no:cacheprovider {' '.join(RECORD)}"
    told = subprocess.run(
        ["unshare", "-rm", "sh", "-c", command], capture_output=True, text=True, check=False
    )
    assert told.returncode == 1, told.stdout + told.stderr
    assert ADVICE[errno.ENOSPC] in told.stdout
    assert "ZeroDivisionError" not in told.stdout
