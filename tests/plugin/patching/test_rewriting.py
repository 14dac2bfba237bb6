"""The source text that mutations produce, without and under a condition."""

from __future__ import annotations

import ast
from difflib import ndiff
from pathlib import Path
from textwrap import dedent, indent
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl import Sensor
from pytest_tarl.errors import RepairError
from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.mutate import (
    Mutation,
    is_integral,
    mutations,
)
from pytest_tarl.patching.rewriting import guard_text, rewrite
from tarl_lint.api import analyse
from tests.plugin.patching.repairs import MUD, MUDDY_STRETCH, TOPICS, HandMade, TinyRos

HELD = {("/terrain", "data"): ("mud",), ("/odom", "pose.pose.position.x"): ("pos",)}
# Each case: a statement, its operand, the new value (None: the old one), the result without a condition and in mud.
ALWAYS = [
    ("vel = 5 * delta", "5", 5, 12.0, "vel = 12.0 * delta"),
    ("vel = self.kp * delta", "self.kp", 0.5, 2.4, "vel = 2.4 * self.kp * delta"),
    ("vel = delta * self.kp", "self.kp", 0.5, 2.4, "vel = delta * (2.4 * self.kp)"),
    ("vel = delta - self.kp", "self.kp", 0.5, 2.4, "vel = delta - 2.4 * self.kp"),
    ("vel = self.kp", "self.kp", 0.5, 2.4, "vel = 2.4 * self.kp"),
    ("vel = (self.kp) * delta", "self.kp", 0.5, 2.4, "vel = (2.4 * self.kp) * delta"),
    ("vel = -self.kp ** 2", "self.kp", 0.5, 2.4, "vel = -(2.4 * self.kp) ** 2"),
    ("vel = delta ** 2", "2", 2, -1.5, "vel = delta ** -1.5"),
    ("vel = 2 ** delta", "2", 2, -1.5, "vel = (-1.5) ** delta"),
    ("vel = clamp(delta, self.top)", "self.top", 2.0, 0.4, "vel = clamp(delta, 0.4 * self.top)"),
    ("vel = delta - self.bias", "self.bias", 0.0, -0.25, "vel = delta - (self.bias - 0.25)"),
    ("vel = delta + self.bias", "self.bias", 0.0, 0.25, "vel = delta + (self.bias + 0.25)"),
    ("if self.enabled and delta: pass", "self.enabled", True, False, "if not self.enabled and delta: pass"),
    (
        "while delta > TOLERANCE:\n    break",
        "TOLERANCE",
        0.1,
        2.2,
        "while delta > 2.2 * TOLERANCE:\n    break",
    ),
    ("vel = gains[self.level]", "self.level", 3, 2.2, "vel = gains[round(2.2 * self.level)]"),
    ("vel = delta[3]", "3", 3, 6.6, "vel = delta[7]"),
    ("on = True", "True", True, False, "on = False"),
    ("vel = 1e-3*delta", "1e-3", 0.001, 0.0000123456, "vel = 1.235e-05*delta"),
    ("vel = -0.5 * delta", "-0.5", -0.5, 1.1, "vel = 1.1 * delta"),
]
IN_MUD = [
    ("vel = 5 * delta", "5", 5, 12.0, "if mud:\n    vel = 12.0 * delta\nelse:\n    vel = 5 * delta"),
    ("vel += 5 * delta  # m/s", "5", 5, 12.0, "if mud:\n    vel += 12.0 * delta\nelse:\n    vel += 5 * delta  # m/s"),
    ("x = f(5)  # noqa", "5", 5, 12.0, "if mud:\n    x = f(12.0)  # noqa\nelse:\n    x = f(5)  # noqa"),
    ("return 5 * delta", "5", 5, 12.0, "if mud:\n    return 12.0 * delta\nreturn 5 * delta"),
    ("pub.publish(K * d)", "K", 2.0, 1.5, "if mud:\n    pub.publish(1.5 * K * d)\nelse:\n    pub.publish(K * d)"),
    (
        "x = [5 * e for e in errors]", "5", 5, 12.0,
        "if mud:\n    x = [12.0 * e for e in errors]\nelse:\n    x = [5 * e for e in errors]",
    ),
    (
        "cmd = Twist(\n    linear=5 * d,  # forward\n    angular=0.1,\n)", "5", 5, 12.0,
        "cmd = Twist(\n    linear=(12.0 if mud else 5) * d,  # forward\n    angular=0.1,\n)",
    ),
    (
        "cmd = max(5 * d,\n          0.1)", "5", 5, 12.0,
        "if mud:\n    cmd = max(12.0 * d,\n              0.1)\nelse:\n    cmd = max(5 * d,\n              0.1)",
    ),
    ("if d > 5:\n    pass", "5", 5, 12.0, "if d > (12.0 if mud else 5):\n    pass"),
    ("if d > K:\n    pass", "K", 2.0, 1.5, "if d > (1.5 if mud else 1) * K:\n    pass"),
    ("if d > K:\n    pass", "K", None, 1.5, "if d > (1.5 * K if mud else K):\n    pass"),
    ("while stop(d, 5):\n    break", "5", 5, 12.0, "while stop(d, 12.0 if mud else 5):\n    break"),
    ("for i in range(5):\n    pass", "5", 5, 12, "for i in range(12 if mud else 5):\n    pass"),
    ("cb = lambda m: 5 * m", "5", 5, 12.0, "cb = lambda m: (12.0 if mud else 5) * m"),
    ("s = (5 * e for e in errors)", "5", 5, 12.0, "s = ((12.0 if mud else 5) * e for e in errors)"),
    ("vel: float = 5", "5", 5, 12.0, "vel: float = 12.0 if mud else 5"),
    ("a = 1; vel = 5 * a", "5", 5, 12.0, "a = 1; vel = (12.0 if mud else 5) * a"),
    ("if go: vel = 5 * a", "5", 5, 12.0, "if go: vel = (12.0 if mud else 5) * a"),
    ('log("""a\nb""", 5)', "5", 5, 12.0, 'log("""a\nb""", 12.0 if mud else 5)'),
]  # fmt: skip


