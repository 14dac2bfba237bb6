"""The names of library methods tell whether they change their object."""

from __future__ import annotations

import pytest

from tarl_lint.method_effects import changes


@pytest.mark.parametrize("name", ["addstr", "addnstr", "addch", "insstr", "insnstr", "send", "get_data"])
def test_methods_that_only_show_arguments_change_nothing(name: str) -> None:
    assert not changes(name, dropped=True)


@pytest.mark.parametrize("name", ["add", "addItem", "insert", "inspect", "append_row", "fuse"])
def test_methods_without_a_used_result_change_their_object(name: str) -> None:
    assert changes(name, dropped=True)
