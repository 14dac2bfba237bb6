"""Checks during a run end it early if the verdict is certain, without raising the rate of false alarms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pytest_tarl.learning.drift import Difference, judged
from pytest_tarl.learning.sequential import Look, certain, concluded, planned
from pytest_tarl.model import Region, Verdict
from pytest_tarl.seeds import generator


def found(p_drift: float, p_loss: float, loss: float = 2.0, cells: int = 1) -> Difference:
    """Return possible findings of a check during a run, judged at 5 %."""
    verdict = judged(Verdict("no difference", p_drift, p_loss, loss, 1.0, 1.0), 0.05)
    return Difference(verdict, Region(tuple((i,) for i in range(cells))), {})


@pytest.mark.parametrize(("episodes", "looks"), [(40, 3), (40, 1), (200, 5), (12, 3), (3, 3)])
def test_checks_together_spend_all_of_alpha(episodes: int, looks: int) -> None:
    plan = planned(episodes, looks)
    assert plan[-1].episodes == episodes
    assert sum(look.share for look in plan) == pytest.approx(1.0)
    assert [look.episodes for look in plan] == sorted({look.episodes for look in plan})
    assert len(plan) <= looks


def test_forty_episodes_are_checked_after_ten_and_twenty() -> None:
    assert [look.episodes for look in planned(40, 3)] == [10, 20, 40]


def test_check_ends_the_run_once_loss_and_region_are_certain() -> None:
    assert certain(found(0.001, 0.001))
    assert not certain(found(0.001, 0.001, cells=0))
    assert not certain(found(0.001, 0.9))


def test_p_values_are_corrected_for_the_number_of_checks() -> None:
    seen = [(Look(20, 0.25), found(0.5, 0.02)), (Look(40, 0.75), found(0.3, 0.03))]
    verdict = concluded(seen, 0.05).verdict
    assert verdict.p_loss == pytest.approx(0.04)
    assert verdict.p_drift == pytest.approx(0.4)
    assert verdict.result == "degraded"
    assert (
        concluded([(one, replace(found(0.3, 0.04))) for one, _ in seen], 0.05).verdict.result
        == "no difference"
    )


def test_several_checks_keep_the_false_alarm_rate() -> None:
    """Without a difference, p-values are uniform; here they are correlated like those of growing samples."""
    draws = generator(0, "looks")
    plan = planned(40, 3)
    alarms = 0
    for _ in range(4000):
        steps = np.cumsum(draws.standard_normal(40))
        ranks = [_upper_tail(steps[look.episodes - 1] / np.sqrt(look.episodes)) for look in plan]
        seen = [(look, found(1.0, p)) for look, p in zip(plan, ranks, strict=True)]
        ended = next((i for i, (look, one) in enumerate(seen) if one.verdict.p_loss < 0.05 * look.share), 2)
        alarms += concluded(seen[: ended + 1], 0.05).verdict.result == "degraded"
    assert 0.03 < alarms / 4000 < 0.055


def _upper_tail(z: float) -> float:
    from statistics import NormalDist

    return 1 - NormalDist().cdf(float(z))
