"""The evidence of several processes, relative to their shares of alpha, worked out by hand."""

from __future__ import annotations

from math import log10
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.monitoring import status as module
from pytest_tarl.monitoring.status import Moment, _evidence


def evidence(monkeypatch: pytest.MonkeyPatch, alarm: list[int], age: int = 9) -> Any:
    """Return the evidence of processes 1 and 2, whose alarms ring at 8 times and 4 times the evidence of 1 / alpha."""
    processes = SimpleNamespace(
        threshold=np.array([99.0, 5.0, 4.0]),
        peak=np.array([50.0, 4.0, 3.5]),
        onset=np.array([77, 5, 6]),
        age=np.array([9, age, age]),
        alarm=np.array([0, *alarm]),
    )
    monkeypatch.setattr(module.restarts, "log_evidence", lambda _: np.array([60.0, 2.0, 3.0]))
    monitor: Any = SimpleNamespace(
        processes=processes, alpha=0.25, moments=SimpleNamespace(at=lambda number: 10.0 * number)
    )
    return _evidence(monitor, np.array([1, 2]))


def test_evidence_is_the_largest_in_units_of_each_share_and_its_onset_is_that_of_the_highest(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = evidence(monkeypatch, [-1, -1])
    assert found.now == pytest.approx(log10(2.0 ** (3.0 - 2.0)))
    assert found.highest == pytest.approx(log10(2.0 ** (3.5 - 2.0)))
    assert found.since == Moment(7, 60.0)
    assert found.alarm is None
    assert evidence(monkeypatch, [-1, -1], age=0).since is None


@pytest.mark.parametrize(
    ("alarm", "mission"), [([4, 7], 5), ([-1, 7], 8), ([0, 3], 1), ([-1, 0], 1), ([3, -1], 4)]
)
def test_the_earliest_alarm_counts_even_if_it_is_at_the_first_mission(
    monkeypatch: pytest.MonkeyPatch, alarm: list[int], mission: int
) -> None:
    assert evidence(monkeypatch, alarm).alarm == Moment(mission, 10.0 * (mission - 1))
