"""Flows from a request to its own response are off by default, and old baselines stay valid."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tarl_lint.cli import main

NODE = """\
import rospy
from std_msgs.msg import Float64
from example_interfaces.srv import AddTwoInts, AddTwoIntsResponse

last = rospy.Publisher("/last", Float64, queue_size=1)


def add(request):
    last.publish(request.a)
    return AddTwoIntsResponse(request.a + request.b)


rospy.Service("add", AddTwoInts, add)
"""
# Written by `tarl-lint --write-baseline` of the last version without this rule
BASELINE = {
    "format": 1,
    "tool": "tarl-lint",
    "flows": [
        {"kind": "explicit", "source": "add", "callback": "add", "sink": sink, "in": "add", "class": "",
         "package": "node", "count": 1, "files": ["node.py"]}
        for sink in ("/last", "add")
    ],
}  # fmt: skip


@pytest.fixture
def codes(tmp_path, monkeypatch, capsys):
    """Return the codes that a run reports."""
    monkeypatch.chdir(tmp_path)
    Path("node.py").write_text(NODE)

    def of(*arguments: str) -> list[str]:
        main(["--format", "json", "--no-cache", *arguments])
        return [d["code"] for d in json.loads(capsys.readouterr().out)["diagnostics"] if d["status"] == "new"]

    return of


def test_flows_to_the_own_response_are_shown_on_request(codes, capsys):
    assert codes() == ["TARL101"]
    assert sorted(codes("--extend-select", "TARL103")) == ["TARL101", "TARL103"]
    assert codes("--select", "TARL103") == ["TARL103"]
    assert codes("--select", "TARL1") == ["TARL101"]
    main(["--no-cache"])
    assert "Not shown: 1 flow from a request to its own response (--extend-select TARL103).\n" in (
        capsys.readouterr().out
    )


def test_a_baseline_of_an_older_version_stays_valid(codes, capsys):
    Path("tarl-flows.json").write_text(json.dumps(BASELINE))
    assert codes() == []
    assert codes("--extend-select", "TARL103") == []
    assert main(["--no-cache"]) == 0
    assert "No longer there" not in capsys.readouterr().out


def test_rewriting_the_baseline_keeps_accepted_findings(codes, capsys):
    Path("tarl-flows.json").write_text(json.dumps(BASELINE))
    assert main(["--no-cache", "--write-baseline"]) == 0
    assert json.loads(Path("tarl-flows.json").read_text())["flows"] == BASELINE["flows"]
    capsys.readouterr()
    assert codes("--extend-select", "TARL103") == []
