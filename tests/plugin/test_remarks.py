"""Remarks that accompany a verdict, and verdicts that are corrected for several comparisons."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import remarks
from pytest_tarl.corrected_verdicts import corrected
from pytest_tarl.learning.bounds import detectable_loss
from pytest_tarl.model import Comparison, Region, SitePlace, TaintList, Verdict
from pytest_tarl.sensors import Sensor


def place(name: str, line: int = 3) -> SitePlace:
    return SitePlace(f"node:run:{name}", "node.py", line, name, "data", "compute")


def recorded(*lists: tuple[SitePlace, ...]) -> Any:
    return SimpleNamespace(lists=tuple(TaintList("/a", "/b", one) for one in lists))


def now(*places: SitePlace) -> Any:
    return SimpleNamespace(places=places)


ALL = tuple(place(name) for name in "abcde")


def test_lost_sites_are_named_once_and_at_most_three() -> None:
    assert remarks.lost_sites(recorded(ALL), now(*ALL)) == ()
    (told,) = remarks.lost_sites(recorded(ALL[:2], ALL[1:3]), now(ALL[0]))
    assert "the slices of node.py:3 `b`, node.py:3 `c` are lost" in told
    (told,) = remarks.lost_sites(recorded(ALL[:3]), now())
    assert "`a`, node.py:3 `b`, node.py:3 `c` are lost" in told
    (told,) = remarks.lost_sites(recorded(ALL), now())
    assert "`a`, node.py:3 `b`, node.py:3 `c` and 2 more are lost" in told


def test_moved_sites_are_named_if_others_are_lost() -> None:
    moved = tuple(place(name, line=7) for name in "abcd")
    assert remarks.lost_sites(recorded(ALL[:4]), now(*moved)) == ()
    assert remarks.lost_sites(recorded(ALL), now(*moved[:1], *ALL[1:4]))[1:] == (
        "`a` from line 3 to 7 moved and keep their slices.",
    )
    assert remarks.lost_sites(recorded(ALL), now(*moved))[1:] == (
        "`a` from line 3 to 7, `b` from line 3 to 7, `c` from line 3 to 7 and 1 more moved and keep their slices.",
    )
    assert len(remarks.lost_sites(recorded(ALL), now(*moved[:3]))[1:]) == 1
    assert "more" not in remarks.lost_sites(recorded(ALL), now(*moved[:3]))[1]


def test_a_note_states_that_the_comparison_stopped_early() -> None:
    sample: Any = SimpleNamespace(episodes=20)
    assert remarks.early(sample, 20) == ()
    assert remarks.early(sample, 40)[0].startswith("stopped after 20 of 40 episodes")


VERDICT = Verdict("no difference", 1.0, 1.0, 0.0, 0.5, 0.1)


def test_a_note_states_failures_without_a_loss() -> None:
    assert remarks.failing(VERDICT) == ()
    assert remarks.failing(replace(VERDICT, because=("reward", "success"))) == ()
    assert remarks.failing(replace(VERDICT, because=("success",)))[0].startswith("more missions fail")


def test_a_note_states_that_all_situations_are_new(monkeypatch: pytest.MonkeyPatch) -> None:
    sensors = [Sensor("near"), Sensor("far"), Sensor("wet")]

    def told(result: Any, without: tuple[int, ...], far: bool) -> list[str]:
        monkeypatch.setattr(remarks, "apart", lambda *_: far)
        difference: Any = SimpleNamespace(
            verdict=replace(VERDICT, result=result), region=Region(without=without)
        )
        sample: Any = None
        return list(remarks.unheard_of(sample, sample, difference, sensors))

    assert told("no difference", (), True) == told("drifted", (), False) == []
    assert told("drifted", (2, 0), True)[0].startswith(
        "no deployed situation occurs in the recording, because of wet and near."
    )
    assert "no line is named" in told("degraded", (), True)[0]


def judged(formulas: tuple[str, ...], *robustness: list[float]) -> Any:
    return SimpleNamespace(judgements=SimpleNamespace(formulas=formulas, robustness=np.array(robustness)))


def test_notes_name_new_and_unjudged_formulas() -> None:
    none: Any = SimpleNamespace(judgements=None)
    nan = float("nan")
    assert remarks.other_formulas(none, none) == ()
    assert remarks.other_formulas(judged(("a", "b"), [1, 1]), judged(("a", "b"), [nan, 1], [1, 1])) == ()
    (told,) = remarks.other_formulas(judged(("a",), [1]), judged(("a", "b", "c"), [1, 1, 1]))
    assert "when the test was recorded: 'b', 'c'. Record again" in told
    assert "'a', 'b'" in remarks.other_formulas(none, judged(("a", "b"), [1, 1]))[0]
    (told,) = remarks.other_formulas(judged(("a", "b"), [1, 1]), judged(("a", "b"), [nan, 1], [nan, 1]))
    assert told == "no deployed episode was long enough to judge 'a'."


# corrected verdicts


def comparison(p_drift: float, p_loss: float, episodes: int = 20, tolerance: float = 0.1) -> Comparison:
    totals = {"offline": tuple(np.linspace(9, 11, episodes)), "online": tuple(np.linspace(7, 9, episodes))}
    verdict = Verdict("degraded", p_drift, p_loss, 2.0, 0.5, tolerance, because=("reward",))
    return Comparison("t", "mud", 0, (), (), (), verdict, Region(cells=((1,),)), (), totals, notes=("first",))


def test_p_values_of_a_run_are_corrected() -> None:
    one, other = corrected([comparison(0.01, 0.02), comparison(0.5, 0.6)], 0.05)
    assert (one.verdict.p_drift, one.verdict.p_loss) == pytest.approx((0.02, 0.04))
    assert (other.verdict.p_drift, other.verdict.p_loss) == pytest.approx((0.5, 0.6))
    assert (one.verdict.result, other.verdict.result) == ("degraded", "no difference")
    assert (one.region, other.region) == (Region(cells=((1,),)), Region())
    assert one.notes == (
        "first",
        (
            "p-values are corrected for the 2 comparisons of this run (Holm); uncorrected: 0.02 for the loss, 0.01 for "
            "the difference."
        ),
    )


def test_a_single_comparison_stays_as_it_is() -> None:
    (one,) = corrected([comparison(0.01, 0.02)], 0.05)
    assert one == comparison(0.01, 0.02)


def test_detectable_loss_is_at_least_the_tolerance() -> None:
    one, _ = corrected([comparison(0.01, 0.02), comparison(0.5, 0.6)], 0.05)
    offline, online = (np.array(one.totals[world]) for world in ("offline", "online"))
    assert one.verdict.detectable_loss == detectable_loss(offline, online, 0.025)
    one, _ = corrected([comparison(0.01, 0.02, tolerance=5.0), comparison(0.5, 0.6)], 0.05)
    assert one.verdict.detectable_loss == 5.0


def test_hopeless_correction_is_noted() -> None:
    # 3 and 3 episodes can be shuffled in 20 ways, so that no p-value is below 0.05
    one, _ = corrected([comparison(0.05, 0.05, 3), comparison(0.5, 0.6, 3)], 0.2)
    assert len(one.notes) == 2
    one, _ = corrected([comparison(0.05, 0.05, 3), comparison(0.5, 0.6, 3)], 0.1)
    assert one.notes[2].startswith(
        "This test cannot reach significance: with 3 deployed and 3 recorded episodes, the smallest possible p-value "
        "is 0.05, or 0.1 corrected for 2 comparisons, which is not below 0.1."
    )
    many = corrected([comparison(0.5, 0.5, 3)] * 30, 0.05)
    assert "is 0.05, or 1 corrected for 30" in many[0].notes[2]
