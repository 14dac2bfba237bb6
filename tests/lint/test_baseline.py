import json
from collections import Counter
from dataclasses import replace

import pytest

from tarl_lint.baseline import Accepted, Baseline, dumps, load, merged, missing, save, subtract
from tarl_lint.errors import BaselineError
from tarl_lint.fingerprints import OfHazard
from tarl_lint.fingerprints import of_flow as fingerprint


@pytest.fixture
def entry(example):
    return Accepted(fingerprint(example.flow(), "shuttle"), 1, ("node.py",))


def changed(flow, source=None, sink=None, **parts):
    return replace(
        flow, source=replace(flow.source, **source or {}), sink=replace(flow.sink, **sink or {}), **parts
    )


def test_fingerprints_ignore_lines_steps_and_files(example):
    flow = example.flow()
    span = replace(flow.source.span, line=90, path="moved.py")
    moved = changed(flow, {"span": span, "id": "other"}, {"span": span, "id": "other"}, steps=())
    assert fingerprint(moved, "shuttle") == fingerprint(flow, "shuttle")


@pytest.mark.parametrize(
    ("source", "sink", "parts"),
    [
        ({"topics": ("scan",)}, {}, {}),
        ({"callback": "other"}, {}, {}),
        ({"qualname": "Other.__init__"}, {}, {}),
        ({}, {"topics": ("cmd_vel",)}, {}),
        ({}, {"qualname": "other"}, {}),
        ({}, {}, {"kind": "implicit"}),
    ],
)
def test_fingerprints_depend_on_topic_callback_class_place_and_kind(example, source, sink, parts):
    flow = example.flow()
    assert fingerprint(changed(flow, source, sink, **parts), "p").digest() != fingerprint(flow, "p").digest()


def test_fingerprint_names_the_package_or_the_script(example):
    flow = example.flow()
    assert fingerprint(flow, "shuttle").package == "shuttle"
    assert fingerprint(changed(flow, {"module": "robot.nodes.follow"}), "").package == "robot.nodes"
    assert fingerprint(changed(flow, {"module": "follow"}), "").package == "follow"


def test_fingerprint_of_a_subscribing_method_names_its_class(example):
    assert fingerprint(changed(example.flow(), {"qualname": "Node.__init__"}), "").owner == "Node"
    assert fingerprint(changed(example.flow(), {"qualname": "main"}), "").owner == ""


def test_fingerprint_with_additional_flows_is_new(example):
    finding = replace(example.finding(), fingerprint="a")
    assert [f.status for f in subtract([finding, finding], {"a": 2})] == ["accepted", "accepted"]
    assert [f.status for f in subtract([finding], {"a": 2})] == ["accepted"]
    assert [f.status for f in subtract([finding, finding], {"a": 1})] == ["new", "new"]
    assert [f.status for f in subtract([finding], {})] == ["new"]


def test_an_implicit_flow_that_becomes_explicit_is_new(example):
    implicit, explicit = (replace(example.finding(k), fingerprint=fingerprint(example.flow(k), "p").digest())
                          for k in ("implicit", "explicit"))  # fmt: skip
    accepted = {implicit.fingerprint: 1}
    assert [f.status for f in subtract([implicit, explicit], accepted)] == ["accepted", "new"]


def test_vanished_flows_are_dropped_except_in_unread_files(entry):
    twice = replace(entry, count=2)
    other = replace(entry, fingerprint=replace(entry.fingerprint, source="scan"), files=("unread.py",))
    found = Counter([entry.fingerprint.digest()])
    vanished, kept = missing(Baseline((twice, other)), found, lambda e: e.files == ("node.py",))
    assert vanished == (entry,)
    assert kept == (other,)


def test_baseline_with_any_names_is_read_back(entry, tmp_path):
    odd = replace(
        entry,
        fingerprint=replace(entry.fingerprint, source='größe "x" → y', package=""),
        files=("ä.py", "b.py"),
    )
    baseline = merged([odd, entry, entry], ())
    save(tmp_path / "flows.json", baseline)
    assert load(tmp_path / "flows.json") == baseline
    assert {e.count for e in baseline.entries} == {1, 2}


