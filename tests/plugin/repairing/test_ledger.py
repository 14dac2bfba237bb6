"""The ledger of examined candidates, and which refused candidate came furthest."""

from __future__ import annotations

from dataclasses import replace

from pytest_tarl.repairing.ledger import Ledger, Refused, Tried, furthest
from tests.plugin.repairing.test_results import OTHER, WET, scaled


def test_ledger_knows_examined_values() -> None:
    ledger = Ledger()
    ledger.enter(Tried(scaled(2.0), "not shown", ()))
    ledger.enter(Tried(scaled(3.0, WET), "not shown", ()))
    assert ledger.examined(scaled(2.0))
    assert ledger.examined(scaled(3.0, WET))
    for unknown in (scaled(3.0), scaled(2.0, WET), scaled(2.0, of=OTHER), scaled(2.05)):
        assert not ledger.examined(unknown)
    assert not Ledger().examined(scaled(2.0))


def test_refused_candidate_with_more_worlds_is_reported() -> None:
    nothing, low = Refused(None, "budget"), Refused(scaled(2.0), "not shown", 1.0, 5)
    high = Refused(scaled(3.0), "gain too small", 2.0, 5)
    drifted, both = (
        Refused(scaled(4.0), "nominal gets worse"),
        Refused(scaled(5.0), "another test gets worse"),
    )
    assert furthest(nothing, low) is furthest(low, nothing) is low
    assert furthest(low, high) is furthest(high, low) is high
    assert furthest(high, drifted) is furthest(drifted, high) is drifted
    assert furthest(both, drifted) is furthest(drifted, both) is both
    assert furthest(low, replace(low, episodes=9)) is low
