"""Definitions of messages that ROS refuses are named; values that only look wrong are read."""

from __future__ import annotations

import pytest

from pytest_tarl.errors import UnsupportedApiError
from pytest_tarl.ros.messages.type_definitions import parse


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("int32 A = x", r"arm/State: the constant `int32 A=x` has no value of its type"),
        ("float64 G =", r"arm/State: the constant `float64 G=` has no value of its type"),
        ("bool B =", r"arm/State: the constant `bool B=` has no value of its type"),
        ("Pose P = 1", r"arm/State: the constant `Pose P=1` has no value of its type"),
        ("float64", r"arm/State: `float64` is neither a field nor a constant"),
    ],
)
def test_an_invalid_line_is_named_with_its_message(line: str, reason: str) -> None:
    with pytest.raises(UnsupportedApiError, match=reason):
        parse("ros1", "arm", "State", f"bool ok\n{line}\n")


@pytest.mark.parametrize("line", ["int32 speed fast", "float64[2] gains [1.0, x]", "Pose home 1"])
def test_default_of_the_wrong_type_is_named_with_its_message(line: str) -> None:
    with pytest.raises(UnsupportedApiError) as raised:
        parse("ros2", "arm", "State", f"bool ok true\n{line}\n")
    assert f"arm/State: the default in `{line}` is no value of its type" in str(raised.value)


@pytest.mark.parametrize(("text", "value"), [("010", 10), ("0x10", 16), ("-08", -8), ("-0x1F", -31)])
def test_whole_numbers_may_have_leading_zeros(text: str, value: int) -> None:
    (constant,) = parse("ros1", "arm", "State", f"int32 A = {text}\n").constants
    assert constant.value == value
