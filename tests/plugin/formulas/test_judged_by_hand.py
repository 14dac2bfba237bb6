"""The judgement and the rewards of an episode, and of a mission in a log, worked out by hand."""

from __future__ import annotations

from math import isnan

import pytest

pytest.importorskip("rtamt")

from pytest_tarl.errors import LogError
from pytest_tarl.formulas.judging import Judge, Judged
from pytest_tarl.formulas.lookback import Followed, LookedBack, judgeable, left_out, looked_back
from pytest_tarl.formulas.marker_arguments import Requirements
from pytest_tarl.formulas.parsing import formula

NAMES = ("x", "y")
SECOND = 10**9
SAFE = formula("here", "always (x > 0)", NAMES)
QUICK = formula("here", "eventually[0:2] (y > 0)", NAMES)
CHANGES = [(0.0, "x", 3.0), (0.0, "y", -1.0), (1.2, "x", 0.5), (2.5, "x", -2.0)]


def judge(*formulas: object, changes: list[tuple[float, str, float]], steps: list[float]) -> Judge:
    found = Judge(NAMES, formulas)  # type: ignore[arg-type]
    for time, name, value in changes:
        found.give(name, value, round(time * SECOND))
    found.steps = [round(step * SECOND) for step in steps]
    return found


@pytest.mark.parametrize(
    ("least", "robustness", "lost"),
    [(3.0, 3.0, None), (0.5, 0.5, None), (1e-9, 1e-9, None), (0.0, -1e-300, 1.5), (-2.0, -2.0, 1.5)],
)
def test_a_formula_holds_if_its_robustness_is_above_zero(
    least: float, robustness: float, lost: float | None
) -> None:
    found = judge(SAFE, changes=[(0.0, "x", 3.0), (1.5, "x", least)], steps=[1.0, 2.0, 3.0])
    (one,) = found.conclude(3 * SECOND)
    assert (one.formula, one.robustness, one.violated) == ("always (x > 0)", robustness, lost is not None)
    assert isnan(one.lost) if lost is None else one.lost == lost  # the change, and not the end of its step


def test_rewards_are_the_changes_of_the_lowest_robustness() -> None:
    found = judge(SAFE, changes=CHANGES, steps=[1.0, 2.0, 3.0])
    assert found.rewards(3 * SECOND, 10.0) == [3.0, -2.5, -2.5]
    assert found.rewards(3 * SECOND, 1.0) == [1.0, -0.5, -1.5]
    assert found.rewards(2 * SECOND, 10.0) == [3.0, -2.5, 0.0]
    assert judge(SAFE, changes=CHANGES, steps=[]).rewards(3 * SECOND, 1.0) == []
    assert judge(SAFE, changes=[], steps=[1.0, 2.0]).rewards(2 * SECOND, 5.0) == [0.0, -5.0]
    assert judge(changes=CHANGES, steps=[1.0, 2.0]).rewards(2 * SECOND, 5.0) == [0.0, -5.0]


def test_the_formula_with_the_lowest_robustness_decides() -> None:
    both = judge(SAFE, QUICK, changes=CHANGES, steps=[1.0, 2.0, 3.0])
    assert both.rewards(3 * SECOND, 10.0) == [-1.0, 0.0, -1.0]


def test_logged_mission_is_judged_like_an_episode() -> None:
    mission = Followed()
    mission.add({"changes": CHANGES[:2], "times": [1.0]})
    mission.add({"changes": CHANGES[2:], "times": [2.0, 3.0]})
    mission.add({"lasted": 3.0})
    rewarding = Requirements(formulas=(SAFE,), names=NAMES, rewarding=True, cap=10.0)
    found = looked_back(mission, (SAFE,), rewarding)
    assert found.judged == (Judged("always (x > 0)", -2.0, 2.5),)
    assert found.rewards == [3.0, -2.5, -2.5]
    assert "always (x > 0)" in found.violation
    plain = Requirements(formulas=(SAFE,), names=NAMES)
    assert looked_back(mission, (SAFE,), plain).rewards is None
    of_x = Requirements(formulas=(SAFE,), names=("x",), rewarding=True, cap=1.0)
    assert looked_back(mission, (SAFE,), of_x).rewards == [1.0, -0.5, -1.5]


def test_without_formulas_or_signals_a_mission_has_no_results() -> None:
    mission = Followed(list(CHANGES), [1.0], 3.0)
    needs = Requirements(formulas=(SAFE,), names=NAMES)
    assert looked_back(mission, (), needs) == LookedBack()
    assert looked_back(Followed(list(CHANGES), [1.0], None), (SAFE,), needs) == LookedBack()


def test_only_formulas_with_logged_signals_are_judged() -> None:
    only_x, both = (Followed([(0.0, name, 1.0) for name in names], [1.0], 1.0) for names in ("x", "xy"))
    plain = Requirements(formulas=(SAFE, QUICK), names=NAMES)
    rewarding = Requirements(formulas=(SAFE, QUICK), names=NAMES, rewarding=True)
    assert judgeable([both, both], plain) == (SAFE, QUICK)
    assert judgeable([both, only_x], plain) == (SAFE,)
    assert judgeable([both, Followed()], plain) == judgeable([], plain) == ()
    assert judgeable([both], rewarding) == (SAFE, QUICK)
    with pytest.raises(LogError, match=r"lacks signals of the formula 'eventually\[0:2\] \(y > 0\)'.*\(y\)"):
        judgeable([both, only_x], rewarding)
    assert left_out("a.log", (SAFE, QUICK), plain) == ()
    (note,) = left_out("a.log", (SAFE,), plain)
    assert note.startswith("a.log lacks signals of 'eventually[0:2] (y > 0)', which is not judged.")
