"""Numbers of PyKDL values, and the vectors that several tests use."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.ros.kdl import Vector

A, B = Vector(1.0, 2.0, 3.0), Vector(-4.0, 0.5, 6.0)


def numbers(values: Any) -> list[float]:
    return [*values]


def near(*values: float) -> Any:
    return pytest.approx(list(values), abs=1e-9)
