"""The phases of a stress search in their order, and the choice of drifts by a model with known predictions."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Drift
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import combinations, stress_run
from pytest_tarl.stressing.chains import FIRST, NEXT, clear, part_of
from pytest_tarl.stressing.combinations import SHARES, Chain, Combined, Together, _inside
from pytest_tarl.stressing.coordinates import Coordinates
from pytest_tarl.stressing.evaluating import BudgetSpentError
from pytest_tarl.stressing.findings import Curve, Failure, failure
from pytest_tarl.stressing.mapping import CELLS, margin_map
from pytest_tarl.stressing.nearest import Nearest, _without_trifles
from pytest_tarl.stressing.prediction import Prediction, Sample, Shown
from pytest_tarl.stressing.rays import rays
from pytest_tarl.stressing.stress_run import divided, explore, variances
from tests.plugin.stressing.test_words_by_hand import DOWN, FLAT, GIVEN, MUD, STEEP, curve, seen
from tests.plugin.stressing.worlds import evaluator_of, space_of

CUBE = space_of(**{name: Drift.range(0.0, 1.0, nominal=0.0) for name in "abc"})
LINE = space_of(a=Drift.range(0.0, 1.0, nominal=0.0))


# the phases


class Several:
    """Stand-in for the search in several directions."""

    trail: Any = None
    fail: Any = {}  # noqa: RUF012 (set by each test)

    def __init__(self, evaluator: Any, together: Any) -> None:
        self.trail.append("made")

    def step(self, name: str) -> None:
        self.trail.append(name)
        if name in self.fail:
            raise self.fail[name]

    def begin(self) -> None:
        self.step("begin")

    def end(self) -> None:
        self.step("end")

    def draw(self) -> None:
        self.step("draw")


@pytest.fixture
def trail(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    found: list[Any] = []
    monkeypatch.setattr(Several, "trail", found)
    monkeypatch.setattr(Several, "fail", {})
    monkeypatch.setattr(stress_run, "Combined", Several)
    monkeypatch.setattr(
        stress_run, "_nominal_fails", lambda evaluator, risk: found.append(("nominal", risk)) or False
    )
    monkeypatch.setattr(
        stress_run, "along_rays", lambda curves, evaluator, share: found.append(("rays", share))
    )
    monkeypatch.setattr(
        stress_run, "near_ends", lambda curves, evaluator: found.append([one.ray.names[0] for one in curves])
    )
    return found


def explored(space: Any = CUBE, **given: Any) -> str:
    one, other = curve(MUD, {1.0: -1.0}), curve(STEEP, {1.0: 1.0})
    evaluator: Any = SimpleNamespace(space=space, short=given.pop("short", False))
    together: Any = SimpleNamespace(curves=[one, other])
    return explore(evaluator, together, 0.01, **given)


ORDER = ["made", ("nominal", 0.01), "begin", ("rays", 0.01), ["mud"], "end", ["slope"], "draw"]


def test_search_in_several_directions_surrounds_the_rays(
    trail: list[Any],
) -> None:
    assert explored() == ""
    assert trail == ORDER


def test_search_in_one_direction_follows_only_the_rays(
    trail: list[Any],
) -> None:
    alone = [("nominal", 0.01), ("rays", 0.01), ["mud"], ["slope"]]
    assert explored(LINE) == ""
    assert trail == alone
    trail.clear()
    assert explored(combined=False) == ""
    assert trail == alone


def test_a_nominal_failure_ends_the_search_at_once(trail: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stress_run, "_nominal_fails", lambda *_: True)
    assert explored() == "nominal"
    assert trail == ["made", "draw"]


@pytest.mark.parametrize(
    ("error", "ended"), [(BudgetSpentError(), "budget"), (KeyboardInterrupt(), "interrupted")]
)
def test_early_end_draws_the_known_results(error: BaseException, ended: str, trail: list[Any]) -> None:
    Several.fail = {"end": error}
    assert explored() == ended
    assert trail == [*ORDER[:6], "draw"]


def test_note_names_the_uncovered_results(trail: list[Any]) -> None:
    assert explored(short=True) == "budget"


def test_interrupted_search_has_no_variances(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(stress_run, "sobol", lambda _: "indices")
    evaluator: Any = None
    assert [variances(evaluator, ended) for ended in ("", "budget", "interrupted", "nominal")] == [
        ("indices", ""),
        ("indices", "budget"),
        (None, "interrupted"),
        (None, "nominal"),
    ]

    def failing(error: BaseException) -> Any:
        def run(_: Any) -> None:
            raise error

        return run

    monkeypatch.setattr(stress_run, "sobol", failing(BudgetSpentError()))
    assert variances(evaluator, "") == (None, "budget")
    monkeypatch.setattr(stress_run, "sobol", failing(KeyboardInterrupt()))
    assert variances(evaluator, "") == (None, "interrupted")


def test_half_of_the_risk_is_for_combinations() -> None:
    found = divided(0.05, 4)
    assert (found.each, found.combinations) == (0.005, 0.025)
    assert divided(0.5, 0).each == pytest.approx(0.1 / 6)


# the map


def test_the_map_shows_the_two_ranges_that_lose_most() -> None:
    ends = [
        Curve(ray, {1.0: seen(margin)}) for ray, margin in zip(rays(CUBE, {}), (0.5, -1.0, 0.0), strict=True)
    ]
    model: Any = SimpleNamespace(moments=lambda vectors: (vectors[:, 1], vectors[:, 2]))
    found = margin_map(ends, model, Coordinates(CUBE, CUBE.nominal))
    assert found is not None
    assert found.names == ("b", "c")
    assert (len(found.margins), len(found.margins[0])) == (CELLS, CELLS)
    assert found.margins[3][7] == pytest.approx(7.5 / CELLS, abs=1e-3)
    assert found.spreads[3][7] == pytest.approx(3.5 / CELLS, abs=1e-3)
    assert margin_map(ends[:1], model, Coordinates(CUBE, CUBE.nominal)) is None


# pairs, chains and confirmed combinations


def test_pairs_lie_just_inside_the_boundaries() -> None:
    inside = list(
        _inside(
            [
                curve(MUD, {0.5: 1.0, 1.0: -1.0}),
                curve(FLAT, {0.5: 1.0, 1.0: 1.0}),
                curve(STEEP, {0.5: -1.0, 1.0: -1.0}),
                curve(DOWN, {1.0: -1.0}),
            ]
        )
    )
    assert inside == [(MUD, 0.45), (FLAT, 1.0)]


def model_of(by_loss: list[float], by_rate: list[float]) -> Any:
    vectors = Coordinates(CUBE, CUBE.nominal)
    shown = SimpleNamespace(shown_by=lambda _: (np.array(by_loss), np.array(by_rate)))
    return SimpleNamespace(coordinates=vectors, model=lambda: shown)


def drift(**changes: float) -> Point:
    return {**CUBE.nominal, **changes}


@pytest.mark.parametrize(
    ("by_loss", "by_rate", "part"),
    [
        ([0.1, 0.6], [0.5, 0.6], "rate"),
        ([0.1, 0.6], [0.49, 0.6], "both"),
        ([0.1, 0.61], [0.5, 0.6], "both"),
        ([0.9, 0.9], [0.04, 0.049], "loss"),
        ([0.9, 0.9], [0.05, 0.04], "both"),
    ],
)
def test_chain_tests_the_part_of_the_guarantee_that_breaks(
    by_loss: list[float], by_rate: list[float], part: str
) -> None:
    chain = [drift(a=1.0, b=1.0), drift(a=0.5, b=0.5)]
    assert part_of(model_of(by_loss, by_rate), chain) == part
    assert part_of(model_of([], []), []) == "both"


def test_spaced_clear_failures_are_tested() -> None:
    tried = [drift(a=size, b=size) for size in (0.2, 0.9, 0.5, 0.4, 0.7)]
    tried += [drift(a=0.1), drift(a=0.3, c=0.3)]
    results = {0.3: "holds"}
    evaluator: Any = SimpleNamespace(
        space=CUBE, known=lambda point: SimpleNamespace(result=results.get(point["a"], "fails"))
    )
    nearest: Any = SimpleNamespace(
        evaluator=evaluator,
        tried=tried,
        coordinates=Coordinates(CUBE, CUBE.nominal),
        distance=lambda point: float(np.hypot(point["a"], point["b"])),
    )
    assert [point["a"] for point in clear(nearest)] == [0.5, 0.4, 0.2]
    nearest.tried = tried[:1]
    assert [point["a"] for point in clear(nearest)] == [0.2]
    nearest.tried = []
    assert clear(nearest) == []


class Confirming:
    """An evaluator that confirms drifts up to a distance and notes the tests."""

    def __init__(self, least: float) -> None:
        self.space, self.least = CUBE, least
        self.asked: list[tuple[float, str, float, str]] = []
        self.released: list[str] = []

    def confirm(
        self,
        point: Point,
        pool: str,
        risk: float,
        sizes: Any,
        shares: Any,
        part: str,
        strict: bool,
        least: float | None,
    ) -> bool:
        self.asked.append((point["a"], pool, risk, part))
        return point["a"] >= self.least

    def release(self, pool: str) -> None:
        self.released.append(pool)

    def examine(self, point: Point, most: int) -> Any:
        return seen(-1.0)


def test_chain_tests_stop_at_the_first_unconfirmed_drift() -> None:
    together, evaluator = Together(0.1, [Curve(ray) for ray in rays(CUBE, {})]), Confirming(0.5)
    chain = [drift(a=size, b=size) for size in (0.9, 0.6, 0.4, 0.2)]
    assert together.confirm(chain, evaluator, "loss")  # type: ignore[arg-type]
    assert evaluator.asked == [
        (size, "chain 0", pytest.approx(0.1 * SHARES[0]), "loss") for size in (0.9, 0.6, 0.4)
    ]
    assert [one.point["a"] for one in together.every] == [0.9, 0.6]
    assert together.tested == chain[:3]
    assert evaluator.released == ["chain 0"]
    assert together.chains == 1


def test_drifts_beyond_a_confirmed_failure_are_not_tested() -> None:
    together, evaluator = Together(0.1, []), Confirming(0.0)
    together.every = [failure(CUBE, drift(a=0.5, b=0.5))]
    assert not together.confirm([drift(a=0.6, b=0.5), dict(CUBE.nominal)], evaluator)  # type: ignore[arg-type]
    assert (evaluator.asked, together.chains) == ([], 0)
    assert together.confirm([drift(a=0.6, b=0.4)], evaluator)  # type: ignore[arg-type]
    assert len(together.every) == 2


def test_a_failure_in_one_direction_belongs_to_its_curve() -> None:
    curves = [Curve(ray) for ray in rays(CUBE, {})]
    together, evaluator = Together(0.1, curves), Confirming(0.0)
    assert together.confirm([drift(b=0.75)], evaluator)  # type: ignore[arg-type]
    assert [one.confirmed for one in curves] == [None, 0.75, None]
    assert list(curves[1].evidence) == [0.75]
    assert together.every == []
    assert [one.names for one in together.confirmed] == [("b",)]


def test_spent_budget_keeps_the_confirmed_drifts() -> None:
    together, evaluator = Together(0.1, []), Confirming(0.0)
    confirm = evaluator.confirm

    def spent(point: Point, *given: Any, **named: Any) -> bool:
        if point["a"] < 0.5:
            raise BudgetSpentError
        return confirm(point, *given, **named)

    evaluator.confirm = spent  # type: ignore[method-assign]
    with pytest.raises(BudgetSpentError):
        together.confirm([drift(a=0.9, b=0.9), drift(a=0.4, b=0.4)], evaluator)  # type: ignore[arg-type]
    assert evaluator.released == ["chain 0"]
    assert [one.point["a"] for one in together.found] == [0.9]
    evaluator.confirm = confirm  # type: ignore[method-assign]
    begun = together.interrupted
    assert begun is not None
    assert together.run(begun)
    assert evaluator.asked[-1][:2] == (0.4, "chain 0")
    assert [point["a"] for point in together.tested] == [0.9, 0.4]
    assert together.interrupted is None
    assert together.chains == 1


# the search in several directions


class Leading:
    """Stand-in for a search among the drifts with the same options."""

    made: Any = []  # noqa: RUF012 (set by each test)

    def __init__(
        self, evaluator: Any, curves: Any, tried: Any = None, risk: float = 0.0, base: Any = None
    ) -> None:
        self.evaluator, self.curves, self.risk, self.base = evaluator, curves, risk, base
        self.tried = [] if tried is None else tried
        self.coordinates = Coordinates(evaluator.space, base or evaluator.space.nominal)
        self.best: Point | None = None
        self.calls: list[Any] = []
        self.tested: list[Point] = []
        self.ceiling = 2.0
        Leading.made.append(self)

    def distance(self, point: Point) -> float:
        return failure(self.evaluator.space, point).distance

    def approach(self, rounds: int | None = None) -> None:
        self.calls.append(("approach", rounds))

    def explore(self, rounds: int) -> None:
        self.calls.append(("explore", rounds, round(self.ceiling, 3)))

    def refine(self) -> None:
        self.calls.append(("refine", self.evaluator.budget))

    def improve(self) -> None:
        self.calls.append(("improve", self.evaluator.budget))

    def expected(self, steps: Any) -> list[Point]:
        return [] if self.best is None else [self.best]

    def model(self) -> Any:
        return SimpleNamespace(shown=Shown(0.2, 0.15))

    def map(self) -> str:
        return "map"


@pytest.fixture
def leading(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    Leading.made = []
    monkeypatch.setattr(combinations, "Nearest", Leading)
    return Leading.made


def made(space: Any, budget: int = 1000) -> Combined:
    evaluator = evaluator_of(lambda point, _: (True, 10.0), space, budget=budget)
    return Combined(evaluator, Together(0.1, [Curve(ray) for ray in rays(space, {})]))


def test_search_begins_with_a_look_at_each_ray(leading: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    plans: list[Any] = []

    def confirm(self: Combined, plan: Any) -> bool:
        plans.append((plan, self.evaluator.budget))
        return False

    monkeypatch.setattr(Combined, "_confirm", confirm)
    monkeypatch.setattr(Combined, "_test", lambda self, chain: plans.append("clear") or False)
    monkeypatch.setattr(combinations.chains, "clear", lambda nearest: [])
    both = made(CUBE)
    both.begin()
    assert [sorted(one.evidence) for one in both.together.curves] == [[0.25, 0.5, 0.75, 1.0]] * 3
    assert both.nearest.calls[0] == ("approach", None)  # type: ignore[attr-defined]
    # of 1000 episodes, so that the last chains can use what the first ones show
    assert plans == [(FIRST, 700), (FIRST, 700), "clear", (NEXT, 850)]
    spent = both.evaluator.spent
    assert both.nearest.calls[1] == ("refine", spent + round(0.08 * 850))  # type: ignore[attr-defined]
    assert both.nearest.risk == pytest.approx(0.1 * 0.3)


def test_confirmed_chain_ends_the_clear_failures(leading: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    answers = iter([False, True, False])
    tests: list[Any] = []
    monkeypatch.setattr(Combined, "_confirm", lambda self, plan: next(answers))
    monkeypatch.setattr(Combined, "_test", lambda self, chain: tests.append(chain))
    made(CUBE).begin()
    assert tests == []


def test_small_steps_follow_confirmed_drifts(leading: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    far, near = drift(a=0.9, b=0.9), drift(a=0.6, b=0.6)
    begun: list[Point] = []
    tested: list[Any] = []
    both = made(CUBE)

    def run(self: Combined, chain: Any, part: str) -> bool:
        tested.append((chain, part))
        if chain == ["from far"]:
            self.together.every.append(failure(CUBE, near))
        return chain == ["from far"]

    def closer(_: Any, confirmed: Point) -> list[str]:
        begun.append(confirmed)
        return ["from far"] if confirmed == far else ["from near", "nearer"]

    monkeypatch.setattr(Combined, "_confirm", lambda self, plan: plan == FIRST)
    monkeypatch.setattr(Combined, "_run", run)
    monkeypatch.setattr(combinations.chains, "closer", closer)
    monkeypatch.setattr(combinations.chains, "part_of", lambda _, chain: chain[0])
    both.begin()
    assert begun == []  # nothing is confirmed
    both.together.every.append(failure(CUBE, far))
    both.begin()
    assert begun == [far, near]
    assert tested == [(["from far"], "from far"), (["from near", "nearer"], "from near")]


def test_small_steps_stop_if_the_next_chain_confirms(
    leading: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Combined, "_confirm", lambda self, plan: True)
    monkeypatch.setattr(Combined, "_run", lambda self, chain, part: pytest.fail("a chain ran"))
    both = made(CUBE)
    both.together.every.append(failure(CUBE, drift(a=0.9, b=0.9)))
    both.begin()


@pytest.mark.parametrize(
    ("expected", "near", "order"),
    [
        (True, 0.5, ["continued"]),  # the new chain would not lead much nearer than the interrupted one
        (True, 0.1, ["new", "continued"]),
        (False, 0.1, ["new", "closer"]),  # the model no longer expects the interrupted chain to go on
    ],
)
def test_interrupted_chain_continues_if_a_failure_is_expected(
    expected: bool, near: float, order: list[str], leading: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    happened: list[str] = []
    both = made(CUBE)

    def interrupt(self: Combined, chain: Any) -> bool:
        happened.append("new")
        return False

    def continued(self: Together, chain: Any) -> bool:
        happened.append("continued")
        return True

    monkeypatch.setattr(Combined, "_test", interrupt)
    monkeypatch.setattr(Combined, "_approach_confirmed", lambda self: happened.append("closer"))
    monkeypatch.setattr(Together, "run", continued)
    monkeypatch.setattr(combinations.chains, "clear", lambda nearest: [])
    monkeypatch.setattr(combinations.chains, "chain", lambda *_: [drift(a=near, b=near)])
    monkeypatch.setattr(combinations.chains, "likely", lambda *_: expected)
    both.begin()
    happened.clear()
    both.together.interrupted = Chain([drift(a=0.4, b=0.4)], both.evaluator, "chain 0", 0.01, "loss")
    with both.evaluator.limited(1.0):
        both.begin()
    assert happened[3:] == order  # after two first chains and one of clear failures


def test_confirmed_drift_at_a_jump_is_moved_and_tested_once(
    leading: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    far, near = drift(a=0.9, b=0.9), drift(a=0.6, b=0.6)
    moved, budgets, chains = [drift(a=0.6, b=0.4), drift(a=0.6, b=0.2)], list[int](), list[Any]()
    both = made(CUBE)

    def trimmed(point: Point, evaluator: Any, tried: list[Point]) -> Iterator[Point]:
        assert point == near
        assert tried is both.nearest.tried
        budgets.append(evaluator.budget)
        yield from moved
        raise BudgetSpentError  # the drifts before are kept

    monkeypatch.setattr(combinations, "trimmed", trimmed)
    monkeypatch.setattr(combinations, "broken", lambda *_: "rate")
    monkeypatch.setattr(Combined, "_run", lambda self, chain, part: chains.append((chain, part)))
    both._trim()
    assert chains == []  # nothing is confirmed
    both.together.every += [failure(CUBE, far), failure(CUBE, near)]
    both.together.interrupted = Chain([far], both.evaluator, "chain 0", 0.01, "loss")
    both._trim()
    assert chains == []  # the next drift of the interrupted chain may fail as well
    both.together.interrupted = None
    both._trim()
    both._trim()
    assert budgets == [100]  # of 1000 episodes
    assert chains == [([drift(a=0.6, b=0.4), moved[-1]], "rate")]


def test_chains_follow_further_searches_until_the_budget_is_spent(
    leading: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    both = made(CUBE, budget=20)
    budgets: list[int] = []
    plans: list[Any] = []

    def explore(rounds: int) -> None:
        budgets.append(both.evaluator.budget)
        both.evaluator.common(drift(a=0.1 * len(budgets)), most)

    monkeypatch.setattr(combinations, "AGAIN", 1)
    monkeypatch.setattr(combinations, "EXPLORED", 0.25)
    monkeypatch.setattr(both.nearest, "explore", explore)
    monkeypatch.setattr(Combined, "_confirm", lambda self, plan: plans.append(plan))
    most = 4
    both._search_on()
    assert budgets == [5, 9, 13, 17, 20, 20]  # a quarter of 20 episodes each
    assert plans == [NEXT] * 5  # the last search cannot run its episodes
    both.evaluator.budget, most = 1000, 1
    both._search_on()
    assert plans == [NEXT] * 11  # at most six searches


def test_final_search_improves_then_combines_then_confirms(
    leading: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    order: list[Any] = []
    far, near = drift(a=0.9, b=0.9), drift(a=0.2, b=0.2)
    monkeypatch.setattr(Combined, "_confirm", lambda self, plan: order.append(plan))
    monkeypatch.setattr(Combined, "_test", lambda self, chain: order.append(chain))
    monkeypatch.setattr(
        combinations, "pairs", lambda evaluator, together, proposed: proposed.extend([near, far])
    )
    both = made(CUBE)
    both.end()
    assert order == [NEXT, [far, near]]
    assert both.nearest.calls == [("improve", 850)]  # type: ignore[attr-defined]


def test_map_needs_evidence_on_every_ray(
    leading: list[Any],
) -> None:
    both = made(CUBE)
    both.nearest.best = drift(a=0.5, b=0.5)  # type: ignore[misc]
    both.draw()
    assert both.together.margin_map is None
    for one in both.together.curves:
        one.evidence[1.0] = seen(1.0)
    both.draw()
    assert both.together.margin_map == "map"
    assert both.together.expected == [failure(CUBE, drift(a=0.5, b=0.5))]


MIXED = space_of(
    a=Drift.range(0.0, 1.0, nominal=0.0),
    b=Drift.range(0.0, 1.0, nominal=0.0),
    camera=Drift.choice("up", "down", "left"),
)


def test_each_option_has_its_own_search(leading: list[Any]) -> None:
    both = made(MIXED)
    assert [one.base["camera"] for one in both.options] == [1.0, 2.0]  # type: ignore[index]
    assert all(one.tried is both.nearest.tried for one in both.options)
    one_range = space_of(a=Drift.range(0.0, 1.0, nominal=0.0), camera=Drift.choice("up", "down"))
    assert made(one_range).options == []


def test_leading_search_has_the_nearest_failure(leading: list[Any]) -> None:
    both = made(MIXED)
    down, left = both.options
    assert both._leading is both.nearest
    both.nearest.best = {**MIXED.nominal, "a": 1.0, "b": 0.9}  # type: ignore[misc]
    down.best = {**MIXED.nominal, "camera": 1.0, "a": 0.2}  # type: ignore[misc]
    left.best = {**MIXED.nominal, "camera": 1.0, "a": 0.1}  # type: ignore[misc]
    assert both._leading is down
    down.best = None  # type: ignore[misc]
    assert both._leading is both.nearest


def test_options_are_explored_while_they_may_be_nearer(leading: list[Any]) -> None:
    both = made(MIXED)
    for one in both.together.curves:
        one.evidence[1.0] = both.evaluator.glance(one.ray.point(1.0))
    both._approach()
    assert both.nearest.calls[0] == ("approach", 3)  # type: ignore[attr-defined]
    rounds = combinations.ROUNDS
    assert [len(one.calls) for one in (both.nearest, *both.options)] == [rounds + 1, rounds, rounds]  # type: ignore[attr-defined]
    for one in (both.nearest, *both.options):
        one.calls.clear()  # type: ignore[attr-defined]
    both.nearest.best = {**MIXED.nominal, "a": 0.6, "b": 0.8}  # type: ignore[misc]
    both._approach()
    assert [len(one.calls) for one in both.options] == [0, 0]  # type: ignore[attr-defined]
    assert both.nearest.calls[1] == ("explore", 1, 1.0)  # type: ignore[attr-defined]


# the nearest failing drift


def test_small_components_are_dropped_if_the_vector_still_fails() -> None:
    model: Any = SimpleNamespace(excess=lambda vectors, errors: vectors[:, 0] - 0.5 + 0.0 * errors)
    assert _without_trifles(np.array([0.8, 0.11]), model, 0.0).tolist() == [0.8, 0.0]
    assert _without_trifles(np.array([0.8, 0.2]), model, 0.0).tolist() == [0.8, 0.2]
    needs: Any = SimpleNamespace(excess=lambda vectors, errors: vectors[:, 1] - 0.05)
    assert _without_trifles(np.array([0.8, 0.11]), needs, 0.0).tolist() == [0.8, 0.11]


def test_detectable_rate_lies_between_its_limits() -> None:
    nearest = Nearest(evaluator_of(lambda *_: (True, 10.0), CUBE), [])
    assert nearest._shown(0.0).depth == 0.03
    assert nearest._shown(1.0).depth == pytest.approx(3.8 / 8)
    assert nearest._shown(99.0).depth == 1.2
    assert 0.05 < nearest._share < 0.5


def test_stricter_prediction_needs_a_larger_excess() -> None:
    samples = [Sample(np.array([0.5, 0.0, 0.0]), 0.5, 0.1, 0, [("search", 0), ("search", 1)])]
    model = Prediction(
        Coordinates(CUBE, CUBE.nominal), GIVEN, samples, Shown(0.1, 0.25), typical=0.01, paired=0.0
    )
    deeper = model.deeper(2.0)
    assert (deeper.shown.depth, deeper.shown.share) == (0.2, 0.5)
    assert model.shown == Shown(0.1, 0.25)
    vectors = np.array([[0.5, 0.0, 0.0], [0.0, 0.9, 0.0]])
    assert model.excess(vectors) - deeper.excess(vectors) == pytest.approx([0.1, 0.1])
    assert Shown(0.1, 0.5).logit == 0.0
    assert Shown(0.1, 0.75).logit == pytest.approx(np.log(3.0))


def test_expected_failures_that_hardly_differ_are_listed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    nearest = Nearest(evaluator_of(lambda *_: (True, 10.0), CUBE), [])
    sizes = iter([0.5, 0.505, 0.52, None, 0.6])
    monkeypatch.setattr(Nearest, "best", drift(a=0.9, b=0.9))

    def predicted(self: Any, errors: float, depth: float, draws: Any) -> Point | None:
        size = next(sizes)
        return None if size is None else drift(a=size)

    monkeypatch.setattr(Nearest, "predicted", predicted)
    assert [point["a"] for point in nearest.expected([(0.0, 1.0)] * 5)] == [0.5, 0.52, 0.6]
    monkeypatch.setattr(Nearest, "best", None)
    assert nearest.expected([(0.0, 1.0)]) == []


def test_search_limit_is_two_percent_below_the_best_drift(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    nearest = Nearest(evaluator_of(lambda *_: (True, 10.0), CUBE), [])
    monkeypatch.setattr(Nearest, "best", drift(a=0.6, b=0.8))
    assert nearest._limit() == pytest.approx(0.98)
    monkeypatch.setattr(Nearest, "best", None)
    assert nearest._limit() == float("inf")
    assert Failure(drift(), 0.0, ()).names == ()
