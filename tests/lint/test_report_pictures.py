"""Pictures of topics and flows, for Graphviz and Mermaid."""

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from tarl_lint.report.topics import picture, short_names
from tarl_lint.run.runner import Result
from tests.lint.reports import everything, text_of


def into(finding, topic: str, line: int, qualname: str = "travel"):
    """Return the finding with another publish call."""
    sink = finding.flow.sink
    moved = replace(sink.span, line=line, end_line=line)
    sink = replace(
        sink, id=f"{qualname}:{line}", span=moved, topics=(topic,) if topic else (), qualname=qualname
    )
    return replace(finding, span=moved, flow=replace(finding.flow, sink=sink))


def parts(*findings, **more):
    drawn = picture(Result(findings=findings, **more))
    return [
        (p.label, [(t.label, kind) for t, kind in p.inputs], [t.label for t in p.outputs], p.new)
        for _, file in drawn.files
        for p in file
    ]


def test_publish_calls_with_the_same_inputs_share_a_box(example):
    odom = example.finding()
    assert parts(into(odom, "a", 18), into(odom, "b", 19, "stop")) == [
        ("stop\ntravel", [("odom", "explicit")], ["a", "b"], False)
    ]


def test_publish_calls_with_different_inputs_have_separate_boxes(example):
    odom, scan, implicit = example.finding(), example.finding(topic="scan"), example.finding("implicit")
    assert parts(into(odom, "a", 18), into(scan, "b", 19)) == [
        ("travel", [("odom", "explicit")], ["a"], False),
        ("travel", [("scan", "explicit")], ["b"], False),
    ]
    assert len(parts(into(odom, "a", 18), into(implicit, "b", 19))) == 2


def test_paths_through_boxes_correspond_to_flows(example):
    topics = ["odom", "scan", "joy"]
    found = [
        into(example.finding(topic=t), f"out{n}", 30 + n)
        for n in range(6)
        for k, t in enumerate(topics)
        if (n % 3) != k
    ]
    drawn = picture(Result(findings=tuple(found)))
    ways = {
        (i.label, o.label) for _, file in drawn.files for p in file for i, _ in p.inputs for o in p.outputs
    }
    assert ways == {(f.flow.source.topics[0], f.flow.sink.topics[0]) for f in found}
    assert sum(len(file) for _, file in drawn.files) == 3


def test_leading_slash_does_not_distinguish_topics(example):
    odom = example.finding()
    drawn = picture(
        Result(findings=(into(odom, "cmd", 1), into(odom, "/cmd", 2), into(odom, "", 3), into(odom, "", 4)))
    )
    assert "/cmd" in [t.label for t in drawn.topics]
    assert sorted(t.key.split(" ")[0] for t in drawn.topics) == ["?", "?", "cmd", "odom"]


def test_new_flows_are_marked_only_with_a_baseline(example):
    old = into(replace(example.finding(), status="accepted"), "a", 18)
    new = into(example.finding(), "b", 19)
    assert [p[3] for p in parts(old, new, baseline=Path("tarl-flows.json"))] == [False, True]
    assert [p[3] for p in parts(new)] == [False]


@pytest.mark.parametrize(
    ("paths", "names"),
    [
        (["src/a.py", "b.py"], ["a.py", "b.py"]),
        (["x/n/a.py", "y/n/a.py", "b.py"], ["x/n/a.py", "y/n/a.py", "b.py"]),
        (["p/x/a.py", "p/y/a.py"], ["x/a.py", "y/a.py"]),
        (["a.py", "x/a.py"], ["a.py", "x/a.py"]),
    ],
)
def test_files_have_their_shortest_unique_name(paths, names):
    assert list(short_names(paths).values()) == names


def test_the_format_dot_draws_topics_parts_and_edges(example):
    text = text_of("dot", everything(example))
    assert text.startswith("digraph flows {\n")
    assert re.findall(r't\d \[label="(\w+)"', text) == ["joy", "odom", "progress", "scan"]
    assert text.count("style=dashed") == 2
    assert text.count("penwidth=2") == 1
    assert 'label="node.py"' in text


@pytest.mark.skipif(shutil.which("dot") is None, reason="Graphviz is not installed")
def test_graphviz_accepts_any_names(example):
    odd = into(example.finding(topic='say "hi" \\'), "a\nb", 18, 'f"<b>"')
    done = subprocess.run(
        ["dot", "-Tsvg"],
        input=text_of("dot", Result(findings=(odd,))),
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "say &quot;hi&quot; \\" in done.stdout


def test_mermaid_draws_the_same_graph(example):
    lines = text_of("mermaid", everything(example)).splitlines()
    assert lines[0] == "flowchart LR"
    assert '  t1(["odom"]):::topic' in lines
    assert '  subgraph s0 ["node.py"]' in lines
    assert '    p0["travel"]:::new' in lines
    assert sorted(line.strip() for line in lines if "-->" in line or "-.->" in line) == [
        "p0 --> t2", "t0 -.-> p0", "t1 --> p0", "t3 -.-> p0",
    ]  # fmt: skip


def test_mermaid_does_not_interpret_names_as_syntax(example):
    odd = into(example.finding(topic='say "hi" #1'), "a<b>`", 18)
    text = text_of("mermaid", Result(findings=(odd,)))
    assert '(["say #quot;hi#quot; #35;1"])' in text
    assert '(["a#lt;b#gt;#96;"])' in text


def test_the_picture_without_flows_is_a_valid_graph():
    assert text_of("dot", Result()).endswith("}\n")
    assert text_of("mermaid", Result()).startswith("flowchart LR\n")
