"""The statements that compute a value are found from the nearest one back."""

from __future__ import annotations

import ast

import pytest

from pytest_tarl.patching.document import Document, parse
from pytest_tarl.patching.written_by import writers

TEXT = """\
LEAST = 0.1

class Pilot:
    def step(self, error):
        far = 2 * error
        if far > 0.5:
            self.cmd.angular.z = min(far, 1.5)
            self.cmd.linear.x = 0.3
        else:
            turn, _ = max(abs(error), 0.1), far
            self.cmd.angular.z = turn
        self.pub.publish(self.cmd)

    def stop(self):
        self.cmd.angular.z = 0.0
"""


@pytest.mark.parametrize(
    ("code", "lines"),
    [
        ("self.cmd.angular.z", [7, 11, 5, 10]),
        ("self.cmd.linear.x", [8]),
        ("far", [5]),
        ("error", []),
        ("self.pub", []),
    ],
)
def test_the_statements_that_compute_a_field_are_found(code: str, lines: list[int]) -> None:
    source = Document("pilot.py", TEXT, parse(TEXT))
    node = next(
        one
        for one in ast.walk(source.tree)
        if isinstance(one, ast.expr) and ast.unparse(one) == "self.cmd" and one.lineno == 12
    )
    assert [one.lineno for one in writers(source, node, code)] == lines


def test_a_value_at_the_top_level_has_no_statements() -> None:
    source = Document("pilot.py", TEXT, parse(TEXT))
    node = next(one for one in ast.walk(source.tree) if isinstance(one, ast.Constant))
    assert writers(source, node, "LEAST") == []