@pytest.mark.parametrize(("statement", "code", "value", "new", "expected"), ALWAYS)
def test_without_a_condition_the_used_value_is_replaced(
    statement: str, code: str, value: Any, new: Any, expected: str
) -> None:
    assert written(statement, code, value, new, Guard()) == expected


@pytest.mark.parametrize(("statement", "code", "value", "new", "expected"), IN_MUD)
def test_a_conditional_change_has_the_expected_text(
    statement: str, code: str, value: Any, new: Any, expected: str
) -> None:
    assert written(statement, code, value, new, MUD) == expected


def written(statement: str, code: str, value: Any, new: Any, guard: Guard) -> str:
    """Rewrite one operand of a statement inside a method in which `mud` contains the terrain."""
    head = "class Node:\n    def step(self, mud, pos, delta):\n"
    text = f"{head}{indent(statement, ' ' * 8)}\n"
    if '"""' in statement:
        text = f"{head}        {statement}\n"
    analysis = HandMade({"node.py": text}, held=HELD)
    literal = not any(part.isidentifier() for part in code.split(".")) or code == "True"
    operand = analysis.operand(code, value, code, literal=literal)
    if text.index(code) < len(head):
        operand = analysis.operand(code, value, statement.splitlines()[0], literal=literal)
    changed = rewrite(analysis, [Mutation(operand, new)], guard, TOPICS)["node.py"]
    body = changed.removeprefix(head).removesuffix("\n")
    return body[8:] if '"""' in statement else dedent(body)


TWO = """\
def step(delta, mud, pos):
    a = 5 * abs(delta)
    # then
    b = 0.1 + a
    if b > 3:
        return b
    return 0.7
"""


def test_adjacent_statements_under_one_condition_share_one_if_statement() -> None:
    analysis = HandMade({"node.py": TWO}, held=HELD)
    uses = [analysis.operand("5", 5, "5 *"), analysis.operand("0.1", 0.1, "0.1 + a")]
    changed = rewrite(analysis, [Mutation(use, 2.5) for use in reversed(uses)], MUD, TOPICS)
    assert changed["node.py"] == TWO.replace(
        "    a = 5 * abs(delta)\n    # then\n    b = 0.1 + a\n",
        "    if mud:\n        a = 2.5 * abs(delta)\n        b = 2.5 + a\n"
        "    else:\n        a = 5 * abs(delta)\n        # then\n        b = 0.1 + a\n",
    )


@pytest.mark.parametrize("first", ["mud = 5 * delta", "log(5 * delta)", "a = yield 5"])
def test_condition_is_repeated_after_a_change(first: str) -> None:
    text = f"def step(delta, mud, pos):\n    {first}\n    b = 0.1 + mud\n"
    analysis = HandMade({"node.py": text}, held=HELD)
    uses = [analysis.operand("5", 5, "5"), analysis.operand("0.1", 0.1, "0.1 + mud")]
    changed = rewrite(analysis, [Mutation(use, 2.5) for use in uses], MUD, TOPICS)["node.py"]
    assert changed.count("if mud:") == 2


