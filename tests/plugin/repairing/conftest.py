"""Settings for tests of repairs."""

from __future__ import annotations

import pytest


@pytest.fixture
def quick_acceptance(monkeypatch: pytest.MonkeyPatch) -> None:
    """Accept a repair after 8 paired episodes, for tests of its contents and not of its certainty."""
    for module in ("searching.accept", "repairing.accepting"):
        monkeypatch.setattr(f"pytest_tarl.{module}.SEEDS", 16)
    monkeypatch.setattr("pytest_tarl.searching.accept.EARLY", ())
    monkeypatch.setattr("pytest_tarl.searching.accept.LOOKS", (8,))
    monkeypatch.setattr("pytest_tarl.repairing.accepting.risk_of", lambda alpha, before: 0.9)
