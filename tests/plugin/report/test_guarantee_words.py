"""Sentences on bounds state the numbers of the bound, rounded so that they never promise more."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import hypothesis.strategies as st
from hypothesis import given

from pytest_tarl.model import Bound, Comparison, Guarantee
from pytest_tarl.report.guarantee_words import SCOPE, brief, figure, percent, sentences, worlds

STATED = Guarantee(
    episodes=200,
    passed=197,
    success=Bound(0.9532, 0.999, 0.95, "exact", True, 200),
    average=4.25,
    mean=Bound(3.5, 5.0, 0.95, "Student", False, 200),
    share=0.1,
    quantile=2.75,
    needed=0,
    varied=True,
)


def test_each_bound_has_a_sentence_of_its_own() -> None:
    assert list(sentences(STATED)) == [
        f"197 of 200 missions succeeded: success rate at least 95.3 % with 95 % confidence, {SCOPE}",
        "mean reward 4.25 per mission: at least 3.5 with 95 % confidence (approximate: no total_range is declared)",
        "90 % of the missions earn at least 2.75, with 95 % confidence",
        "each bound holds separately",
    ]
    assert list(brief(STATED)) == [
        "success at least 95.3 %, mean reward approximately at least 3.5 (95 % confidence each, 200 episodes)"
    ]


def test_a_declared_range_makes_the_mean_exact() -> None:
    exact = replace(STATED, mean=replace(STATED.mean, exact=True))
    assert "totals within the declared range" in "\n".join(sentences(exact))
    assert "mean reward at least 3.5" in "\n".join(brief(exact))


def test_a_bound_that_needs_more_episodes_says_how_many() -> None:
    few = replace(STATED, episodes=20, passed=20, quantile=None, needed=29)
    assert "stating a reward that 90 % of the missions reach needs 29 episodes, 9 more than were run" in list(
        sentences(few)
    )
    assert len(list(sentences(replace(few, needed=0)))) == 3


def test_equal_episodes_give_no_bounds() -> None:
    one = replace(STATED, varied=False)
    (told,) = sentences(one)
    assert told.startswith("only one world was tested: all 200 episodes are equal (197 succeeded)")
    (told,) = sentences(replace(one, passed=200))
    assert "(every one succeeded)" in told
    assert list(brief(one)) == ["only one world was tested, 200 times"]


@given(st.floats(0.0, 1.0))
def test_percentages_in_guarantees_are_rounded_down(share: float) -> None:
    shown = float(percent(share).removesuffix(" %")) / 100
    assert share - 0.001 < shown <= share + 1e-9


def test_an_infinite_bound_is_not_printed() -> None:
    assert figure(float("-inf")) == "nothing"


def test_bounded_worlds_are_named_in_report_order(varied: Callable[..., Comparison]) -> None:
    few = replace(STATED, episodes=10)
    stated = {"nominal_repaired": few, "offline": STATED}
    assert list(worlds(varied(stated=stated))) == [("designed", STATED), ("designed, repaired", few)]
    assert [name for name, _ in worlds(varied(stated={"repaired": STATED}))] == ["repaired"]
    assert list(worlds(varied(stated={}))) == []
