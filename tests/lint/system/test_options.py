"""Every option of tarl-lint together with --launch: exit codes, silencing, the baseline, limits, counts."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tarl_lint.interpret import fixpoint
from tarl_lint.system.flow_chains import chains, limited
from tarl_lint.system.model import Hop
from tests.lint.test_system import MANIFEST, RELAY, flows, relay, run, write

HAZARD = "TARL308"
USELESS = '<node pkg="arm" type="relay.py" name="second"><remap from="outt" to="/cmd_vel"/></node>'


@pytest.fixture
def arm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a workspace whose launch file `a.launch` has a flow and, in line 3, a remapping without effect."""
    monkeypatch.chdir(tmp_path)
    write(tmp_path, {"arm/package.xml": MANIFEST.format("arm", "catkin"), "arm/scripts/relay.py": RELAY})
    return launch(tmp_path, USELESS)


def launch(folder: Path, line: str, name: str = "a.launch") -> Path:
    text = f"<launch>\n{relay('first', 'scan', 'middle')}\n{line}\n</launch>\n"
    return write(folder, {f"arm/launch/{name}": text})


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ((), 1),
        (("--fail-on", "hazard"), 1),
        (("--fail-on", "implicit"), 1),
        (("--fail-on", "never"), 0),
        (("--exit-zero",), 0),
        (("--ignore", HAZARD), 0),
        (("--ignore", "TARL3"), 0),
        (("--select", HAZARD), 1),
        (("--select", "TARL301"), 0),
        (("--per-file-ignores", f"*.launch:{HAZARD}"), 0),
        (("--per-file-ignores", f"*.py:{HAZARD}"), 1),
        (("--exclude", "*.launch"), 1),  # a file that is named is read in any case
        (("--from", "scan"), 1),
    ],
)
def test_runs_with_launch_files_have_the_usual_exit_codes(arm, capsys, options, code):
    assert run(capsys, "--launch", "a.launch", *options)[0] == code


def test_the_exit_code_does_not_depend_on_the_format(arm, capsys):
    for form in ("github", "sarif", "json", "dot"):
        assert run(capsys, "--launch", "a.launch", "--format", form)[0] == 1


def test_flows_across_nodes_never_fail_a_run(arm, capsys):
    launch(arm, relay("second", "middle", "/cmd_vel"))
    code, out, _ = run(capsys, "--launch", "a.launch", "--fail-on", "implicit")
    assert flows(out) == ["/scan → /first → /middle → /second → /cmd_vel  explicit"]
    assert code == 0


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        (
            "b.launch",
            "<launch>",
            "b.launch:1: the launch file cannot be read: it is not XML: no element found",
        ),
        (
            "b.launch.py",
            "def generate_launch_description(:\n",
            "b.launch.py:1: the launch file cannot be read: it is not Python 3: invalid syntax.",
        ),
        ("b.launch.yaml", "launch: [\n", "b.launch.yaml: the launch file cannot be read: it is not YAML: "),
    ],
)
def test_a_named_launch_file_must_be_readable(arm, capsys, name, text, reason):
    write(arm, {f"arm/launch/{name}": text})
    code, out, err = run(capsys, "--launch", name)
    assert (code, out) == (2, "")
    assert err.startswith(f"tarl-lint: arm/launch/{reason}")
    write(arm, {"arm/launch/a.launch": "<launch/>"})
    code, out, _ = run(capsys, "--launch", "all", "--format", "concise")
    assert code == 0
    assert f"arm/launch/{name}:1:1 TARL001 The file cannot be read: it is not " in out
    assert "Not analysed: 1 file that is not readable" in out
    assert (
        "TARL001 The" not in run(capsys, "--launch", "all", "--format", "concise", "--ignore", "TARL001")[1]
    )


def test_unreadable_included_launch_file_is_reported(arm, capsys):
    write(arm, {"arm/launch/part.launch": "<launch>"})
    launch(arm, '<include file="$(find arm)/launch/part.launch"/>')
    code, out, _ = run(capsys, "--launch", "a.launch", "--format", "concise")
    assert code == 0
    assert (
        "arm/launch/part.launch:1:1 TARL001 The file cannot be read: it is not XML: no element found" in out
    )


@pytest.mark.parametrize(
    "comment",
    [
        f"<!-- tarl: ignore[{HAZARD}] -->",
        "<!-- tarl: ignore -->",
        "<!-- the arm\n --><!-- tarl: ignore[TARL3] -->",
        f"<!-- noqa: {HAZARD} -->",
    ],
)
def test_a_comment_silences_a_hazard_in_a_launch_file(arm, capsys, comment):
    launch(arm, comment + USELESS)
    code, out, _ = run(capsys, "--launch", "a.launch")
    assert code == 0
    assert "Silenced: 1 by comments." in out
    launch(
        arm,
        comment.replace(HAZARD, "TARL301").replace("[TARL3]", "[TARL1]").replace("ignore -", "ignor -")
        + USELESS,
    )
    assert run(capsys, "--launch", "a.launch")[0] == 1


