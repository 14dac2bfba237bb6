"""Any topic name leaves a report valid: it breaks no line and sends no control characters to a terminal."""

import io
import json
import re
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tarl_lint import report
from tarl_lint.cli import main
from tarl_lint.report import FORMATS, paint
from tarl_lint.report.line import View
from tarl_lint.run.runner import run
from tarl_lint.settings.config import Config, Options

NODE = """
import rospy
from std_msgs.msg import Float64

pub = rospy.Publisher({sink!r}, Float64, queue_size=1)

def on(msg):
    pub.publish(msg.data)

rospy.Subscriber({source!r}, Float64, on)
"""
TRICKS = [
    "\n",
    "\r",
    "\r\n",
    "\x1b[31m",
    "\x1b]0;title\x07",
    "\x9b2J",
    "\u202e",
    "\u2066",
    "\u2028",
    "\u2029",
    "\ufeff",
    "\x00",
    "\x85",
    "::error::x",
    "]]>",
    "-->",
    '"',
    "<",
    "&",
    "%0A",
]
TOPICS = st.lists(st.sampled_from([*TRICKS, "a", "/"]) | st.characters(codec="utf-8"), max_size=8).map(
    "".join
)
STEERING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff]")


def rendered(tmp_path, name, source, sink):
    file = tmp_path / "node.py"
    file.write_text(NODE.format(source=source, sink=sink), encoding="utf-8")
    result = run(Options(paths=(file,), cache=False), Config(root=tmp_path))
    assert len(result.findings) == 1
    text = io.StringIO()
    paint.write(report.render(name, result, View(show_paths=True)), text, colour=False)
    return text.getvalue()


@pytest.mark.parametrize("name", sorted(FORMATS))
@settings(max_examples=25)
@given(source=TOPICS, sink=TOPICS)
def test_special_characters_in_a_topic_break_no_report(tmp_path_factory, name, source, sink):
    directory = tmp_path_factory.mktemp("node")
    text = rendered(directory, name, source, sink)
    assert not STEERING.search(text)
    if name in ("json", "json2", "sarif", "gitlab"):
        json.loads(text)
    elif name == "junit":
        ElementTree.fromstring(text)
    else:
        one = (source.lstrip("/") or source) == (sink.lstrip("/") or sink)  # drawn as one topic
        assert text.count("\n") == rendered(directory, name, "in", "in" if one else "out").count("\n")


def test_line_breaks_in_a_topic_are_escaped(tmp_path):
    text = rendered(tmp_path, "concise", "in", "out\nother.py:1:1 TARL201 forged")
    assert "out\\nother.py:1:1 TARL201 forged" in text
    assert not re.search(r"^other\.py", text, re.MULTILINE)


@pytest.mark.parametrize(
    "arguments",
    [["no\x1b[2J.py"], ["--config", "no\x9b\u202e.toml"], ["--no\x1b[2J"], ["--launch", "no\x1b[2J.launch"]],
    ids=["file", "settings", "option", "launch file"],
)
def test_error_messages_pass_on_no_control_characters(arguments, capsys):
    assert main(arguments) == 2
    told = capsys.readouterr().err
    assert told.startswith("tarl-lint: ")
    assert not STEERING.search(told)
