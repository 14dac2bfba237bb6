"""Calls with a deep stack."""

import sys

import pytest

from tarl_lint.run.deep_stack import HALF_A_CHUNK, MAX_RECURSION, with_deep_stack


def depth(left: int) -> int:
    return 0 if not left else 1 + depth(left - 1)


def test_deep_recursion_is_allowed_only_during_the_call():
    before = sys.getrecursionlimit()
    deep = MAX_RECURSION - 500
    assert with_deep_stack(lambda: depth(deep)) == deep
    assert sys.getrecursionlimit() == before


def test_the_limit_is_restored_after_an_error():
    before = sys.getrecursionlimit()
    with pytest.raises(ZeroDivisionError):
        with_deep_stack(lambda: 1 // 0)
    assert sys.getrecursionlimit() == before


def test_calls_with_deep_recursion_can_be_nested():
    assert with_deep_stack(lambda: with_deep_stack(lambda: depth(100))) == 100
    assert HALF_A_CHUNK * 8 <= 4 * 2**20  # bytes, mapped but not touched