def test_comment_about_launched_systems_is_not_useless(arm, capsys):
    source = RELAY.replace("publish(2.0 * msg.data))", "publish(msg.data))  # tarl: ignore[TARL306]")
    write(arm, {"arm/scripts/relay.py": source})
    assert "for this comment to silence" not in run(capsys, "arm")[1]
    write(arm, {"arm/scripts/relay.py": source.replace("TARL306", "TARL203")})
    assert "there is no TARL203 here for this comment to silence" in run(capsys, "arm")[1]


YAML = """\
launch:
- node:
    pkg: arm
    exec: relay.py
    name: one
    remap: [{from: outt, to: /cmd_vel}]
"""


def test_a_comment_silences_a_hazard_in_yaml_and_python(arm, capsys):
    write(arm, {"arm/package.xml": MANIFEST.format("arm", "ament_cmake"), "arm/launch/b.launch.yaml": YAML})
    _, out, _ = run(capsys, "--launch", "b.launch.yaml", "--format", "json")
    (finding,) = json.loads(out)["systems"][0]["diagnostics"]
    lines = YAML.splitlines()
    lines[finding["line"] - 1] += f"  # tarl: ignore[{HAZARD}]"
    write(arm, {"arm/launch/b.launch.yaml": "\n".join(lines)})
    assert run(capsys, "--launch", "b.launch.yaml")[0] == 0


def test_exclude_applies_to_launch_files(arm, capsys):
    launch(arm, "", "b.launch")
    assert run(capsys, "--launch", "all")[0] == 1
    for pattern in ("a.launch", "arm/launch/a.*", "/arm/launch/a.launch"):
        code, out, _ = run(capsys, "--launch", "all", "--extend-exclude", pattern)
        assert code == 0, pattern
        assert "arm/launch/b.launch: 1 node" in out


def test_vanished_hazard_leaves_the_baseline(arm, capsys):
    baseline = arm / "tarl-flows.json"
    assert run(capsys, "--launch", "all", "--write-baseline")[0] == 0
    kept = json.loads(baseline.read_text())
    assert run(capsys, "--launch", "all")[0] == 0
    launch(arm, relay("second", "middle", "/cmd_vel"))
    # a run of one launch file cannot tell whether another one still has the hazard
    assert "no longer found" not in run(capsys, "--launch", "a.launch")[1]
    run(capsys, "--launch", "a.launch", "--write-baseline")
    assert json.loads(baseline.read_text()) == kept
    for form in ("text", "concise", "github"):
        out = run(capsys, "--launch", "all", "--format", form)[1]
        assert "Accepted but no longer found, in tarl-flows.json:" in out, form
        assert HAZARD in out, form
    assert "no longer found" in run(capsys, "--launch", "all", "--format", "sarif")[2]
    run(capsys, "--launch", "all", "--write-baseline")
    assert "hazards" not in json.loads(baseline.read_text())


def test_flows_beyond_the_limit_are_counted(arm, capsys):
    launch(arm, "".join(relay(f"n{number}", "middle", f"/out{number}") for number in range(4)))
    for form in ("text", "concise", "github"):
        out = run(capsys, "--launch", "a.launch", "--format", form, "--max-paths", "3")[1]
        assert out.count(" → /middle → /n") == 3
        assert "… and 1 more flow: select them with --from and --to, or show all with --max-paths 0." in out
        out = run(capsys, "--launch", "a.launch", "--format", form, "--max-paths", "0")[1]
        assert out.count(" → /middle → /n") == 4


def test_a_search_that_ends_early_says_so(monkeypatch):
    hops = [Hop("/n", "/in", f"/{number}", "explicit") for number in range(300)]
    found, more = chains(hops)
    assert (len(found), more) == (200, True)
    assert limited(found, 150, more=more)[1].startswith("… and more than 50 more flows: ")
    found, more = chains(hops, every=True)
    assert (len(found), more) == (300, False)
    assert limited(found, 0, more=more) == (found, "")
    monkeypatch.setattr("tarl_lint.system.flow_chains.STEPS", 10)
    found, more = chains(hops, every=True)
    assert (len(found), more) == (10, True)
    assert limited(found, 0, more=more)[1] == "… and more: select them with --from and --to."


