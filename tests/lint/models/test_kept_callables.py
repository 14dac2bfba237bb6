"""Objects of unknown libraries may call the functions that they were given, whichever way they got them."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, in_callback

HEAD = """
import gadgets
limit = [0.0]

def cost(x):
    return x * limit[0]

def plain(x):
    return x * 2.0
"""


@pytest.mark.parametrize(
    "body",
    [
        """
        limit[0] = msg.data
        solver = gadgets.Solver(cost)
        out.publish(solver.solve(1.0))  # data
        """,
        """
        limit[0] = msg.data
        solver = gadgets.Solver(plain)
        out.publish(solver.solve(1.0))  # clean
        """,
        """
        limit[0] = msg.data
        solver = gadgets.Solver()
        solver.set_cost(cost)
        out.publish(solver.solve(1.0))  # data
        """,
        """
        limit[0] = msg.data
        solver, other = gadgets.Solver(), gadgets.Solver()
        other.set_cost(cost)
        out.publish(solver.solve(1.0))  # clean
        out.publish(other.solve(1.0))  # data
        """,
        """
        limit[0] = msg.data
        solver = gadgets.Solver()
        solver.set_cost(plain)
        solver.set_cost(cost)
        out.publish(solver.solve(1.0))  # data
        """,
    ],
)
def test_later_results_include_results_of_stored_functions(body: str) -> None:
    assert differing(in_callback(body, HEAD)) == {}
