"""The line of the accepted repair is shown with the gain of the repair, however the search found it."""

from __future__ import annotations

import pytest

from pytest_tarl.model import OperandEffect
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.repairing.confirmed_effects import gaining, with_confirmed
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_search import operand

KP = operand(3, "0.8", 0.8)
SITE = str(KP.site)


def effect(code: str, best: float, gain: float) -> OperandEffect:
    return OperandEffect(code, 0.8, best, gain)


@pytest.mark.parametrize(
    ("known", "shown"),
    [
        ({}, [("0.8", 4.0, 5.0)]),
        ({SITE: [effect("0.8", 0.32, 0.0)]}, [("0.8", 4.0, 5.0)]),
        ({SITE: [effect("0.8", 4.0, 0.0)]}, [("0.8", 4.0, 5.0)]),
        ({SITE: [effect("0.8", 4.01, 3.0)]}, [("0.8", 4.01, 3.0)]),
        ({SITE: [effect("LIMIT", 2.0, 1.0)]}, [("0.8", 4.0, 5.0), ("LIMIT", 2.0, 1.0)]),
    ],
)
def test_repair_gain_is_shown_even_if_unmeasured(
    known: dict[str, list[OperandEffect]], shown: list[tuple[str, float, float]]
) -> None:
    candidate = Candidate(Unit((KP,)).mutations(mutations, 5.0), ALWAYS)
    found = with_confirmed({"other": [effect("X", 1.0, 2.0)], **known}, candidate, [6.0, 8.0], [1.0, 3.0])
    assert [(one.code, one.best, one.effect) for one in found[SITE]] == shown
    assert found["other"][0].code == "X"


def test_joint_change_is_not_the_effect_of_one_line() -> None:
    several = Candidate(Unit((KP, operand(5, "2.0", 2.0))).mutations(mutations, 5.0), ALWAYS)
    assert with_confirmed({}, several, [6.0], [1.0]) == {}


def test_structural_changes_that_gain_rank_their_statement() -> None:
    plain, better, worse = (
        effect("0.8", 1.0, 0.0),
        effect("gain of x", 2.0, 3.0),
        effect("sign of x", 1.0, -1.0),
    )
    found = gaining({SITE: [plain]}, {SITE: [better, worse], "other": [better], "none": [worse]})
    assert found == {SITE: (plain, better), "other": (better,)}
    assert gaining(found, {SITE: [better]}) == found  # a change is listed once
