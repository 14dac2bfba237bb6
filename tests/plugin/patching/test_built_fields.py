"""Fields of messages that several statements build, and the factor before the message is published."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from pytest_tarl.model import Guard
from pytest_tarl.patching.built_fields import built_fields
from pytest_tarl.patching.document import apply_edits, document
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.rewriting import rewrite
from pytest_tarl.patching.structures import Form, described, form_edits
from pytest_tarl.patching.templates import SHIPPED, template
from tarl_lint.api import analyse
from tarl_lint.model import Operand, Span

GAIN = template(SHIPPED / "field_gain.toml")
HEAD = "from std_msgs.msg import Float32, Int32\n\n\ndef drive(self, data):\n"
SUM = "self.msg.data = data.x\nself.msg.data += data.z\n"


def found(body: str, head: str = HEAD) -> list[tuple[str, str]]:
    """Return the messages and fields of the last statement of a function."""
    text = head + "".join(f"    {line}\n" for line in body.splitlines())
    source = document("node.py", text)
    function = next(one for one in ast.walk(source.tree) if isinstance(one, ast.FunctionDef))
    return [(ast.unparse(node), built.field) for node, built in built_fields(source, function.body[-1])]


PUBLISH = "self.pub.publish(self.msg)"
BRANCHES = """\
if data.slow:
    self.msg.data = 0.5 * data.x
else:
    self.msg.data = data.x
"""


@pytest.mark.parametrize(
    ("body", "fields"),
    [
        (SUM, ["data"]),
        (BRANCHES, ["data"]),
        ("msg = Float32()\nif data.x:\n    msg.data = 0.5\nmsg.data += 1.5\nself.pub.publish(msg)", ["data"]),
        ("self.msg.linear.x = 2.0\nself.msg.linear.x *= data.x\n", ["linear.x"]),
        ("self.msg.data = data.x\n", []),
        ("if data.slow:\n    self.msg.data = data.x\nself.msg.data += 1.0\n", []),
        ("self.msg.data += data.x\nself.msg.data += 1.0\n", []),
        ("self.msg.data = 'a'\nself.msg.data += 'b'\n", []),
        ("self.msg.data = f'{data}'\nself.msg.data += data.name\n", []),
        ("self.msg.data = data.x\nself.msg.data = data.y\n", []),
        ("msg = Int32()\nmsg.data = 2 * data.x\nmsg.data += data.z\nself.pub.publish(msg)", []),
        ("if data.stop:\n    return\nelse:\n    self.msg.data = data.x\nself.msg.data += 1.0\n", ["data"]),
    ],
    ids=[
        *(
            "a sum",
            "branches",
            "a new message",
            "a nested field",
            "one statement",
            "not always set",
            "never set",
        ),
        *("texts", "a formatted text", "no number", "an integer", "a branch that leaves"),
    ],
)
def test_fields_are_found_across_statements(body: str, fields: list[str]) -> None:
    body = body if "publish" in body else body + PUBLISH
    assert [field for _, field in found(body)] == fields


def test_only_a_statement_that_publishes_a_named_message_counts() -> None:
    assert found(SUM + PUBLISH) == [("self.msg", "data")]
    assert found(SUM + "self.pub.publish(Float32(self.msg.data))") == []
    assert found(SUM + "self.pub.send(self.msg)") == []
    assert found(SUM + "done = self.pub.publish(self.msg)") == []
    assert found(PUBLISH + "\n" + SUM) == []


def edited(condition: str) -> str:
    text = "pub.publish(self.msg)\n"
    source = document("node.py", text)
    node = source.find(Span("node.py", 1, 13, 1, 21))
    form = Form(GAIN, "gain", (("gain", 2.0),), field="linear.x")
    assert described(form, form.target("self.msg"), "", {"gain": 2.5}) == (
        "multiply self.msg.linear.x by 2.5 before it is published"
    )
    return apply_edits(source, form_edits(source, node, form, {"gain": 2.5}, condition, ""))


def test_the_factor_is_applied_before_the_publish_call() -> None:
    assert edited("") == "self.msg.linear.x *= 2.5\npub.publish(self.msg)\n"
    assert "self.msg.linear.x = self.msg.linear.x * 2.5 if wet else self.msg.linear.x\n" in edited("wet")


NODE = """\
import rospy
from geometry_msgs.msg import Twist


def on_scan(data):
    cmd = Twist()
    cmd.linear.x = data.linear.x
    cmd.linear.x += 0.5 * data.linear.y
    cmd.angular.z = data.angular.z
    cmd.angular.z += 0.5 * data.angular.x
    pub.publish(cmd)


rospy.init_node("mixer")
pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
rospy.Subscriber("scan", Twist, on_scan)
rospy.spin()
"""


def test_two_fields_of_one_message_change_together(tmp_path: Path) -> None:
    (tmp_path / "mixer.py").write_text(NODE)
    analysis = analyse([tmp_path / "mixer.py"], root=tmp_path)
    (step,) = [one for one in analysis.sites if one.code.startswith("pub.publish")]
    span = Span(step.span.path, step.span.line, 17, step.span.line, 20)
    changes = [
        Mutation(
            Operand(step.site, span, f"gain of cmd.{field}, gain", 2.0),
            by,
            form=Form(GAIN, "gain", (("gain", 2.0),), field=field),
        )
        for field, by in (("linear.x", 1.0), ("angular.z", 0.75))
    ]
    (text,) = rewrite(analysis, changes, Guard(), {}).values()
    assert "    cmd.linear.x *= 2.0\n" in text
    assert "    cmd.angular.z *= 1.5\n" in text
    assert ast.parse(text)