def test_several_constants_of_a_statement_change_together() -> None:
    text = "def step(delta, mud):\n    return min(5, max(-3, 2 * delta))\n"
    analysis = HandMade({"node.py": text}, held=HELD)
    uses = [
        analysis.operand("5", 5, "min(5"),
        analysis.operand("-3", -3, "max(-3"),
        analysis.operand("2", 2, "2 *"),
    ]
    changed = rewrite(analysis, [Mutation(use, 7.5) for use in uses], MUD, TOPICS)["node.py"]
    assert "        return min(7.5, max(7.5, 7.5 * delta))\n    return min(5" in changed


def test_condition_needed_twice_gets_a_name() -> None:
    text = "def step(delta, mud, drifted):\n    if 5 < delta < 9:\n        pass\n"
    analysis = HandMade({"node.py": text}, held=HELD)
    uses = [analysis.operand("5", 5, "5 < d"), analysis.operand("9", 9, "< 9")]
    changed = rewrite(analysis, [Mutation(use, 7.5) for use in uses], MUD, TOPICS)["node.py"]
    assert changed == (
        "def step(delta, mud, drifted):\n    drifted_reading = mud\n"
        "    if (7.5 if drifted_reading else 5) < delta < (7.5 if drifted_reading else 9):\n        pass\n"
    )


def test_a_condition_and_its_sensor_have_different_names() -> None:
    text = dedent(
        """\
        import rospy
        rospy.init_node("n")

        def step(delta):
            if 5 < delta < 9:
                return True
        """
    )
    analysis = HandMade({"node.py": text})
    uses = [analysis.operand("5", 5, "5 < d"), analysis.operand("9", 9, "< 9")]
    guard = Guard((Conjunct(Sensor("drifted", topic="/terrain", field="data"), 1, 1),))
    changed = rewrite(analysis, [Mutation(use, 1.5) for use in uses], guard, TOPICS)
    ros = TinyRos()
    step = ros.run(changed, "node.py")["step"]
    assert (step(7), step(1.5)) == (True, None)
    ros.deliver("/terrain", type("Bool", (), {"data": True}))
    assert step(7) is None


def test_the_condition_of_an_elif_stays_where_it_is() -> None:
    text = "def step(delta, mud):\n    if mud:\n        pass\n    elif 5 < delta < 9:\n        pass\n"
    analysis = HandMade({"node.py": text}, held=HELD)
    uses = [analysis.operand("5", 5, "5 < d"), analysis.operand("9", 9, "< 9")]
    changed = rewrite(analysis, [Mutation(use, 7.5) for use in uses], MUD, TOPICS)["node.py"]
    assert "    elif (7.5 if mud else 5) < delta < (7.5 if mud else 9):\n" in changed


def test_loop_condition_is_evaluated_each_iteration() -> None:
    text = "def step(delta, mud):\n    while 5 < delta < 9:\n        delta = move()\n"
    analysis = HandMade({"node.py": text}, held=HELD)
    uses = [analysis.operand("5", 5, "5 < d"), analysis.operand("9", 9, "< 9")]
    changed = rewrite(analysis, [Mutation(use, 7.5) for use in uses], MUD, TOPICS)["node.py"]
    assert "while (7.5 if mud else 5) < delta < (7.5 if mud else 9):" in changed


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
@pytest.mark.parametrize("unit", ["\t", "  ", "    "])
@pytest.mark.parametrize("final", [True, False])
def test_line_endings_and_indentation_are_kept(ending: str, unit: str, final: bool) -> None:
    lines = ["# Größe — ñ", "def step(δ, mud):", f"{unit}été = 5 * δ", f"{unit}return été*0.5  # ½"]
    text = ending.join(lines) + (ending if final else "")
    analysis = HandMade({"node.py": text}, held=HELD)
    changed = rewrite(analysis, [Mutation(analysis.operand("0.5", 0.5, "0.5"), 1.25)], MUD, TOPICS)["node.py"]
    new = [f"{unit}if mud:", f"{unit}{unit}return été*1.25", lines[-1]]
    assert changed == ending.join([*lines[:-1], *new]) + (ending if final else "")


