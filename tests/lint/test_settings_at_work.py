"""Every setting end to end: files on disk, the command, its output and exit code."""

from __future__ import annotations

from pathlib import Path

import pytest

from tarl_lint.cli import main

LISTENER = """\
import rospy
from robot import bus, safety
from std_msgs.msg import Float64

pub = rospy.Publisher("/out", Float64, queue_size=1)


def on_value(msg):
    {body}


{subscribe}
rospy.spin()
"""
PLAIN = LISTENER.format(body="pub.publish(msg.data)", subscribe='rospy.Subscriber("/in", Float64, on_value)')


@pytest.fixture
def lint(in_directory, capsys):
    """Write files, run the command and return its findings, each as `file:line code`."""

    def go(files: dict[str, str], *arguments: str) -> list[str]:
        in_directory(files)
        main(["--format", "concise", "--no-cache", "--exit-zero", *arguments])
        captured = capsys.readouterr()
        assert captured.err == ""
        lines = [line.split(" ") for line in captured.out.splitlines() if " TARL" in line]
        return [f"{line[0].rpartition(':')[0]} {line[1]}" for line in lines if line[0].count(":") == 2]

    return go


def settings(text: str) -> dict[str, str]:
    return {"pyproject.toml": f"[tool.tarl-lint]\n{text}\n"}


def test_a_custom_source_calls_its_callback(lint):
    node = LISTENER.format(body="pub.publish(msg)", subscribe='bus.listen("/in", on_value)')
    assert lint({"node.py": node}) == []
    assert "node.py:9 TARL101" in lint({"node.py": node, **settings('sources = ["robot.bus.listen"]')})


def test_a_custom_sink_publishes(lint):
    node = PLAIN.replace("pub.publish(msg.data)", 'bus.Bus().send("/out", msg.data)')
    assert "node.py:9 TARL101" not in lint({"node.py": node})
    assert "node.py:9 TARL101" in lint({"node.py": node, **settings('sinks = ["robot.bus.Bus.send"]')})


def test_a_custom_sanitizer_removes_taint(lint):
    node = PLAIN.replace("pub.publish(msg.data)", "pub.publish(safety.clamp(msg.data))")
    assert lint({"node.py": node}) == ["node.py:9 TARL101"]
    assert lint({"node.py": node, **settings('sanitizers = ["robot.safety.clamp"]')}) == []


def test_a_custom_wrapper_acts_like_the_wrapped_function(lint):
    node = PLAIN.replace("rospy.Publisher(", "bus.advertise(Float64, topic=").replace(
        ", Float64, queue_size=1", ""
    )
    assert lint({"node.py": node}) == []
    like = '[tool.tarl-lint.wrappers]\n"robot.bus.advertise" = {like = "rospy.Publisher", topic = "topic", type = 0}'
    assert lint({"node.py": node, **settings(like)}) == ["node.py:9 TARL101"]


def test_transforms_are_sources_on_request(lint):
    node = """\
import rospy, tf2_ros
from std_msgs.msg import Float64
pub = rospy.Publisher("/out", Float64, queue_size=1)
buffer = tf2_ros.Buffer()
listener = tf2_ros.TransformListener(buffer)
while not rospy.is_shutdown():
    found = buffer.lookup_transform("map", "base", rospy.Time())
    pub.publish(found.transform.translation.x)
"""
    assert lint({"node.py": node}) == []
    assert lint({"node.py": node, **settings("tf2 = true")}) == ["node.py:8 TARL101"]


def test_clients_of_services_are_followed_on_request(lint):
    node = """\
import rospy
from std_msgs.msg import Float64
from std_srvs.srv import GetSpeed
pub = rospy.Publisher("/out", Float64, queue_size=1)
ask = rospy.ServiceProxy("speed", GetSpeed)
while not rospy.is_shutdown():
    pub.publish(ask().speed)
"""
    assert lint({"node.py": node}) == []
    assert lint({"node.py": node, **settings("clients = true")}) == ["node.py:7 TARL101"]


@pytest.mark.parametrize(
    ("arguments", "found"),
    [
        ((), ["a.py", "gen/b.py", "vendor/c.py"]),
        (("--exclude", "vendor/"), ["a.py", "gen/b.py"]),
        (("--exclude", "vendor/,gen"), ["a.py"]),
        (("--exclude", "vendor/", "--exclude", "[bx].py"), ["a.py"]),
        (("--extend-exclude", "/gen"), ["a.py", "vendor/c.py"]),
        (("--exclude", "*.py,!a.py"), ["a.py"]),
        (("--exclude", "vendor/", "vendor/c.py"), ["vendor/c.py"]),
    ],
)
def test_paths_are_excluded_by_patterns(lint, arguments, found):
    files = dict.fromkeys(["a.py", "gen/b.py", "vendor/c.py"], PLAIN)
    assert [line.split(":")[0] for line in lint(files, *arguments)] == found


