"""How often and how finely the best constant of a search is refined."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.model import Guard
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching import adjusting
from pytest_tarl.searching.adjusting import IDLE, REFINED, ROUNDS, Adjusting
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.search import Candidate, Goal, Pair
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_alternatives_by_hand import A, B, entered
from tests.plugin.searching.test_gains import constant
from tests.plugin.searching.test_search import operand


class Sweeping:
    """A search that notes the factors it is asked to try; `results` maps factors to gains."""

    def __init__(self, gains: Gains, results: Any = None, **given: Any) -> None:
        self.gains, self.results = gains, results or {}
        self.goal = Goal((Pair(7, 0.0),), near=9.0, enough=10.0, online=0.0)
        self.proposed, self.slack, self.refused = False, 0.1, set[Any]()
        self.tried: list[float] = []
        self.expected: list[Any] = []
        self.trials: Any = None
        self.mutate = mutations
        self.given: Any = lambda _: ()
        self.__dict__ |= given

    def attempt(self, unit: Unit, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        self.tried.append(factor)
        self.gains.enter((unit, guard), factor, self.results.get(factor, 0.0))
        yield from ()

    def expect(self, tries: Any, pair: int) -> None:
        self.expected.append((list(tries), pair))


def adjusted(gains: Gains, results: Any = None, **given: Any) -> tuple[Adjusting, Any]:
    search: Any = Sweeping(gains, results, **given)
    found = Adjusting(search)
    assert list(found.refine(0)) == []
    return found, search


def test_the_best_constant_is_refined_between_its_neighbours() -> None:
    found, search = adjusted(entered((A, 2.2, 3.0), (A, 0.4, -1.0), (B, 2.2, 1.0)))
    assert search.tried == [1.483, 5.06]
    assert search.expected == [([(A, ALWAYS, 1.483), (A, ALWAYS, 5.06)], 0)]
    assert found.refined == {(A, ALWAYS): 2}


def test_refining_continues_while_the_gain_grows() -> None:
    _, search = adjusted(entered((A, 2.2, 3.0)), {1.483: 4.5})
    assert len(search.tried) == 4
    _, search = adjusted(entered((A, 2.2, 3.0)), {1.483: 4.0})  # less than a promising gain
    assert len(search.tried) == 2
    _, search = adjusted(entered((A, 2.2, 9.0)), {})
    assert len(search.tried) == 2 * ROUNDS
    _, search = adjusted(entered((A, 2.2, 8.9)), {})
    assert len(search.tried) == 2


def test_stalled_constant_is_replaced_by_a_similar_one() -> None:
    found, _ = adjusted(entered((A, 2.2, 3.0), (B, 2.2, 2.5)))
    assert set(found.refined) == {(A, ALWAYS)}
    list(found.refine(0))
    assert set(found.refined) == {(A, ALWAYS), (B, ALWAYS)}
    found, _ = adjusted(entered((A, 2.2, 3.0), (B, 2.2, 2.0)))
    list(found.refine(0))
    assert set(found.refined) == {(A, ALWAYS)}  # the other gains too little


def test_refining_stops_after_a_refusal_or_a_small_gain() -> None:
    assert adjusted(entered((A, 2.2, 0.1)))[1].tried == []
    assert adjusted(Gains(0.1))[1].tried == []
    refused = entered((A, 2.2, 3.0), (B, 2.2, 1.0))
    found, search = adjusted(refused, refused={(A, ALWAYS)})
    assert set(found.refined) == {(B, ALWAYS)}
    found.refined[B, ALWAYS] = REFINED
    search.tried.clear()
    assert list(found.refine(0)) == []
    assert search.tried == []
    found.refined[B, ALWAYS] = REFINED - 1
    assert list(found.refine(0)) == []
    assert search.tried != []


def test_constants_beside_a_plateau_are_refined_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def refined(beside: list[Any], proposed: bool) -> set[Unit]:
        def nearby(tried: Any, gains: Gains, least: float) -> list[Any]:
            asked.append((list(tried), least))
            return beside

        monkeypatch.setattr(adjusting.plateau, "nearby", nearby)
        found, _ = adjusted(entered((A, 2.2, 3.0), (B, 2.2, 1.0)), proposed=proposed)
        return {unit for unit, _ in found.refined}

    assert refined([(B, ALWAYS)], proposed=True) == {A}
    assert asked == []
    assert refined([(B, ALWAYS)], proposed=False) == {B}
    assert asked[0] == ([(A, ALWAYS), (B, ALWAYS)], adjusting.PROMISING * 10.0)
    assert refined([], proposed=False) == {A}  # no plateau


def test_offset_is_refined_half_as_often() -> None:
    offset = Unit((operand(3, "0.0", 0.0),))
    found, search = adjusted(entered((offset, 2.2, 3.0)), {})
    search.tried.clear()
    found.refined[offset, ALWAYS] = REFINED // 2
    assert list(found.refine(0)) == []
    assert search.tried == []


def test_negative_factor_is_refined_only_if_proposed() -> None:
    def tried(proposed: bool) -> list[float]:
        search: Any = Sweeping(entered((A, -2.0, 3.0), (A, 2.2, 1.0)), proposed=proposed)
        list(Adjusting(search).between((A, ALWAYS), 0))
        return list(search.tried)

    assert all(one > 0 for one in tried(False))
    assert all(one < 0 for one in tried(True))


def test_the_best_constant_gets_its_exact_value_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def exactest(unit: Unit, factor: float, guard: Guard, seed: int, *_: Any) -> tuple[float, float]:
        asked.append((unit, factor, guard, seed))
        return 2.5, 0.0

    monkeypatch.setattr("pytest_tarl.searching.adjusting.exactest", exactest)

    def exact(gain: float, **given: Any) -> list[float]:
        search: Any = Sweeping(entered((A, 2.2, gain), (B, 2.2, 1.0)), **given)
        found = Adjusting(search)
        list(found.exactly(ALWAYS))
        first = list(search.tried)
        list(found.exactly(ALWAYS))
        assert search.tried == first
        return first

    assert exact(5.0)[0] == 2.5
    assert asked == [(A, 2.2, ALWAYS, 7)]
    assert exact(4.9) == []
    assert exact(5.0, proposed=True) == []


def test_fixed_parameters_of_a_proposal_vary_once() -> None:
    climbed: Any = []
    joining: Any = lambda gains: SimpleNamespace(  # noqa: E731
        climbed=lambda base, unit: climbed.append((base.parts, unit)) or iter(())
    )

    def varied(gain: float, **given: Any) -> int:
        climbed.clear()
        gains = Gains(0.1, proposed=True)
        gains.enter((A, ALWAYS), 2.2, gain)
        every = {"proposed": True, "given": lambda _: B.operands, "joining": joining, **given}
        search: Any = Sweeping(gains, **every)
        found = Adjusting(search)
        list(found.refine(0))
        list(found.refine(0))
        return len(climbed)

    assert varied(4.0) == 1
    assert climbed == [(((A, 2.2),), B)]
    assert varied(3.9) == 0
    assert varied(4.0, proposed=False) == 0


def test_refining_ends_between_equal_gains() -> None:
    """A threshold that is low enough lets missions last longer; another one fails them then."""
    found, search = adjusted(entered((A, 2.2, 3.0)), {one / 1000: 3.0 for one in range(1, 60000)})
    for _ in range(5):
        assert list(found.refine(0)) == []
    assert len(search.tried) == 2 * IDLE
    much = entered((A, 2.2, 5.0))
    found, search = adjusted(much, {one / 1000: 5.0 for one in range(1, 60000)})
    for _ in range(5):
        assert list(found.refine(0)) == []
    assert len(search.tried) == REFINED // 2  # after two values on each side, the neighbours are close


def test_sharp_peak_is_refined_until_its_neighbours_are_close() -> None:
    """One of eight parts is picked with factor 2.2, all with 2.7, none with 2 and 3.3."""
    found, search = adjusted(entered((A, 2.2, 1.5)), {2.709: 9.5})
    for _ in range(3):
        assert list(found.refine(0)) == []
    assert search.tried[:6] == [1.483, 5.06, 1.806, 3.336, 1.993, 2.709]
    literal = Unit((operand(3, "0.5", 0.5),))
    found, search = adjusted(entered((literal, 2.2, 1.5)), {2.709: 9.5})
    for _ in range(3):
        assert list(found.refine(0)) == []
    assert len(search.tried) == 2 * IDLE


def test_only_the_first_similar_use_is_refined() -> None:
    whole = Unit((constant(3, "AHEAD", 0.65),))
    use = Unit((replace(constant(8, "AHEAD", 0.65), definition=whole.operands[0].definition),))
    gains = entered((whole, 2.2, 3.0), (whole, 0.4, -1.0), (use, 2.2, 3.0), (use, 0.4, -1.0))
    found, _ = adjusted(gains)
    assert set(found.refined) == {(whole, ALWAYS)}
    gains = entered((whole, 2.2, 2.0), (whole, 0.4, -1.0), (use, 2.2, 3.0), (use, 0.4, -1.0))
    found, _ = adjusted(gains)
    assert set(found.refined) == {(use, ALWAYS)}