def test_condition_is_reported_as_written() -> None:
    text = "def step(delta, mud, pos):\n    return 5 * delta\n"
    analysis = HandMade({"node.py": text}, held=HELD)
    change = [Mutation(analysis.operand("5", 5, "5 *"), 12.0)]
    told = guard_text(MUDDY_STRETCH, analysis, change, TOPICS)
    assert told == "mud and 4.0 <= pos < 7.0"
    assert f"if {told}:" in rewrite(analysis, change, MUDDY_STRETCH, TOPICS)["node.py"]
    assert guard_text(Guard(), analysis, change, TOPICS) == ""


@pytest.mark.parametrize(
    ("text", "changes", "guard", "words"),
    [
        (
            "y = 5\n",
            [("5", 5, 5)],
            Guard((Conjunct(Sensor("seen"), 1, 1),)),
            "computed or observed by the test only",
        ),
        (
            "y = 5\n",
            [("5", 5, 7)],
            Guard((Conjunct(Sensor("seen", expr="lost"), 1, 1),)),
            r"\(expr=.lost.\) cannot be read",
        ),
        (
            "on = 1\ny = 5\n",
            [("5", 5, 7)],
            Guard((Conjunct(Sensor("seen", expr="on"), 1, 1),)),
            "makes the guard true",
        ),
        ("y = 6\n", [("6", 5, 5)], Guard(), "edited during the run, run again"),
        ("y = 5\n", [("5", 5, 7), ("5", 5, 8)], Guard(), "this code conflict"),
        ("match y:\n    case 5:\n        pass\n", [("5", 5, 7)], MUD, "no longer parse as Python"),
        ("y = = 5\n", [("5", 5, 7)], Guard(), "cannot be parsed as Python"),
    ],
)
def test_unwritable_change_is_refused_with_a_reason(
    text: str, changes: list[Any], guard: Guard, words: str
) -> None:
    analysis = HandMade({"node.py": text}, held={("/terrain", "data"): ("y",)})
    made = [Mutation(analysis.operand(code, value, code, literal=True), new) for code, value, new in changes]
    with pytest.raises(RepairError, match=words):
        rewrite(analysis, made, guard, TOPICS)


def test_file_outside_the_analysis_is_named() -> None:
    analysis = HandMade({"node.py": "y = 5\n"})
    change = Mutation(analysis.operand("5", 5, "5"), 7)
    with pytest.raises(RepairError, match=r"node\.py is not among the analysed files"):
        rewrite(HandMade({"other.py": ""}), [change], Guard(), TOPICS)


def test_rewriting_is_deterministic() -> None:
    analysis = HandMade({"node.py": TWO}, held=HELD)
    change = [Mutation(analysis.operand("5", 5, "5 *"), 2.5)]
    assert len({rewrite(analysis, change, MUDDY_STRETCH, TOPICS)["node.py"] for _ in range(5)}) == 1


# A generated program has statements over `a` and `b`, logs their effects, and has one literal 5 to change.
OPERAND = "5"
atoms = st.sampled_from(["a", "b", "2", "0.3", "log(a)", "log(b)"])
joins = st.sampled_from(["{} + {}", "{} - {}", "{} * {}", "({} + {})", "max({}, {})", "({} if a > {} else b)",
                         "-{} - {}", "abs({}) * {}", "{} * -{}", "log({}) + {}"])  # fmt: skip


def with_operand() -> st.SearchStrategy[str]:
    """Generate an expression that contains the operand once."""
    joined = st.tuples(joins, atoms, st.booleans())
    return st.lists(joined, max_size=4).map(_nested)


def _nested(joined: list[tuple[str, str, bool]]) -> str:
    code = OPERAND
    for template, other, left in joined:
        code = template.format(code, other) if left else template.format(other, code)
    return code


statements = st.sampled_from(
    [
        "a = {}", "a += {}", "a *= {}", "log({})", "return {}", "a, b = b, {}", "a = b = {}", "assert log({}) is not a",
        "if {} > b:\n    a = 1", "while {} > a and len(log) < 9:\n    a = log(a + 1)", "a = [{} for i in range(2)][0]",
        "a = (lambda b: {})(b)", "a = sum({} for i in range(2))", "a: float = {}", "b = 1; a = {}", "if b: a = {}",
        "for i in (a, {}):\n    b = i", "with log.held({}):\n    a = 1", "a = dict(k={})['k']",
        "a = f(\n    a,\n    {},\n    b)",
    ]
)  # fmt: skip


