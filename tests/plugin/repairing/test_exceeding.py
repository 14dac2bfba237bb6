"""A repair that earns more than designed does more than undo the drift, and the report says so."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.repairing.exceeding import exceeding

DESIGNED = tuple(np.random.default_rng(0).normal(1.0, 0.1, 60))
SAME = tuple(np.random.default_rng(1).normal(1.0, 0.1, 40))


def compared(**changes: Any) -> Any:
    given = {"drift": "mud", "permanent": False, "verdict": SimpleNamespace(tolerance=0.1)} | changes
    return SimpleNamespace(**given)


def totals(gain: float, nominal_gain: float) -> dict[str, tuple[float, ...]]:
    return {
        "offline": DESIGNED,
        "repaired": tuple(one + gain for one in SAME),
        "nominal_repaired": tuple(one + nominal_gain for one in SAME),
    }


def test_repair_that_only_compensates_gets_no_note() -> None:
    assert exceeding(compared(), totals(0.0, 0.0)) == []
    assert exceeding(compared(), totals(0.08, 0.08)) == []  # within the tolerance
    assert (
        exceeding(compared(), {**totals(0.0, 0.0), "nominal_repaired": (9.0,)}) == []
    )  # one episode shows nothing


@pytest.mark.parametrize(("permanent", "world"), [(False, "designed world"), (True, "old world")])
def test_repair_that_earns_more_as_designed_is_named(permanent: bool, world: str) -> None:
    (note,) = exceeding(compared(permanent=permanent), totals(0.4, 0.4))
    assert note.startswith(f"in the {world} the repaired node earns 1.4")
    assert "more than the 1.0" in note


def test_repair_that_earns_more_under_drift_is_named() -> None:
    (note,) = exceeding(compared(), totals(0.4, 0.0))
    assert note.startswith("in the drift scenario 'mud' the repaired node earns")
