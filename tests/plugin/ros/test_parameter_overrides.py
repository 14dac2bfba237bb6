"""The parameters of one node, selected from values for several nodes."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.ros.rclpy.parameter_overrides import overrides

GAINS = {"gain": 2.0, "pid": {"kp": 1.0}}
FLAT = {"gain": 2.0, "pid.kp": 1.0}


@pytest.mark.parametrize(
    ("given", "node", "expected"),
    [
        (GAINS, "/pilot", FLAT),
        ({"pilot": {"ros__parameters": GAINS}}, "/pilot", FLAT),
        ({"/pilot": {"ros__parameters": GAINS}}, "/pilot", FLAT),
        ({"pilot": {"ros__parameters": GAINS}}, "/left/pilot", FLAT),
        ({"left": {"pilot": {"ros__parameters": GAINS}}}, "/left/pilot", FLAT),
        ({"left": {"pilot": {"ros__parameters": GAINS}}}, "/right/pilot", {}),
        ({"/left/pilot": {"ros__parameters": GAINS}}, "/left/pilot", FLAT),
        ({"/**": {"ros__parameters": GAINS}}, "/left/pilot", FLAT),
        ({"/**/pilot": {"ros__parameters": GAINS}}, "/left/pilot", FLAT),
        ({"/*/pilot": {"ros__parameters": GAINS}}, "/pilot", {}),
        ({"guard": {"ros__parameters": GAINS}}, "/pilot", {}),
        ({"pilot": GAINS}, "/pilot", FLAT),
        ({"**": GAINS}, "/pilot", FLAT),
        ({"pilot:gain": 3.0, "guard:gain": 4.0, "~rate": 10}, "/pilot", {"gain": 3.0, "rate": 10}),
        ({"/global": 1, "gain": 2.0}, "/pilot", {"gain": 2.0}),
        (
            {"/**": {"ros__parameters": {"gain": 1.0}}, "pilot": {"ros__parameters": {"gain": 2.0}}},
            "/pilot",
            {"gain": 2.0},
        ),
        ({"pilot": {"ros__parameters": None}}, "/pilot", {}),
    ],
)
def test_node_gets_the_parameters_meant_for_it(
    given: dict[str, Any], node: str, expected: dict[str, Any]
) -> None:
    assert overrides(given, node) == expected
