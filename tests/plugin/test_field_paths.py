"""Fields of messages: dotted paths, and indices as in Python."""

from __future__ import annotations

from array import array
from types import SimpleNamespace

import numpy as np
import pytest

from pytest_tarl import Signal, faults
from pytest_tarl.field_paths import dotted, field_value


def test_fields_are_followed_through_attributes_items_and_indices() -> None:
    message = SimpleNamespace(pose=SimpleNamespace(x=2.0), ranges=[5.0, 6.0])
    assert field_value(message, "pose.x") == 2.0
    assert field_value(message, "ranges.1") == 6.0
    assert field_value({"a": {"b": 3}}, "a.b") == 3


def test_a_field_indexes_arrays_of_any_kind() -> None:
    assert field_value({"ranges": np.array([1.0, 2.0])}, "ranges.1") == 2.0
    assert field_value({"ranges": array("d", [1.0, 2.0])}, "ranges.-1") == 2.0


@pytest.mark.parametrize(
    ("field", "path"),
    [
        ("ranges[60]", "ranges.60"),
        ("poses[-1].position.x", "poses.-1.position.x"),
        ("rows[ 1 ][2]", "rows.1.2"),
        ("[0].x", "0.x"),
        ("twist.linear.x", "twist.linear.x"),
        ("rows[i]", "rows[i]"),
    ],
)
def test_bracketed_index_becomes_a_path_part(field: str, path: str) -> None:
    assert dotted(field) == path


def test_signals_and_faults_take_indices_as_in_python() -> None:
    assert Signal("ahead", topic="/scan", field="ranges[2]").field == "ranges.2"
    assert faults.scale("/scan", "ranges[2]", 0.5, 1.5).field == "ranges.2"
    assert faults.swapped("/odom", "rows[0]", "rows[1]").field == "rows.0, rows.1"