class Log(list[float]):
    """Log the argument of every call, to compare the order and number of evaluations."""

    def __call__(self, value: float) -> float:
        self.append(value)
        return value

    def held(self, value: float) -> Log:
        self.append(value)
        return self

    def __enter__(self) -> None: ...

    def __exit__(self, *_: object) -> None: ...


@settings(max_examples=150)
@given(
    statement=statements,
    expression=with_operand(),
    mud=st.booleans(),
    a=st.integers(-3, 3),
    b=st.integers(-3, 3),
)
def test_rewritten_program_is_unchanged_outside_the_condition(
    statement: str, expression: str, mud: bool, a: int, b: int
) -> None:
    text = program(statement.format(expression))
    analysis = HandMade({"node.py": text}, held=HELD)
    use = analysis.operand(OPERAND, 5, OPERAND)
    guarded = rewrite(analysis, [Mutation(use, 7.5)], MUD, TOPICS)["node.py"]
    expected = ast.unparse(Replace().visit(ast.parse(text))) if mud else text
    assert outcome(guarded, mud, a, b) == outcome(expected, mud, a, b)
    always = rewrite(analysis, [Mutation(use, 7.5)], Guard(), TOPICS)["node.py"]
    assert ast.dump(ast.parse(always)) == ast.dump(Replace().visit(ast.parse(text)))


class Replace(ast.NodeTransformer):
    """Replace the constant 5 by 7.5."""

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        return ast.Constant(7.5) if node.value == 5 and isinstance(node.value, int) else node


def program(statement: str) -> str:
    return f"def step(log, mud, a, b, f=max):\n{indent(statement, '    ')}\n    return a, b\n"


def outcome(text: str, mud: bool, a: int, b: int) -> Any:
    space: dict[str, Any] = {}
    exec(compile(text, "node.py", "exec"), space)
    log = Log()
    try:
        return space["step"](log, mud, a, b), list(log)
    except (AssertionError, OverflowError) as error:
        return type(error), list(log)


def test_rewritten_node_is_unchanged_until_the_condition_holds() -> None:
    text = dedent(
        """\
        import rospy
        from std_msgs.msg import Bool, Float64

        mud = None


        def on_mud(message):
            global mud
            mud = message.data


        rospy.init_node("n")
        rospy.Subscriber("/terrain", Bool, on_mud)
        pub = rospy.Publisher("/vel", Float64, queue_size=1)


        def step(delta):
            pub.publish(5 * delta)
        """
    )
    analysis = HandMade({"node.py": text}, held=HELD)
    changed = rewrite(analysis, [Mutation(analysis.operand("5", 5, "5 * delta"), 12.0)], MUD, TOPICS)
    ros = TinyRos()
    step = ros.run(changed, "node.py")["step"]
    step(1.0)
    ros.deliver("/terrain", type("Bool", (), {"data": True}))
    step(1.0)
    assert ros.published == [5.0, 12.0]


EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.mark.parametrize(
    "node", ["shuttle/traveller.py", "shuttle/traveller_swapped.py", "line_follower/line_follower.py"]
)
def test_every_constant_change_of_the_examples_accepts_a_condition(node: str) -> None:
    analysis = analyse([EXAMPLES / node], root=EXAMPLES)
    operands = [operand for step in analysis.sites for operand in analysis.operands(step.site)]
    assert len(operands) > 2
    for operand in operands:
        change = mutations(operand, 2.35, is_integral(analysis, operand))
        assert change is not None
        (text,) = rewrite(analysis, [change], MUDDY_STRETCH, TOPICS).values()
        assert f"if {guard_text(MUDDY_STRETCH, analysis, [change], TOPICS)}" in text


def test_delivery_robot_repair_has_the_expected_text() -> None:
    analysis = analyse([EXAMPLES / "shuttle" / "traveller.py"], root=EXAMPLES)
    (gain,) = (
        operand for step in analysis.sites for operand in analysis.operands(step.site) if operand.value == 5
    )
    (text,) = rewrite(analysis, [Mutation(gain, 12.0)], MUDDY_STRETCH, TOPICS).values()
    (before,) = analysis.sources.values()
    added = [line[2:] for line in ndiff(before.splitlines(), text.splitlines()) if line.startswith("+ ")]
    assert "\n".join(added) == dedent(
        """\
        from std_msgs.msg import Bool, Float64
        terrain = None


        def on_terrain(message):
            global terrain
            terrain = message.data
                if terrain and 4.0 <= pos < 7.0:
                    vel = 12.0 * delta
                else:
                    vel = 5 * delta
            rospy.Subscriber("/terrain", Bool, on_terrain)"""
    )