def test_extend_exclude_adds_and_exclude_replaces(lint, capsys):
    files = dict.fromkeys(["a.py", "gen/b.py", "vendor/c.py"], PLAIN) | settings('exclude = ["gen/"]')
    assert [line.split(":")[0] for line in lint(files, "--extend-exclude", "vendor")] == ["a.py"]
    assert [line.split(":")[0] for line in lint(files, "--exclude", "vendor")] == ["a.py", "gen/b.py"]
    main(["--extend-exclude", "vendor", "--show-settings"])
    (line,) = (line for line in capsys.readouterr().out.splitlines() if line.startswith("exclude"))
    assert " ".join(line.split()) == 'exclude = ["gen/", "vendor"] # pyproject.toml and command line'


def test_nested_and_negated_gitignore_files_are_respected(lint):
    files = dict.fromkeys(["top.py", "old/a.py", "old/keep.py", "new/a.py", "new/deep/b.py"], PLAIN)
    ignores = {
        ".gitignore": "old/*\n!old/keep.py\n/top.py\n",
        "new/.gitignore": "*.py\n",
        "new/deep/.gitignore": "!b.py",
    }
    found = [line.split(":")[0] for line in lint(files | ignores)]
    assert found == ["new/deep/b.py", "old/keep.py"]


@pytest.mark.parametrize(
    "value",
    ["a.py:TARL101 b/:TARL1,TARL2", "a.py:TARL101  b/:TARL1, TARL2", "*.py:TARL1"],
)
def test_per_file_ignores_are_written_as_for_flake8(lint, value):
    assert lint({"a.py": PLAIN, "b/b.py": PLAIN}, "--per-file-ignores", value) == []


def test_rules_are_selected_by_commas_or_repeated_options(lint):
    both = PLAIN + 'rospy.Publisher("/idle", Float64, queue_size=1)\nrospy.init_node("n")\n'
    assert lint({"a.py": both}) == ["a.py:9 TARL101", "a.py:14 TARL204"]
    assert lint({"a.py": both}, "--select", "TARL101,TARL204") == ["a.py:9 TARL101", "a.py:14 TARL204"]
    assert lint({"a.py": both}, "--select", "tarl101", "--select", "TARL2") == [
        "a.py:9 TARL101",
        "a.py:14 TARL204",
    ]
    assert lint({"a.py": both}, "--select", "TARL", "--ignore", "TARL1") == ["a.py:14 TARL204"]
    assert lint({"a.py": both}, "--ignore", "TARL1", "--ignore", "TARL2") == []


def test_a_named_settings_file_is_used(lint):
    files = {"a.py": PLAIN, "strict.toml": 'ignore = ["TARL1"]\n', **settings('select = ["TARL1"]')}
    assert lint(files) == ["a.py:9 TARL101"]
    assert lint(files, "--config", "strict.toml") == []


def test_run_without_findings_names_disabled_flow_rules(in_directory, capsys):
    in_directory({"a.py": PLAIN})
    assert main(["--select", "TARL2"]) == 0
    assert capsys.readouterr().out == "No hazard in 1 file.\n"


@pytest.mark.parametrize("text", ["tf2 = 1", "exlude = []", "extend-exclude = []", 'tf2 = "yes"'])
def test_invalid_settings_are_refused(in_directory, capsys, text):
    in_directory({"a.py": PLAIN, **settings(text)})
    assert main([]) == 2
    assert capsys.readouterr().err.startswith("tarl-lint: pyproject.toml: ")


def test_unsaved_text_replaces_its_file(in_directory, capsys, monkeypatch):
    import io
    import types

    in_directory({"src/a.py": "x = 1\n", "src/pyproject.toml": "[tool.tarl-lint]\n"})
    monkeypatch.setattr("sys.stdin", types.SimpleNamespace(buffer=io.BytesIO(PLAIN.encode())))
    assert main(["-", "--stdin-filename", "src/a.py", "--format", "concise"]) == 1
    assert capsys.readouterr().out.startswith("src/a.py:9:5 TARL101 ")
    assert Path("src/a.py").read_text() == "x = 1\n"
