"""Run the steps of the GitHub action and the GitLab template, with stubs for parts that only these services have."""

from __future__ import annotations

import json
import os
import re
import runpy
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
import yaml

ROOT = Path(__file__).parent.parent
ACTION: dict[str, Any] = yaml.safe_load((ROOT / "action.yml").read_text("utf-8"))
GITLAB: dict[str, Any] = yaml.safe_load((ROOT / "editors/gitlab/tarl.gitlab-ci.yml").read_text("utf-8"))
NODE = """
import rospy
from std_msgs.msg import Float64

out = rospy.Publisher("/out", Float64, queue_size=1)
rospy.Subscriber("/in", Float64, lambda message: out.publish(2 * message.data))
"""
RESULT = {
    "test": "t.py::test",
    "drift": "mud",
    "verdict": {"result": "degraded", "p_drift": 0.001, "p_loss": 0.001, "loss": 8.8},
    "region": [],
    "sites": [],
    "culprits": [],
    "repair": None,
}

pytestmark = pytest.mark.skipif(shutil.which("bash") is None, reason="the steps are written for bash")


def step(name: str) -> dict[str, Any]:
    (found,) = (one for one in ACTION["runs"]["steps"] if one["name"] == name)
    return dict(found)


def inputs(**given: str) -> dict[str, str]:
    return {name: str(one.get("default", "")) for name, one in ACTION["inputs"].items()} | given


def run(name: str, folder: Path, **given: str) -> subprocess.CompletedProcess[str]:
    """Run a step of the action as a runner does, with a stub of pytest and gh first on the PATH."""
    chosen = inputs(**given)
    values = {"github.event.number": "7", "github.action_path": str(ROOT), "github.token": "secret"}
    values |= {f"inputs.{key}": value for key, value in chosen.items()}
    env = {
        key: re.sub(r"\$\{\{ (.*?) \}\}", lambda found: values[found[1]], str(text))
        for key, text in step(name).get("env", {}).items()
    }
    stubs = folder / "stubs"
    stubs.mkdir(exist_ok=True)
    tools = {
        "tarl": f'exec "{sys.executable}" -m pytest_tarl "$@"',
        "tarl-lint": f'exec "{sys.executable}" -m tarl_lint "$@"',
    }
    tools["gh"] = 'echo "$@" >gh.txt; cat >body.txt'
    tools["python"] = 'echo "$@" >python.txt; exit ${PYTHON_EXIT:-0}'
    for tool, text in tools.items():
        (stubs / tool).write_text(f"#!/bin/bash\n{text}\n")
        (stubs / tool).chmod(0o755)
    clean = {key: text for key, text in os.environ.items() if not key.startswith("GITHUB")}
    path = f"{stubs}{os.pathsep}{os.environ['PATH']}"
    summary = {"GITHUB_STEP_SUMMARY": str(folder / "summary.md"), "PYTHONPATH": str(ROOT)}
    return subprocess.run(
        ["bash", "-eo", "pipefail", "-c", step(name)["run"]],
        cwd=folder,
        env={
            **clean,
            **summary,
            **env,
            "PATH": path,
            **({"PYTHON_EXIT": given["status"]} if "status" in given else {}),
        },
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / "node.py").write_text(NODE)
    return tmp_path


def results(project: Path) -> None:
    folder = project / ".tarl" / "results"
    folder.mkdir(parents=True)
    (folder / "t.json").write_text(json.dumps(RESULT))


@pytest.mark.parametrize(
    ("tests", "extras"), [("", "tarl @ file"), ("tests/sim", "tarl[pytest,ros,report] @ file")]
)
def test_the_github_action_installs_the_required_extras(project: Path, tests: str, extras: str) -> None:
    assert run("Install TARL", project, tests=tests).returncode == 0
    assert extras in (project / "python.txt").read_text()


def test_the_github_action_annotates_and_writes_sarif(project: Path) -> None:
    ended = run("Lint", project, paths="node.py", sarif="flows.sarif", arguments="--no-cache")
    assert ended.returncode == 1
    assert "file=node.py" in ended.stdout
    assert json.loads((project / "flows.sarif").read_text())["version"] == "2.1.0"
    assert run("Lint", project, paths="node.py", arguments="--fail-on never").returncode == 0


