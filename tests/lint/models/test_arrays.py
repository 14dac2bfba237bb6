"""Library calls whose result is not used fill lists and arrays that the program passes to them."""

from __future__ import annotations

import pytest

from tarl_lint import catalog
from tarl_lint.models.arrays import ARITHMETIC
from tests.lint.models.marked import differing, in_callback

HEAD = "import lib\nimport numpy as np\nimport numpy\nimport builtins"


def fills(made: str) -> str:
    return f"""
        array = {made}
        lib.evaluate(msg.data, array)
        out.publish(array[0])  # data
    """


@pytest.mark.parametrize("name", sorted(catalog.RESERVING))
def test_library_call_fills_an_empty_array(name):
    assert differing(in_callback(fills(f"{name}(4)"), HEAD)) == {}


@pytest.mark.parametrize("operator", sorted(ARITHMETIC))
def test_library_call_fills_an_array_computed_from_an_empty_array(operator):
    assert differing(in_callback(fills(f"np.ones(4) {operator} 2"), HEAD)) == {}


def test_a_comparison_does_not_make_an_array():
    body = fills("np.ones(4) < 2").replace("# data", "# clean")
    assert differing(in_callback(body, HEAD)) == {}


def test_computed_array_holds_data_but_its_empty_operand_does_not():
    body = """
        zeros = np.zeros(4)
        shifted = zeros + msg.data
        out.publish(shifted[0])  # data
        out.publish(zeros[0])  # clean
    """
    assert differing(in_callback(body, HEAD)) == {}


def test_library_call_fills_an_array_with_its_argument_data():
    body = """
        array, other = np.zeros(4), np.zeros(4)
        lib.evaluate(msg.data, into=array)
        out.publish(array[0])  # data
        lib.Model(msg.data).evaluate(other)
        out.publish(other[0])  # data
    """
    assert differing(in_callback(body, HEAD)) == {}


@pytest.mark.parametrize(
    "call",
    [
        "lib.save(msg.data, array)",
        "lib.Model(msg.data).draw(array)",
        "kept = lib.evaluate(msg.data, array)",
        "lib.evaluate(1.0, array)",
        "lib.evaluate(array)",
    ],
)
def test_call_without_data_leaves_an_array_empty(call):
    body = f"""
        array = np.zeros(4)
        {call}
        out.publish(array[0])  # clean
    """
    assert differing(in_callback(body, HEAD)) == {}


def test_the_arrays_of_earlier_iterations_are_also_filled():
    body = """
        kept = []
        for index in range(10):
            array = np.zeros(4)
            kept.append(array)
        lib.evaluate(kept[0], msg.data)
        out.publish(kept[0][0])  # data
    """
    assert differing(in_callback(body, HEAD)) == {}


def test_reading_call_may_still_fill_an_empty_list():
    body = """
        found, full = [], [0.0]
        lib.report(msg.data, found, full)
        out.publish(found[0])  # data
        out.publish(full[0])  # clean
    """
    assert differing(in_callback(body, HEAD)) == {}
