from dataclasses import replace
from pathlib import Path

import pytest

from tarl_lint.baseline import Accepted
from tarl_lint.fingerprints import of_flow as fingerprint
from tarl_lint.model import Finding, Span
from tarl_lint.read.discover import Notes
from tarl_lint.read.source import SourceError
from tarl_lint.report import render
from tarl_lint.report.line import ASCII, View, plain
from tarl_lint.run.runner import Result, Statistics
from tarl_lint.suppress import Suppression

ONE_FLOW = """\
node.py:18:9 publishes progress (Float64) in travel
   16 │         delta = goal - pos
   17 │         vel = 5 * delta
   18 │         pub.publish(vel)
      │         ^^^^^^^^^^^^^^^^

    TARL101 explicit from odom (Odometry)  line 22, callback
      22  register   · rospy.Subscriber("odom", Odometry, callback)
       9  receive    ● def callback(data):
      11  assign     ● pos = data.pose.pose.position.x
      15  condition  ◆ while not rospy.is_shutdown():
      16  assign     ● delta = goal - pos
      17  assign     ● vel = 5 * delta
      18  publish    ● pub.publish(vel)

      ● passes on the value   ◆ condition   · context

1 flow in 1 file: 1 explicit.
--write-baseline accepts these findings: later runs report only new ones.
"""


def shown(result: Result, view: View = View(), name: str = "text") -> str:  # noqa: B008 - frozen
    return "".join(plain(line) + "\n" for line in render(name, result, view))


@pytest.fixture
def result_of(example):
    def build(*findings: Finding, **parts) -> Result:
        statistics = parts.pop("statistics", Statistics(files=1, lines=24))
        return Result(findings=findings, texts={"node.py": example.text}, statistics=statistics, **parts)

    return build


def test_a_single_flow_is_shown_in_full(example, result_of):
    assert shown(result_of(example.finding())) == ONE_FLOW


def test_flows_into_one_call_share_a_code_frame(example, result_of):
    text = shown(result_of(example.finding(), example.finding("implicit", "a_longer_topic")))
    assert text.count("pub.publish(vel)") == 1
    assert "    TARL101 explicit from odom (Odometry)            line 22, callback\n" in text
    assert "    TARL102 implicit from a_longer_topic (Odometry)  line 22, callback\n" in text
    assert "●" not in text
    assert "2 flows in 1 file: 1 explicit, 1 implicit.\n--show-paths shows" in text


def test_show_paths_lists_the_steps_of_every_flow(example, result_of):
    text = shown(result_of(example.finding(), example.finding("implicit", "scan")), View(show_paths=True))
    assert text.count("16  assign     ● delta = goal - pos") == 2
    assert text.count("passes on the value") == 1


def test_accepted_flows_are_counted_but_not_shown(example, result_of):
    old = replace(example.finding(), status="accepted")
    text = shown(result_of(old, example.finding("implicit", "scan"), baseline=Path("tarl-flows.json")))
    assert "odom (" not in text
    assert "1 new flow in 1 file: 1 implicit (1 accepted in tarl-flows.json).\n" in text
    assert "--write-baseline" not in text
    assert shown(result_of(old, baseline=Path("tarl-flows.json"))) == (
        "No new flow in 1 file (1 accepted in tarl-flows.json).\n"
    )


def test_a_run_without_findings_is_described_in_words(result_of):
    assert shown(result_of(statistics=Statistics(files=3))) == (
        "No flow from a subscription to a publish call in 3 files.\n"
    )


def test_vanished_flows_are_named(example, result_of):
    gone = Accepted(fingerprint(example.flow(), "shuttle"), 2, ("node.py",))
    text = shown(result_of(vanished=(gone,), baseline=Path("tarl-flows.json")))
    assert (
        "  odom → progress, explicit, received by callback, published in travel (shuttle), 2 times\n" in text
    )
    many = tuple(replace(gone, fingerprint=replace(gone.fingerprint, source=f"topic{i}")) for i in range(25))
    assert "  and 5 more\n" in shown(result_of(vanished=many, baseline=Path("tarl-flows.json")))


def test_unreadable_and_unanalysed_files_are_listed(example, result_of):
    unknown = replace(
        example.finding(), flow=replace(example.flow(), source=replace(example.source(), topics=()))
    )
    statistics = Statistics(
        files=12, notes=Notes(cpp_nodes=3, remapping_launch_files=1, unreadable=("secret",))
    )
    errors = (SourceError("old.py", 3, "This is Python 2."),)
    text = shown(result_of(unknown, errors=errors, statistics=statistics))
    assert text.startswith("old.py:3:1 TARL001 This is Python 2.\n\nnode.py:18:9 ")
    assert "from unknown topic (Odometry)" in text
    assert "1 flow in 1 of 12 files: 1 explicit.\n" in text
    assert (
        "Not analysed: 1 file that is not readable as Python 3 (TARL001), 1 unreadable place (secret), 3 C++ nodes, "
        "remaps in 1 launch file, the names of 1 topic computed at run time.\n"
    ) in text


