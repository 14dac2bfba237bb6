"""Standard streams that are closed, full, or not a terminal."""

import os
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.fixture
def node(example, in_directory) -> Path:
    return in_directory({"node.py": example.text}) / "node.py"


def run(directory: Path, redirections: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = " ".join([sys.executable, "-m", "tarl_lint", "--no-cache", *arguments, redirections])
    return subprocess.run(
        ["bash", "-c", command], cwd=directory, capture_output=True, check=False, text=True, timeout=60,
        env={**os.environ, "FORCE_COLOR": "", "NO_COLOR": ""},
    )  # fmt: skip


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full here")
@pytest.mark.parametrize(
    "arguments", [[], ["--format", "json"], ["--explain", "TARL101"], ["--show-settings"]]
)
def test_a_full_disk_is_reported_in_one_sentence(node, arguments):
    done = run(node.parent, "> /dev/full", *arguments)
    assert done.returncode == 2
    said = "tarl-lint: Cannot write the report to standard output: No space left on device.\n"
    assert done.stderr == said


@pytest.mark.parametrize("redirections", [">&-", ">&- 2>&-", "2>&-", "<&-"])
def test_closed_streams_affect_only_the_output(node, redirections):
    done = run(node.parent, redirections)
    assert (done.returncode, done.stderr) == (1, "")


def test_a_closed_standard_input_is_reported_in_one_sentence(node):
    done = run(node.parent, "<&-", "-")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == ("tarl-lint: Standard input is closed: omit -, or pipe the text of a file to it.\n")
