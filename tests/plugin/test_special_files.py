"""A named pipe or a device in place of a recording, a patch or a result is refused and never read."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from pytest_tarl.files import check_writable, read_regular
from tests.plugin.tank import NODE, TEST

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
RECORDED = ".tarl/utility/test-tank-test-fills-824c4a72.npz"


@pytest.fixture(params=["pipe", "link to a pipe", "link to a device"])
def special(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """Return a path that blocks its reader, or never ends."""
    path = tmp_path / "special"
    if request.param == "pipe":
        os.mkfifo(path)
    elif request.param == "link to a pipe":
        os.mkfifo(tmp_path / "pipe")
        path.symlink_to("pipe")
    else:
        path.symlink_to("/dev/zero")
    return path


def test_only_regular_files_are_read(special: Path, tmp_path: Path) -> None:
    with pytest.raises(OSError, match="not a regular file"):
        read_regular(special)
    with pytest.raises(OSError, match="not a regular file"):
        check_writable(special)
    with pytest.raises(IsADirectoryError):
        read_regular(tmp_path)
    (tmp_path / "file").write_bytes(b"a\r\n\0")
    (tmp_path / "link").symlink_to("file")
    assert read_regular(tmp_path / "link") == b"a\r\n\0"


def tarl(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a command that would block without end if it read the special file."""
    return subprocess.run(
        [sys.executable, "-m", *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


@pytest.mark.parametrize("command", ["show", "apply", "revert", "diff"])
def test_commands_name_irregular_files(command: str, special: Path, tmp_path: Path) -> None:
    words = ["diff", "special", "special"] if command == "diff" else [command, "special"]
    done = tarl(tmp_path, "pytest_tarl", *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert re.search("special:? cannot be read", done.stderr)
    assert "not a regular file" in done.stderr
    assert "Traceback" not in done.stderr


def test_recording_into_a_pipe_is_refused(tmp_path: Path) -> None:
    (tmp_path / "keeper.py").write_text(NODE)
    (tmp_path / "test_tank.py").write_text(TEST.replace("    draws =", "    open('begun', 'w')\n    draws ="))
    (tmp_path / RECORDED).parent.mkdir(parents=True)
    os.mkfifo(tmp_path / RECORDED)
    done = tarl(tmp_path, "pytest", "--tarl-record", "--tarl-episodes=2", "-p", "no:cacheprovider")
    assert done.returncode == 1, done.stdout + done.stderr
    assert f"{RECORDED} cannot be written (it is not a regular file)" in done.stdout
    assert not (tmp_path / "begun").exists()