def test_unreadable_files_are_counted_if_their_rule_is_disabled(result_of):
    result = result_of(errors=(SourceError("old.py", 3, "This is Python 2."),), names_errors=False)
    for name in ("text", "concise"):
        assert "old.py" not in shown(result, name=name)
        assert "Not analysed: 1 file that is not readable" in shown(result, name=name)


def test_an_unused_comment_is_noted(result_of):
    text = shown(result_of(unused=(Suppression("node.py", 4, 20, "TARL101"), Suppression("node.py", 5, 1))))
    assert "node.py:4:20 note: there is no TARL101 here for this comment to silence: remove it.\n" in text
    assert "node.py:5:1 note: there is no finding here for this comment" in text


def test_a_hazard_has_its_own_code_frame(example, result_of):
    hazard = Finding("TARL203", example.span("pos = data.pose"), "What odom brings reaches nothing.")
    text = shown(result_of(hazard))
    assert text.startswith("node.py:11:5 TARL203 What odom brings reaches nothing.\n")
    assert "   11 │     pos = data.pose.pose.position.x\n      │     ^^^^^^^^^^^^^^^\n" in text
    assert "1 hazard: 1 TARL203.\n" in text


def test_steps_in_other_files_name_their_file(example, result_of):
    flow = example.flow()
    elsewhere = replace(flow.steps[2], span=replace(flow.steps[2].span, path="lib/helper.py", line=7))
    source = replace(flow.source, span=replace(flow.source.span, path="main.py"))
    finding = replace(
        example.finding(), flow=replace(flow, source=source, steps=(*flow.steps[:2], elsewhere))
    )
    text = shown(result_of(finding))
    assert "TARL101 explicit from odom (Odometry)  main.py:22, callback\n" in text
    assert "      lib/helper.py:7  assign    ● pos" in text
    assert "                    9  receive   ● def" in text


def test_a_multi_line_step_is_joined(example, result_of):
    code = "self.sub = self.create_subscription(\n    Odometry,\n    'odom',\n    self.on_odom,\n)"
    flow = example.flow()
    finding = replace(example.finding(), flow=replace(flow, steps=(replace(flow.steps[0], code=code),)))
    assert "· self.sub = self.create_subscription(Odometry, 'odom', self.on_odom)\n" in shown(
        result_of(finding)
    )


def test_long_lines_are_cut_only_on_a_terminal(example, result_of):
    result = result_of(example.finding())
    narrow = shown(result, View(width=40)).splitlines()
    assert all(len(line) <= 40 for line in narrow if "│" in line or "assign" in line or "register" in line)
    assert any(line.endswith("…") for line in narrow)


def test_a_terminal_without_unicode_gets_ascii(example, result_of):
    gone = Accepted(fingerprint(example.flow(), "shuttle"), 1, ("node.py",))
    result = result_of(example.finding(), vanished=(gone,), baseline=Path("tarl-flows.json"))
    assert shown(result, View(glyphs=ASCII)).isascii()


def test_carets_stand_below_the_call_after_wide_characters(result_of):
    line = "\tx = '漢字'; pub.publish(vel)"
    column = line.index("pub") + 1
    hazard = Finding("TARL201", Span("node.py", 1, column, 1, column + 3), "…")
    text = shown(replace(result_of(hazard), texts={"node.py": line + "\n"}))
    frame, carets = text.splitlines()[1:3]
    assert frame == "   1 │     x = '漢字'; pub.publish(vel)"
    assert carets == "     │                 ^^^"


def test_long_call_is_shown_by_its_ends(result_of):
    text = "pub.publish(\n" + "".join(f"    x{i},\n" for i in range(9)) + ")\n"
    hazard = Finding("TARL201", Span("node.py", 1, 1, 11, 2), "…")
    lines = shown(replace(result_of(hazard), texts={"node.py": text})).splitlines()
    assert [line.split("│")[0].strip() for line in lines[1:11] if "^" not in line] == [
        "1",
        "2",
        "3",
        "4",
        "…",
        "11",
    ]


def test_findings_of_a_deleted_file_have_no_frame(example, result_of):
    text = shown(replace(result_of(example.finding()), texts={}))
    assert text.startswith("node.py:18:9 publishes progress (Float64) in travel\n\n    TARL101")


def test_concise_format_has_one_line_per_finding(example, result_of):
    result = result_of(
        example.finding(), example.finding("implicit", "scan"), errors=(SourceError("a.py", 2, "No."),)
    )
    assert shown(result, name="concise").splitlines() == [
        "a.py:2:1 TARL001 No.",
        "node.py:18:9 TARL101 odom reaches progress",
        "node.py:18:9 TARL102 scan reaches progress",
        "2 flows in 1 file: 1 explicit, 1 implicit.",
        "Not analysed: 1 file that is not readable as Python 3 (TARL001).",
    ]


def test_statistics_count_findings(example, result_of):
    text = shown(result_of(example.finding(), example.finding("implicit", "scan")), View(statistics=True))
    for line in (" 1  TARL101", " 1  TARL102", " 0  TARL001", " 2  subscriptions that reach a publish call",
                 " 1  publish calls reached", "10  steps that pass on the value", " 2  steps that are conditions",
                 " 6  steps of a flow, median", "24  lines analysed"):  # fmt: skip
        assert f"\n{line}\n" in text
