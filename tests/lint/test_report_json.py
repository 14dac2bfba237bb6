import json
from dataclasses import replace
from importlib import resources

import jsonschema
import pytest

from tarl_lint import __version__
from tarl_lint.model import Finding
from tarl_lint.read.source import SourceError
from tarl_lint.report import render
from tarl_lint.report.json import document
from tarl_lint.report.line import View, plain
from tarl_lint.run.runner import Result, Statistics

SCHEMA = json.loads(resources.files("tarl_lint.report").joinpath("findings.schema.json").read_text("utf-8"))


@pytest.fixture
def result(example):
    accepted = replace(example.finding("implicit", "scan"), status="accepted")
    hazard = Finding("TARL203", example.span("pos = data.pose"), "Reaches nothing.")
    errors = (SourceError("old.py", 3, "This is Python 2."),)
    return Result(
        findings=(example.finding(), accepted, hazard), errors=errors, statistics=Statistics(files=2)
    )


def test_the_document_matches_the_frozen_example(example, result):
    diagnostic = document(result)["diagnostics"][0]
    assert document(result) | {"diagnostics": []} == {
        "format": 1,
        "tool": {"name": "tarl-lint", "version": __version__},
        "files": 2,
        "errors": [{"path": "old.py", "line": 3, "message": "This is Python 2."}],
        "diagnostics": [],
    }
    place = {"path": "node.py", "line": 22, "column": 5}
    assert diagnostic["flow"]["source"] == {
        "id": "node:odom:callback",
        **place,
        "topics": ["odom"],
        "type": "Odometry",
        "callback": "callback",
        "api": "rospy.Subscriber",
        "registered": [place],
        "via": [],
    }
    assert diagnostic["flow"]["steps"][2] == {
        "path": "node.py",
        "line": 11,
        "column": 5,
        "end_line": 11,
        "end_column": 36,
        "qualname": "callback",
        "site": "node:callback:pos = data.pose.pose.position.x",
        "code": "pos = data.pose.pose.position.x",
        "role": "assign",
        "dependence": "data",
    }


def test_keys_come_in_the_documented_order(result):
    made = document(result)
    first = made["diagnostics"][0]
    assert list(made) == ["format", "tool", "files", "errors", "diagnostics"]
    assert " ".join(first) == "code path line column end_line end_column message fingerprint status flow"
    assert list(first["flow"]) == ["kind", "source", "sink", "steps"]
    assert " ".join(first["flow"]["source"]) == "id path line column topics type callback api registered via"
    assert " ".join(first["flow"]["sink"]) == "id path line column topics type api"
    assert " ".join(first["flow"]["steps"][0]) == (
        "path line column end_line end_column qualname site code role dependence"
    )


def test_accepted_flows_and_hazards_are_included(result):
    assert [(d["code"], d["status"], "flow" in d) for d in document(result)["diagnostics"]] == [
        ("TARL101", "new", True),
        ("TARL102", "accepted", True),
        ("TARL203", "new", False),
    ]


def test_the_document_and_the_schema_are_valid(result):
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    jsonschema.validate(document(result), SCHEMA)
    jsonschema.validate(document(Result()), SCHEMA)


@pytest.mark.parametrize(
    "change", [{"status": "old"}, {"code": "TARL102"}, {"line": 0}, {"extra": 1}, {"flow": None}]
)
def test_the_schema_refuses_invalid_documents(result, change):
    made = document(result)
    made["diagnostics"][0] |= change
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(made, SCHEMA)


def test_the_text_is_ascii_and_parses_to_the_document(example, result):
    step = replace(example.flow().steps[0], code="größe = '漢字'")
    odd = replace(result.findings[0], flow=replace(example.flow(), steps=(step,)))
    changed = replace(result, findings=(odd,))
    text = "\n".join(map(plain, render("json", changed, View())))
    assert text.isascii()
    assert json.loads(text) == document(changed)


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_text_is_the_document_indented_by_the_library(result, count):
    """The text is written finding by finding; the bytes are those of the whole document."""
    changed = replace(result, findings=result.findings[:count])
    lines = [*map(plain, render("json", changed, View()))]
    assert "\n".join(lines) == json.dumps(document(changed), indent=1)
    assert all(line.count('"fingerprint"') <= 1 for line in lines)