def test_a_query_counts_unreadable_programs_in_one_line(arm, capsys):
    write(arm, {"arm/scripts/broken.py": "#!/usr/bin/env python3\nx = (\n"})
    launch(arm, '<node pkg="arm" type="broken.py" name="broken"/>')
    assert "TARL001 The file is not valid Python" in run(capsys, "--launch", "a.launch")[1]
    out = run(capsys, "--launch", "a.launch", "--from", "scan")[1]
    assert out.endswith("\n\nNot analysed: 1 file that is not readable as Python 3 (TARL001).\n")


@pytest.mark.parametrize(("chosen", "flows"), [((), "2"), (("--from", "nowhere"), "0")])
@pytest.mark.parametrize("form", ["text", "concise"])
def test_statistics_count_nodes_flows_and_hazards(arm, capsys, form, chosen, flows):
    lines = run(capsys, "--launch", "a.launch", "--format", form, "--statistics", *chosen)[1].splitlines()
    counts = {line.strip().partition("  ")[2]: line.split()[0] for line in lines if line}
    assert counts[HAZARD] == counts["launch files"] == "1"
    assert counts["nodes"] == "2"
    assert counts["flows across nodes, explicit"] == flows
    assert counts["nodes that were not read"] == "0"


def test_the_option_show_settings_prints_the_settings(arm, capsys):
    code, out, _ = run(capsys, "--launch", "all", "--show-settings", "--ignore", HAZARD)
    assert code == 0
    assert f'ignore = ["{HAZARD}"]' in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--launch", "all", "-"), "--from and --to analyse the files of a workspace, not standard input"),
        (
            ("--from", "/scan", "--stdin-filename", "a.py"),
            "analyse the files of a workspace, not standard input",
        ),
        (
            ("--select", "TARL301,TARL304"),
            "select names only rules about launch files (TARL301, TARL304): add --launch",
        ),
    ],
)
def test_incompatible_options_are_refused_in_one_sentence(arm, capsys, arguments, message):
    code, _, err = run(capsys, *arguments)
    assert code == 2
    assert message in err


def test_text_says_that_no_launch_rule_is_enabled(arm, capsys):
    assert (
        "No rule about launch files (TARL3) is enabled."
        in run(capsys, "--launch", "all", "--select", "TARL1")[1]
    )
    assert "is enabled" not in run(capsys, "--launch", "all", "--select", "TARL1,TARL301")[1]


CPP = """\
#include <ros/ros.h>
int main(int argc, char** argv) {
  ros::init(argc, argv, "limit");
  ros::NodeHandle n;
  auto out = n.advertise<std_msgs::Float64>("cmd_vel", 1);
  auto in = n.subscribe<std_msgs::Float64>("out", 1, heard);
}
"""


def test_cpp_nodes_are_also_counted_without_a_launch_file(arm, capsys):
    write(
        arm,
        {
            "arm/CMakeLists.txt": "project(arm)\nadd_executable(limit src/limit.cpp)\n",
            "arm/src/limit.cpp": CPP,
        },
    )
    _, out, _ = run(capsys, "--from", "in", "--to", "cmd_vel")
    assert out.startswith(".: ") or ": 2 nodes, 1 not read" in out
    assert flows(out) == ["/in → /relay → /out → [/limit, not read] → /cmd_vel  not read"]
    (arm / "arm/scripts/relay.py").unlink()
    assert flows(run(capsys, "--to", "cmd_vel")[1]) == ["/out → [/limit, not read] → /cmd_vel  not read"]


# a function of 300 statements between the subscription and the publish call
LONG = (
    "def helper(x):\n    return x\ndef on(msg):\n    x = msg.data\n"
    + "".join(f"    x = helper(x) + {number}\n" for number in range(300))
    + "    out.publish(x)\nrospy.Subscriber('in', Float64, on)\n"
)


def test_exhausted_program_is_named_in_every_format(arm, capsys, monkeypatch):
    monkeypatch.setattr(fixpoint, "MAX_STATEMENTS", 100)
    source = RELAY.replace("rospy.Subscriber", "# ").replace("rospy.spin", f"{LONG}rospy.spin")
    write(arm, {"arm/scripts/relay.py": source})
    for form in ("text", "concise", "json", "json2", "sarif", "github", "gitlab", "junit"):
        text = "".join(run(capsys, "--launch", "a.launch", "--format", form)[1:])
        assert "arm/scripts/relay.py" in text, form
        assert re.search("too large to analyse completely|parts of 1 large program", text), form
    out = run(capsys, "--launch", "a.launch")[1]
    assert "arm/scripts/relay.py: (node relay): too large to analyse completely; flows may be missing" in out
