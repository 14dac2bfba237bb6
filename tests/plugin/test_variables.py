"""Expressions that read a variable of a node."""

from __future__ import annotations

import pytest

from pytest_tarl.variables import prefixes


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("speed", ("speed",)),
        ("self.pose.x", ("self", "self.pose", "self.pose.x")),
        ("self.state['yaw'].low", ("self", "self.state", "self.state['yaw']", "self.state['yaw'].low")),
        ("ranges[0]", ("ranges", "ranges[0]")),
        ("speed # in m/s", ("speed",)),
        ("ranges[i]", ()),
        ("ranges[1:2]", ()),
        ("self.read().x", ()),
        ("2.0", ()),
        ("a + b", ()),
        ("", ()),
        ("a)(b", ()),
        ("a\0", ()),
    ],
)
def test_the_prefixes_of_a_variable_are_found(code: str, expected: tuple[str, ...]) -> None:
    assert prefixes(code) == expected