def test_file_has_one_sorted_flow_per_line(entry):
    other = replace(entry, fingerprint=replace(entry.fingerprint, source="scan"))
    text = dumps(merged([entry, other], ()))
    assert text == dumps(merged([other, entry], ()))
    assert text == (
        '{"format": 1, "tool": "tarl-lint",\n "flows": [\n'
        '  {"kind": "explicit", "source": "odom", "callback": "callback", "sink": "progress", "in": "travel", '
        '"class": "", "package": "shuttle", "count": 1, "files": ["node.py"]},\n'
        '  {"kind": "explicit", "source": "scan", "callback": "callback", "sink": "progress", "in": "travel", '
        '"class": "", "package": "shuttle", "count": 1, "files": ["node.py"]}\n ]}\n'
    )
    assert json.loads(dumps(Baseline())) == {"format": 1, "tool": "tarl-lint", "flows": []}


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("{", "damaged"),
        ("[]", "is not a baseline of tarl-lint"),
        ('{"runs": []}', "is not a baseline of tarl-lint"),
        ('{"format": 9, "tool": "tarl-lint", "flows": []}', "has format 9, this tarl-lint reads 1"),
        ('{"format": 1, "tool": "tarl-lint"}', "damaged .*it lacks 'flows'"),
        ('{"format": 1, "tool": "tarl-lint", "flows": [{}]}', "damaged .*an entry lacks 'kind'"),
        ('{"format": 1, "tool": "tarl-lint", "flows": 3}', "damaged"),
    ],
)
def test_error_names_a_damaged_baseline(tmp_path, text, complaint):
    path = tmp_path / "flows.json"
    path.write_text(text)
    with pytest.raises(BaselineError, match=rf"flows\.json.*{complaint}"):
        load(path)


@pytest.mark.parametrize(
    "part", [{"count": 0}, {"count": "1"}, {"kind": "other"}, {"sink": 3}, {"files": [1]}]
)
def test_an_entry_with_an_invalid_value_is_refused(entry, tmp_path, part):
    document = json.loads(dumps(Baseline((entry,))))
    document["flows"][0] |= part
    path = tmp_path / "flows.json"
    path.write_text(json.dumps(document))
    with pytest.raises(BaselineError, match="damaged"):
        load(path)


def test_failed_write_leaves_nothing_behind(entry, tmp_path):
    (tmp_path / "taken").mkdir()
    with pytest.raises(BaselineError, match="cannot be written"):
        save(tmp_path / "taken", Baseline((entry,)))
    with pytest.raises(BaselineError, match="cannot be written"):
        save(tmp_path / "no/such/flows.json", Baseline((entry,)))
    assert [p.name for p in tmp_path.iterdir()] == ["taken"]


def test_hazards_are_written_after_the_flows_and_read_back(entry, tmp_path):
    hazard = Accepted(OfHazard("shuttle", "TARL202", "odom → cmd", "travel"), 2, ("node.py",))
    save(tmp_path / "flows.json", merged([hazard, entry], ()))
    assert load(tmp_path / "flows.json").entries == (entry, hazard)
    assert (
        ' "hazards": [\n'
        '  {"rule": "TARL202", "about": "odom → cmd", "in": "travel", "package": "shuttle", "count": 2, '
        '"files": ["node.py"]}\n ]}\n'
    ) in (tmp_path / "flows.json").read_text("utf-8")


def test_a_damaged_hazard_is_refused(tmp_path):
    path = tmp_path / "flows.json"
    for hazards in ("3", "[{}]", '[{"rule": "TARL202"}]', "[3]"):
        path.write_text(f'{{"format": 1, "tool": "tarl-lint", "flows": [], "hazards": {hazards}}}')
        with pytest.raises(BaselineError, match="damaged"):
            load(path)
