"""No linted file runs, not even one named like a module that tarl-lint or Python imports."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from tarl_lint import import_path
from tarl_lint.run import workers
from tarl_lint.run.progress import silent
from tests.lint.conftest import NODE

pytestmark = pytest.mark.skipif(
    os.name != "posix", reason="marks are left by way of posix, which is built in"
)
NAMES = sorted(
    {*sys.stdlib_module_names, *packages_distributions(), "sitecustomize", "usercustomize"} - {"tarl_lint"}
)
CONFIGURATION = ("conftest.py", "setup.py", "noxfile.py", "tarl.py", "plugin.py")
SCRIPT = [str(Path(sys.executable).with_name("tarl-lint"))]
MODULE = [sys.executable, "-m", "tarl_lint"]
ARGUMENTS = ["--no-cache", "--format", "json", "--exit-zero"]


def bait(directory: Path) -> None:
    """Write a file for every name; a file that is executed creates a marker file and then fails."""
    marks = directory / "ran"
    marks.mkdir(parents=True)
    for name in (*(f"{name}.py" for name in NAMES if name.isidentifier()), *CONFIGURATION):
        text = f"import posix\nposix.open({str(marks / name)!r}, {os.O_CREAT})\nraise ImportError({name!r})\n"
        (directory / name).write_text(text)


def marked(directory: Path) -> set[str]:
    return {path.name for path in (directory / "ran").iterdir()}


def run(command: list[str], directory: Path, **environment: str) -> subprocess.CompletedProcess[bytes]:
    clean = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PYTHONSAFEPATH")}
    return subprocess.run(
        command, cwd=directory, env={**clean, **environment}, capture_output=True, check=False, timeout=120
    )


@pytest.fixture
def nodes(tmp_path: Path) -> Path:
    """Write two independent nodes, so that two processes are used."""
    directory = tmp_path / "nodes"
    for name in ("a", "b"):
        (directory / name).mkdir(parents=True)
        (directory / name / f"node_{name}.py").write_text(NODE)
    return directory


@pytest.fixture
def place(tmp_path: Path) -> Path:
    directory = tmp_path / "place"
    bait(directory)
    return directory


def take_away_what_python_itself_runs(command: list[str], place: Path, **environment: str) -> None:
    """Remove the files that Python itself runs before the first line of a program without imports."""
    while run(command, place, **environment) and (found := marked(place)):
        for name in found:
            (place / name).unlink()
            (place / "ran" / name).unlink()


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_the_command_runs_no_file_of_the_working_directory(place, nodes, tmp_path, jobs):
    command = [*SCRIPT, *ARGUMENTS, "--jobs", jobs, "../nodes"]
    (tmp_path / "empty").mkdir()
    without = run(command, tmp_path / "empty")
    baited = run(command, place)
    assert marked(place) == set()
    assert (baited.returncode, baited.stdout, baited.stderr) == (0, without.stdout, without.stderr)
    assert b"TARL101" in baited.stdout


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_command_does_not_run_linted_files(place, jobs):
    (place / "node.py").write_text(NODE)
    done = run([*SCRIPT, *ARGUMENTS, "--jobs", jobs, "."], place)
    assert done.returncode == 0, done.stderr
    assert marked(place) == set()
    assert b"TARL101" in done.stdout


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_python_dash_m_runs_no_other_local_file(place, nodes, tmp_path, jobs):
    """`python -m` imports `runpy` or `importlib` from the working directory before any of our code runs."""
    (place / "trivial_program.py").write_text("")
    take_away_what_python_itself_runs([sys.executable, "-m", "trivial_program"], place)
    (place / "trivial_program.py").unlink()
    command = [*MODULE, *ARGUMENTS, "--jobs", jobs, "../nodes"]
    (tmp_path / "empty").mkdir()
    without = run(command, tmp_path / "empty")
    baited = run(command, place)
    assert marked(place) == set()
    assert (baited.returncode, baited.stdout, baited.stderr) == (0, without.stdout, without.stderr)


@pytest.mark.skipif(sys.version_info < (3, 11), reason="the switch came with Python 3.11")
@pytest.mark.parametrize("switch", ["-P", "-I"])
def test_safe_path_option_runs_no_local_file(place, nodes, switch):
    done = run([sys.executable, switch, "-m", "tarl_lint", *ARGUMENTS, "--jobs", "2", "../nodes"], place)
    assert done.returncode == 0, done.stderr
    assert marked(place) == set()


@pytest.mark.parametrize("jobs", ["1", "2"])
@pytest.mark.parametrize("value", ["", os.pathsep, "."])
def test_the_working_directory_on_pythonpath_is_ignored(place, nodes, tmp_path, value, jobs):
    """The empty entry that ROS's `setup.bash` leaves in PYTHONPATH means the working directory."""
    path = f"/nowhere{os.pathsep}{value}"
    program = tmp_path / "program.py"
    program.write_text("")
    take_away_what_python_itself_runs([sys.executable, str(program)], place, PYTHONPATH=path)
    done = run([*SCRIPT, *ARGUMENTS, "--jobs", jobs, "../nodes"], place, PYTHONPATH=path)
    assert done.returncode == 0, done.stderr
    assert marked(place) == set()


def test_editable_source_trees_are_not_imported(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "path", [str(tmp_path), "", *sys.path, str(tmp_path / "src")])
    import_path.restrict()
    assert str(tmp_path) not in sys.path
    assert "" not in sys.path
    assert str(tmp_path / "src") not in sys.path
    assert str(Path(os.__file__).parent) in sys.path


def test_no_worker_is_forked_while_another_thread_runs(monkeypatch):
    monkeypatch.setattr("threading.active_count", lambda: 2)
    if workers._context() is None:
        assert workers.in_processes(abs, [-1, -2], [1, 1], 2, silent) is None


def test_the_results_are_in_the_order_of_the_tasks():
    assert workers.in_processes(abs, [-1, -2, -3], [1, 3, 2], 2, silent) == [1, 2, 3]
