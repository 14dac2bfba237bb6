import ast
import tracemalloc
from textwrap import dedent

import pytest

from tarl_lint.ir.control_dependence import NEAR, control_dependence
from tarl_lint.ir.lower_statements import lower_module
from tarl_lint.read.source import Module
from tests.lint.analysing import analysed, steps


def dependence(text: str) -> dict[int, set[tuple[int, str]]]:
    """Return for each line the branches (line, outcome) on which it depends."""
    text = dedent(text).strip()
    body = lower_module(Module("m.py", "m", text, ast.parse(text))).body
    lines: dict[int, int] = {}

    def number(statements: object) -> None:
        for s in statements:  # type: ignore[attr-defined]
            lines[s.id] = s.pos[0]
            for inner in ("body", "orelse", "final"):
                number(getattr(s, inner, ()))
            for _, _, handler in getattr(s, "handlers", ()):
                number(handler)

    number(body)
    control = control_dependence(body)
    return {lines[n]: {(lines[b], way) for b, way in branches} for n, branches in control.direct.items()}


def test_both_branches_depend_on_the_condition_but_later_code_does_not():
    found = dependence("""
        if a:
            b()
        else:
            c()
        d()
    """)
    assert (found[2], found[4], found[5]) == ({(1, "then")}, {(1, "else")}, set())


def test_statements_after_a_loop_do_not_depend_on_it():
    found = dependence("""
        while a:
            b()
        c()
    """)
    assert (found[1], found[2], found[3]) == ({(1, "body")}, {(1, "body")}, set())


def test_loop_body_after_an_exit_depends_on_the_exit_condition():
    found = dependence("""
        while True:
            if a:
                break
            b()
        c()
    """)
    assert (found[4], found[5]) == ({(2, "else")}, set())


@pytest.mark.parametrize("leave", ["return", "raise E"])
def test_statements_after_an_early_return_depend_on_its_condition(leave):
    found = dependence(f"""
        if a:
            {leave}
        b()
    """)
    assert found[3] == {(1, "else")}


def test_a_handler_depends_on_the_condition_of_the_raise():
    found = dependence("""
        try:
            if a:
                raise E
            b()
        except E:
            c()
        d()
    """)
    assert (2, "then") in found[6]
    assert (2, "else") in found[4]
    assert found[7] == set()


def test_loop_body_after_a_continue_depends_on_its_condition():
    found = dependence("""
        for x in y:
            if x:
                continue
            b()
    """)
    assert found[4] == {(2, "else")}


def test_an_endless_loop_without_an_exit_is_analysed():
    found = dependence("""
        while True:
            a()
    """)
    assert 2 in found


def test_each_of_many_nested_conditions_is_among_the_steps(tmp_path):
    arms = "".join(f"    {'el' if n else ''}if k == {n}:\n        v = {n}\n" for n in range(300))
    head = "import rospy\ndef on(msg):\n    k = msg.data\n    v = 0\n"
    tail = "    out.publish(v)\nout = rospy.Publisher('a', F)\nrospy.Subscriber('b', F, on)\n"
    (flow,) = analysed(tmp_path, node=head + arms + tail).flows
    control = steps(flow, "control")
    assert all(f"{'el' if n else ''}if k == {n}:" in control for n in range(300))
    assert all(f"v = {n}" in control for n in range(300))


def test_each_statement_stores_a_bounded_number_of_conditions():
    source = "".join(f"{'el' if n else ''}if k == {n}:\n    v = {n}\n" for n in range(400))
    body = lower_module(Module("m.py", "m", source, ast.parse(source))).body
    control = control_dependence(body)
    assert max(map(len, control.closure.values())) <= 2 * NEAR
    assert control.far


def test_control_dependences_need_linear_memory():
    body = ast.parse("x = 0\n" + "if x:\n    x = 1\n" * 5_000)
    program = lower_module(Module("node.py", "node", "", body))
    tracemalloc.start()
    try:
        control = control_dependence(program.body)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert len(control.always) == 5_001
    assert most < 1_000 * 10_001
