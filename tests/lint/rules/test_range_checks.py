"""What a statement or condition says about the range of a value, by its syntax."""

from __future__ import annotations

import ast

import pytest

from tarl_lint.rules.limits.range_checks import call_name, comparisons, computes, dotted, limits, side


def expression(text: str) -> ast.expr:
    return ast.parse(text, mode="eval").body


@pytest.mark.parametrize(
    ("test", "holds", "fails"),
    [
        ("x > 1", "above", "below"),
        ("x >= 1", "above", "below"),
        ("x < 1", "below", "above"),
        ("x <= 1", "below", "above"),
        ("1 < x", "above", "below"),
        ("1 > x", "below", "above"),
        ("-1 < x", "above", "below"),
        ("LIMIT >= x", "below", "above"),
        ("self.LIMIT < x", "above", "below"),
        ("math.pi < x", "above", "below"),
        ("np.inf > msg.x", "below", "above"),
        ("limit < x", "below", "above"),
        ("x < y", "below", "above"),
        ("LOW < HIGH", "below", "above"),
        ("not x > 1", "below", "above"),
        ("not not x > 1", "above", "below"),
        ("-(x > 1)", "both", "both"),
        ("x > 1 and y > 2", "above", "below"),
        ("x > 1 or y > 2", "above", "below"),
        ("x > 1 and y < 2", "both", "both"),
        ("x > 1 and ready", "above", "below"),
        ("ready and armed", "both", "both"),
        ("x == 1", "both", "both"),
        ("1 < x < 2", "both", "both"),
        ("x is None", "both", "both"),
        ("x", "both", "both"),
    ],
)
def test_bounded_side_of_a_value_is_determined(test, holds, fails):
    assert side(expression(test), holds=True) == holds
    assert side(expression(test), holds=False) == fails


@pytest.mark.parametrize(
    "statement",
    ["x = min(a, 1)", "x = np.clip(a, 0, 1)", "x = tanh(a)", "x = clamp(a)", "x = self.limit_speed(a)", "x = sat(a)",
     "x = my_sat(a)", "x = other(a)", "x = (lambda: a)()", "x = a % 2", "x = a > 1", "x = f'{a}'", "x.header = a",
     "x = T(stamp=a)", "x = a.width + 1", "x = table[int(a)]", "x = table[a.b]", "x = table[a + 1]",
     "x = self.table[a // 2]", "x = abs(min(a, 1))"],
)  # fmt: skip
def test_statements_that_limit_a_value_are_recognised(statement):
    assert limits(ast.parse(statement), frozenset({"mine"}))


@pytest.mark.parametrize(
    "statement",
    ["x = a", "x = 2 * a + 1", "x = abs(a)", "x = math.sqrt(a)", "x = Twist(a)", "x = Twist(linear=a)", "x = mine(a)",
     "x = table[0]", "x = table[i]", "x = msg.ranges[n // 2]", "x = ranges[len(ranges)]", "x = data[a.b]",
     "x.linear = a", "x = -a", "x = [a, *b]", "x = a if b else c"],
)  # fmt: skip
def test_statements_that_do_not_limit_a_value_are_recognised(statement):
    found = limits(ast.parse(statement), frozenset({"mine"}))
    assert found is ("len(" in statement), "the length of a list is limited"


@pytest.mark.parametrize(
    ("statement", "computed"),
    [("x = a + 1", True), ("x += 1", True), ("x = math.hypot(a, b)", True), ("x = dist(a, b)", True),
     ("x = abs(a)", False), ("x = a", False), ("x = float(a)", False), ("publish(a)", False),
     ("publish(2 * a)", True)],
)  # fmt: skip
def test_statements_that_compute_a_new_number_are_recognised(statement, computed):
    assert computes(ast.parse(statement)) is computed


@pytest.mark.parametrize(
    ("test", "count"),
    [("x > 1", 1), ("x > 1 and y == 2", 2), ("x is None", 0), ("x is not None and x > 1", 1), ("1 < x is y", 0),
     ("x", 0)],
)  # fmt: skip
def test_the_comparisons_in_a_condition_are_found(test, count):
    assert len(list(comparisons(expression(test)))) == count


@pytest.mark.parametrize(
    ("test", "names"),
    [
        ("msg.pose.x > 1", ["msg.pose.x"]),
        ("msg.x > LIMITS.FAR", ["msg.x"]),
        ("math.pi < msg.x", ["msg.x"]),
        ("numpy.linalg.inf < msg.x", ["msg.x", "numpy.linalg.inf"]),
        ("self.MAX > a.b", ["a.b"]),
        ("x > 1", []),
        ("abs(a.b) > c.d", ["c.d", "a.b"]),
    ],
)
def test_the_fields_in_a_condition_have_their_full_names(test, names):
    assert sorted(dotted(expression(test))) == sorted(names)


@pytest.mark.parametrize(
    ("call", "name"), [("f(x)", "f"), ("a.b.c(x)", "c"), ("f(x)(y)", ""), ("a[0](y)", "")]
)
def test_call_name_is_the_last_part_of_the_called_expression(call, name):
    found = expression(call)
    assert isinstance(found, ast.Call)
    assert call_name(found) == name