def launch_file(project: Path) -> None:
    """Make the project a package whose launch file has a remapping that matches nothing (TARL308)."""
    (project / ".git").mkdir()  # without it, packages in the folders of other tests belong to the workspace
    (project / "package.xml").write_text(
        "<package><name>arm</name><export><build_type>catkin</build_type></export></package>"
    )
    (project / "launch").mkdir()
    (project / "launch/arm.launch").write_text(
        '<launch><arg name="to" default="/a"/><node pkg="arm" type="node.py" name="n">'
        '<remap from="ouut" to="$(arg to)"/></node></launch>'
    )


@pytest.mark.parametrize("launch", ["all", "arm.launch to:=/b"])
def test_the_github_action_lints_launch_files(project: Path, launch: str) -> None:
    launch_file(project)
    ended = run("Lint launch files", project, launch=launch, sarif="flows.sarif", arguments="--no-cache")
    assert ended.returncode == 1, ended.stderr
    assert "::error file=launch/arm.launch,line=1," in ended.stdout
    assert f"to {launch.partition('=')[2] or '/a'} has no effect" in ended.stdout
    (log,) = json.loads((project / "flows.launch.sarif").read_text())["runs"]
    assert [one["ruleId"] for one in log["results"]] == ["TARL308"]


def test_the_ament_command_lints_launch_files(
    project: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    launch_file(project)
    monkeypatch.chdir(project)
    path = ROOT / "editors/ros/ament_tarl_lint/ament_tarl_lint/main.py"
    command = runpy.run_path(str(path))["main"]
    assert command(["--launch", "launch/arm.launch", "to:=/b", "--xunit-file", "results/a.xml"]) == 1
    assert "to /b has no effect" in capsys.readouterr().out
    cases = ElementTree.parse(project / "results/a.xml").getroot().iter("testcase")
    assert [one.find("failure") is not None for one in cases] == [True, False]  # the hazard and a flow


@pytest.mark.parametrize(
    ("repair", "flags"), [("false", "--tarl-online"), ("true", "--tarl-online --tarl-repair")]
)
def test_the_github_action_compares_and_keeps_the_exit_status(project: Path, repair: str, flags: str) -> None:
    results(project)
    ended = run("Compare", project, tests="tests/sim -k delivers", repair=repair, status="1")
    assert ended.returncode == 1
    assert (project / "python.txt").read_text() == f"-m pytest tests/sim -k delivers {flags}\n"
    assert "❌ degraded" in (project / "summary.md").read_text()


def test_github_action_edits_its_comment(project: Path) -> None:
    assert run("Comment", project, tests="t").returncode == 0
    assert not (project / "gh.txt").exists()
    results(project)
    assert run("Comment", project, tests="t").returncode == 0
    assert (project / "gh.txt").read_text() == "pr comment 7 --body-file - --edit-last --create-if-none\n"
    assert "❌ degraded" in (project / "body.txt").read_text()


def test_scripts_of_the_action_contain_no_inputs() -> None:
    for one in ACTION["runs"]["steps"]:
        assert "${{" not in one["run"], one["name"]


def test_every_input_is_used_and_described() -> None:
    text = (ROOT / "action.yml").read_text("utf-8")
    for name, one in ACTION["inputs"].items():
        assert one["description"]
        assert f"inputs.{name}" in text


@pytest.mark.parametrize("job", [".tarl-lint", ".tarl-lint-launch", ".tarl-compare"])
def test_the_gitlab_jobs_run(project: Path, job: str) -> None:
    results(project)
    launch_file(project)
    (project / "test_plain.py").write_text("def test_plain():\n    pass\n")
    commands = [*GITLAB[job]["script"], *GITLAB[job].get("after_script", [])]
    here = str(Path(sys.executable).parent)
    text = (
        "\n".join(commands)
        .replace("tarl-lint ", "python -m tarl_lint ")
        .replace("tarl summary", "python -m pytest_tarl summary")
    )
    env = {**os.environ, "PATH": f"{here}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}
    chosen = {key: str(text) for key, text in GITLAB[job]["variables"].items()}
    chosen |= {
        "TARL_FLAGS": "-q",
        "TARL_TESTS": "-p no:asyncio test_plain.py",
        "TARL_ARGUMENTS": "--no-cache --exit-zero",
    }
    ended = subprocess.run(
        ["bash", "-eo", "pipefail", "-c", text],
        cwd=project,
        env={**env, **chosen},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
    for kind, name in GITLAB[job]["artifacts"]["reports"].items():
        assert (project / name).stat().st_size, kind
