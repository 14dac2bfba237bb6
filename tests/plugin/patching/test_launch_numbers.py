"""Numbers of Python launch files that determine a parameter, and the share of it that each number determines."""

from __future__ import annotations

import ast

import pytest

from pytest_tarl.patching.launch_numbers import DEEPEST, computed, numerals


def found(text: str, key: str = "gain") -> list[tuple[str, object, float]]:
    """Return each number as it is written, its value and its share."""
    return [
        (ast.unparse(one.node), one.value, pytest.approx(one.share)) for one in numerals(key, ast.parse(text))
    ]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('{"gain": 2.5}', [("2.5", 2.5, 1.0)]),
        ('{"gain": -2}', [("-2", -2, 1.0)]),
        ('{"gain": "3"}', [("'3'", 3, 1.0)]),
        ('{"gain": " +3 "}', [("' +3 '", 3, 1.0)]),
        ('{"gain": "-1.5e1"}', [("'-1.5e1'", -15.0, 1.0)]),
        ('{"gain": ".5"}', [("'.5'", 0.5, 1.0)]),
        ('{"gain": "2."}', [("'2.'", 2.0, 1.0)]),
        ('{"gain": True}', [("True", True, 1.0)]),
        ('{"gain": "False"}', [("'False'", False, 1.0)]),
        ('{"gain": " true"}', [("' true'", True, 1.0)]),
        ("dict(gain=4)", [("4", 4, 1.0)]),
        ('SetParameter("gain", 4)', [("4", 4, 1.0)]),
        ('SetParameter(value=4, name="gain")', [("4", 4, 1.0)]),
        ('{"/robot/gain": 4}', [("4", 4, 1.0)]),
        ('{"arm.gain": 4}', [("4", 4, 1.0)]),
        ('{"~gain": 4}', [("4", 4, 1.0)]),
        ('{"gain": [4]}', [("4", 4, 1.0)]),
        ('{"gain": float("4")}', [("'4'", 4, 1.0)]),
        ('{"gain": ParameterValue(4, value_type=float)}', [("4", 4, 1.0)]),
        ("base = 3.0\n{'gain': base}", [("3.0", 3.0, 1.0)]),
        ("base: float = 3.0\n{'gain': base}", [("3.0", 3.0, 1.0)]),
        ("base = 3.0\n{'gain': -base}", [("3.0", 3.0, 1.0)]),
        ("DeclareLaunchArgument('k', default_value='4')\n{'gain': LaunchConfiguration('k')}", [("'4'", 4, 1.0)]),
        ("l.DeclareLaunchArgument(name='k', default_value='4')\n{'gain': l.LaunchConfiguration(variable_name='k')}",
         [("'4'", 4, 1.0)]),
        ("DeclareLaunchArgument('k', '4')\n{'gain': float(LaunchConfiguration('k'))}", [("'4'", 4, 1.0)]),
    ],
)  # fmt: skip
def test_number_that_is_the_whole_parameter_has_share_one(
    text: str, expected: list[tuple[str, object, float]]
) -> None:
    assert found(text) == expected
    assert list(computed("gain", ast.parse(text))) == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        # 2 · 3: either factor moves all of it
        ("base = 3.0\n{'gain': 2 * base}", [("2", 2, 1.0), ("3.0", 3.0, 1.0)]),
        # 3 + 1: to double the sum, 3 must become 7 (1 + 4/3 times as large) and 1 must become 5
        ("base = 3.0\n{'gain': base + 1}", [("1", 1, 4.0), ("3.0", 3.0, 4 / 3)]),
        # 3 - 1: to double the difference, 3 must become 5 and 1 must become -1
        ("base = 3.0\n{'gain': base - 1}", [("1", 1, -2.0), ("3.0", 3.0, 2 / 3)]),
        # 6 / 2: the divisor is not linear
        ("{'gain': 6.0 / 2}", [("6.0", 6.0, 1.0)]),
        # x · x is not linear in x
        ("x = 2.0\n{'gain': x * x}", []),
        ("x = 2.0\n{'gain': x + x}", [("2.0", 2.0, 1.0)]),
        # nearer numbers come first
        ("a = 5.0\nb = 2 * a\n{'gain': b * 3}", [("3", 3, 1.0), ("2", 2, 1.0), ("5.0", 5.0, 1.0)]),
        ("{'gain': 2.0 - 2.0}", []),
        ("{'gain': 0.0}", []),
        ("{'gain': 0.0 + 3.0}", [("3.0", 3.0, 1.0)]),
    ],
)
def test_share_is_the_relative_change_that_doubles_the_parameter(
    text: str, expected: list[tuple[str, object, float]]
) -> None:
    assert found(text) == expected


@pytest.mark.parametrize(
    "expression",
    [
        "other", "'fast'", "'3 m'", "None", "7 // 2", "7 % 2", "2 ** 3", "1 / 0", "[1, 2]", "f(3)", "-True",
        "LaunchConfiguration('absent')", "LaunchConfiguration(name)", "float()", "x.y", "not 3", "+other",
    ],
)  # fmt: skip
def test_an_expression_without_a_number_to_change_is_computed(expression: str) -> None:
    tree = ast.parse(f"{{'gain': {expression}}}")
    assert found(f"{{'gain': {expression}}}") == []
    (one,) = computed("gain", tree)
    assert ast.unparse(one) == ast.unparse(ast.parse(expression, mode="eval"))


@pytest.mark.parametrize(
    "text",
    [
        "base = 3.0\nbase = 4.0\n{'gain': base}",
        "base = 3.0\nbase += 1.0\n{'gain': base}",
        "base = 3.0\nfor base in (1, 2): pass\n{'gain': base}",
        "base = 3.0\ndef f(base): pass\n{'gain': base}",
        "base, other = 3.0, 4.0\n{'gain': base}",
        "base: float\n{'gain': base}",
        "a = base = 3.0\n{'gain': base}",
        "DeclareLaunchArgument('k', 4), DeclareLaunchArgument('k', 5)\n{'gain': LaunchConfiguration('k')}",
        "DeclareLaunchArgument('k')\n{'gain': LaunchConfiguration('k')}",
    ],
)
def test_ambiguous_name_leads_to_no_number(text: str) -> None:
    assert found(text) == []


@pytest.mark.parametrize(
    "text",
    ['{"again": 4}', '{"gain.x": 4}', "{gain: 4}", "{**gain}", "f(gain=4)", 'Set("gain", 4)', "{4: 4}"],
)
def test_other_parameters_are_not_changed(text: str) -> None:
    assert found(text) == []
    assert list(computed("gain", ast.parse(text))) == []


def test_equal_parameters_come_in_file_order() -> None:
    text = "n = [dict(gain=1), {'gain': 2}]\nm = [SetParameter('gain', 3), {'gain': f()}, {'gain': 4}]"
    assert [value for _, value, _ in found(text)] == [1, 2, 3, 4]
    assert [ast.unparse(one) for one in computed("gain", ast.parse(text))] == ["f()"]


@pytest.mark.parametrize(("names", "reached"), [(DEEPEST, True), (DEEPEST + 1, False)])
def test_number_is_found_through_few_names(names: int, reached: bool) -> None:
    chain = "".join(f"n{at} = n{at + 1}\n" for at in range(names - 1))
    assert bool(found(f"{chain}n{names - 1} = 3.0\n{{'gain': n0}}")) is reached
