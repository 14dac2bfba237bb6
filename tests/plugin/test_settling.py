"""When a recording ends, and what it says about too many failures."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.designation import Designation
from pytest_tarl.errors import RecordingError
from pytest_tarl.settling import ENOUGH_FAILURES, MOST, Settling, within


def mission(passed: bool, total: float = 1.0) -> Any:
    return SimpleNamespace(passed=np.array([passed]), seeds=(7,), total=np.array([total]))


def designated(**given: Any) -> Designation:
    return Designation(("node.py",), (), **given)


def run(settling: Settling, results: str) -> int | None:
    """Run missions, `.` for a success and `F` for a failure; return the number of the one after which it stops."""
    samples: list[Any] = []
    for number, result in enumerate(results, 1):
        samples.append(mission(result == "."))
        if settling(samples):
            return number
    return None


def test_without_a_confidence_a_recording_runs_all_its_episodes() -> None:
    settling = Settling(designated(), 20)
    assert settling.most == 20
    assert run(settling, "." * 20) is None
    assert (settling.episodes, settling.passed, settling.failing) == (20, 20, "")


@pytest.mark.parametrize(
    ("least", "asked", "results", "stops"),
    [
        (1.0, 20, "FFFF" + "." * 16, None),
        (1.0, 20, "FFFFF", 5),  # five failures, although one is too many
        (0.5, 20, "F" * 10 + "." * 10, None),
        (0.5, 20, "F" * 11, 11),
        (0.9, 100, "F" * 10, None),  # 100 · (1 - 0.9) is a little less than ten as a float
        (0.9, 100, "F" * 11, 11),
    ],
)
def test_a_recording_stops_once_too_many_episodes_fail(
    least: float, asked: int, results: str, stops: int | None
) -> None:
    settling = Settling(designated(min_success=least), asked)
    assert run(settling, results) == stops
    assert bool(settling.failing) == (results.count("F") > round(asked * (1 - least)))
    assert ENOUGH_FAILURES == 5


def test_error_states_how_many_episodes_were_not_run() -> None:
    settling = Settling(designated(), 20)
    run(settling, ".FFFFF")
    assert settling.failing == (
        "5 of the first 6 episodes failed (success 16.6 %, min_success 100 %; the other 14 were not run)"
    )
    settling = Settling(designated(min_success=0.8), 5)
    run(settling, "..FF.")
    assert settling.failing == "2 of 5 episodes failed (success 60 %, min_success 80 %)"


def test_a_confidence_allows_more_episodes() -> None:
    assert Settling(designated(confidence=0.95), 20).most == MOST
    assert Settling(designated(confidence=0.95), MOST + 1).most == MOST + 1


def test_confidence_recording_ends_when_the_rate_is_shown() -> None:
    sure = designated(min_success=0.5, confidence=0.95)
    # all of n missions succeed: the evidence is (2ⁿ⁺¹ - 1) / (n + 1), which reaches 20 at n = 7
    assert run(Settling(sure, 2), "." * 20) == 7
    assert run(Settling(sure, 12), "." * 20) == 12
    assert run(Settling(sure, 2), "F" * 20) == 7  # all of them fail, which refutes the rate
    assert run(Settling(sure, 12), "F" * 20) == 7
    assert run(Settling(sure, 2), ".F" * 10) is None


def test_summary_states_the_recording_confidence() -> None:
    sure = designated(min_success=0.5, confidence=0.95)
    told = {}
    for results in ("F" * 7, "." * 7, ".F"):
        settling = Settling(sure, 2)
        run(settling, results)
        told[results] = settling.failing
    assert told["." * 7] == ""
    assert told["F" * 7] == "7 of 7 episodes failed: at confidence=0.95, the success rate is below 0.5"
    assert told[".F"] == (
        "1 of 2 episodes succeeded, which is too close to min_success=0.5 to decide at confidence=0.95"
    )


@pytest.mark.parametrize(("total", "fits"), [(-1.0, True), (2.0, True), (-1.01, False), (2.01, False)])
def test_total_may_lie_on_its_range_ends(total: float, fits: bool) -> None:
    within(mission(True, total), None)
    if fits:
        within(mission(True, total), (-1.0, 2.0))
        return
    with pytest.raises(RecordingError, match=r"An episode \(seed 7\) earned -?[12].01, outside"):
        within(mission(True, total), (-1.0, 2.0))
    with pytest.raises(RecordingError):
        Settling(designated(total_range=(-1.0, 2.0)), 5)([mission(True, 0.0), mission(True, total)])
