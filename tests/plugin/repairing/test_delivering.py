"""What a repair reports about its edits."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from pytest_tarl.patching.definitions import Place
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.repairing.delivering import _edits
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate
from tests.plugin.searching.test_search import operand

NO_ORDER: Any = None  # edits of constants need no order


def test_uses_of_one_definition_share_the_edit_of_that_definition() -> None:
    low = replace(operand(5, "LIMIT", 1.0), definition=operand(1, "1.0", 1.0).span)
    high = replace(low, span=replace(low.span, column=low.span.column + 9))
    place = Place("node.py", 8, 11, 1, "LIMIT", 1.0)
    shared = Candidate((Mutation(low, 2.0, place), Mutation(high, 2.0, place)), ALWAYS)
    assert len(_edits(NO_ORDER, shared)) == 1
    apart = Candidate((Mutation(low, 2.0), Mutation(high, 2.0)), ALWAYS)
    assert len(_edits(NO_ORDER, apart)) == 2
