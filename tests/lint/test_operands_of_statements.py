"""Each kind of expression and statement has the operands whose value it uses, and no others."""

from __future__ import annotations

from textwrap import indent

import pytest

from tests.lint.analysing import analysed

NODE = """\
import rospy
from std_msgs.msg import F
GAIN, NEAR = 2.5, 0.5
class C:
    def __init__(self):
        self.k = 1.5
        self.table = {{"a": 3.5}}
        self.total = 0.0
        self.out = rospy.Publisher("b", F, queue_size=9)
        rospy.Subscriber("a", F, self.on)
    def on(self, msg):
{body}
C()
"""

EXPRESSIONS = [
    ("[2 * x for x in msg.ranges if x > 0.25]", ["2", "0.25"]),
    ("{k: 4 * x for k, x in msg.table if k}", ["4"]),
    ("[3, msg.data, (5, GAIN)]", ["3", "5", "GAIN"]),
    ("{'a': 3, 7: msg.data}", ["3"]),
    ("(y := 3) * msg.data", ["3"]),
    ("max(*[1.5, msg.data])", ["1.5"]),
    ("msg.data if msg.data > NEAR else self.k", ["NEAR", "self.k"]),
    ("not msg.data > 0.3", ["0.3"]),
    ("0.1 < msg.data < 0.9", ["0.1", "0.9"]),
    ("msg.data > 0.2 and msg.data < GAIN", ["0.2", "GAIN"]),
    ("self.table['a'] * msg.data", ["self.table['a']"]),
    ("msg.data.scaled(3).plus(4)", ["3", "4"]),
    ("round(msg.data, 2)", ["2"]),
    ("sum(msg.ranges, axis=0)", []),
    ("clip(msg.data, low=0.2, high=GAIN)", ["0.2", "GAIN"]),
    ("clip(msg.data, timeout=5, dtype=6)", []),
    ("zeros(7) + msg.data", []),
    ("range(8)[msg.data]", []),
    ("rospy.get_param('~g', 3.0) * msg.data", ["rospy.get_param('~g', 3.0)"]),
    ("rospy.loginfo(6) or msg.data", []),
    ("msg.data + float('1.5')", ["float('1.5')"]),
    ("'%d' % 5 + msg.text", ["5"]),
]


def operands(tmp_path, body: str) -> list[list[str]]:
    """Return the operands of each statement of a callback that is part of a flow, in the order of the lines."""
    analysis = analysed(tmp_path, node=NODE.format(body=indent(body, " " * 8)))
    steps = [step for step in analysis.sites if step.site.qualname == "C.on"]
    found = sorted(steps, key=lambda step: step.span)
    return [[one.code for one in analysis.operands(step.site)] for step in found if step.role != "receive"]


@pytest.mark.parametrize(("expression", "codes"), EXPRESSIONS)
def test_an_expression_has_the_operands_whose_value_it_uses(tmp_path, expression, codes):
    assert operands(tmp_path, f"v = {expression}\nself.out.publish(v)")[0] == codes


STATEMENTS = [
    ("self.total += 2 * msg.data\nself.out.publish(self.total)", [["2"], []]),
    ("v = msg.data\nv *= GAIN\nself.out.publish(v)", [[], ["GAIN"], []]),
    ("v: float = 3 * msg.data\nself.out.publish(v)", [["3"], []]),
    ("for v in [1.5, msg.data]:\n    self.out.publish(v)", [["1.5"], []]),
    ("if msg.data > 0.5:\n    v = 1.0\nelif msg.data > NEAR:\n    v = 2.0\nelse:\n    v = 3.0\nself.out.publish(v)",
     [["0.5"], ["1.0"], ["NEAR"], ["2.0"], ["3.0"], ["v"]]),
    ("while msg.data > NEAR:\n    self.out.publish(4.0)", [["NEAR"], ["4.0"]]),
    ("self.out.publish(F(data=2 * msg.data))", [["2"]]),
    ("with opened(3 * msg.data) as v:\n    self.out.publish(v)", [["3"], []]),
]  # fmt: skip


@pytest.mark.parametrize(("body", "codes"), STATEMENTS)
def test_a_statement_has_the_operands_of_its_header(tmp_path, body, codes):
    assert operands(tmp_path, body) == codes
