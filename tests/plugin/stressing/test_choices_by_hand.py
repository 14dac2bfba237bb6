"""Which drifts a stress search chooses next, with scripted models, episodes and random numbers."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Drift
from pytest_tarl.learning.bounds import Range
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import evolving, holding, nearest
from pytest_tarl.stressing.boundary import bisect
from pytest_tarl.stressing.combinations import Combined, Together
from pytest_tarl.stressing.coordinates import Coordinates
from pytest_tarl.stressing.evaluating import NEAREST, SPENT
from pytest_tarl.stressing.findings import NEAR_RISK, Curve, failure
from pytest_tarl.stressing.guarantee import (
    Guarantee,
    Outcome,
    enough_pass,
    examined,
    hopeless,
    little_lost,
    margin_of,
    most_passed,
    refuted,
    unlike_recorded,
)
from pytest_tarl.stressing.kept import _as_bytes, _as_point
from pytest_tarl.stressing.margins import read
from pytest_tarl.stressing.nearest import BOLD, GAIN, LARGEST, PREDICTED, SPREAD, TRIES, Nearest
from pytest_tarl.stressing.prediction import NEAR, ROUNDS, Prediction, Sample, Shown
from pytest_tarl.stressing.rays import rays
from pytest_tarl.stressing.regions import outwards
from pytest_tarl.stressing.spreading import ASIDE, CLOSEST, around, spread
from pytest_tarl.stressing.stress_run import _executed, along
from pytest_tarl.stressing.words import directions, lines
from tests.plugin.stressing.test_words_by_hand import (
    DOWN,
    FLAT,
    GIVEN,
    GOOD,
    MUD,
    SPACE,
    STEEP,
    curve,
    seen,
    stress,
)
from tests.plugin.stressing.worlds import evaluator_of, space_of

SQUARE = space_of(a=Drift.range(0.0, 1.0, nominal=0.0), b=Drift.range(0.0, 1.0, nominal=0.0))


def drift(a: float, b: float = 0.0) -> Point:
    return {"a": a, "b": b}


class Model:
    """A model that predicts the given shortest vectors in turn, and notes how bold each prediction is."""

    def __init__(self, shortest: list[Any], promising: Any = None) -> None:
        self.vectors, self.promised = list(shortest), promising
        self.bold: list[float] = []
        self.limits: list[float] = []

    def shortest(self, errors: float, limit: float, draws: Any) -> Any:
        self.bold.append(errors)
        return self.vectors.pop(0)

    def promising(self, limit: float, draws: Any) -> Any:
        self.limits.append(limit)
        return self.promised


def searching(
    monkeypatch: pytest.MonkeyPatch, model: Model, best: Point | None = None, space: Any = SQUARE
) -> Any:
    """Return a search with a scripted model and best drift; `probed` lists the drifts that it tries."""
    found: Any = Nearest(evaluator_of(lambda *_: (True, 10.0), space), [])
    probed: list[Point] = []
    monkeypatch.setattr(Nearest, "model", lambda self: model)
    monkeypatch.setattr(Nearest, "best", best)
    monkeypatch.setattr(Nearest, "_probe", lambda self, point: probed.append(point) or 1.0)
    found.probed = probed
    return found


def test_predictions_allow_for_errors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model = Model([np.array([0.5, 0.0]), np.array([0.4, 0.0]), np.array([0.3, 0.0])])
    search = searching(monkeypatch, model)
    search._predict()
    assert search.probed == [drift(0.5), drift(0.4), drift(0.3)]
    assert model.bold == [-one for one in BOLD[:PREDICTED]]


@pytest.mark.parametrize(
    ("best", "limit", "gain", "tried"),
    [
        (None, LARGEST, GAIN * LARGEST, 3),
        (None, LARGEST, 0.99 * GAIN * LARGEST, 0),
        (drift(0.6, 0.8), 1.0, GAIN, 3),
    ],
)
def test_most_promising_drift_is_tried_without_predictions(
    best: Point | None, limit: float, gain: float, tried: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = Model([None, None, None], (np.array([0.2, 0.1]), gain))
    search = searching(monkeypatch, model, best)
    search._predict()
    assert model.limits == pytest.approx([limit] * 3)
    assert search.probed == [drift(0.2, 0.1)] * tried


def test_a_search_in_one_direction_neither_predicts_nor_explores(monkeypatch: pytest.MonkeyPatch) -> None:
    line = space_of(a=Drift.range(0.0, 1.0, nominal=0.0))
    search = searching(monkeypatch, Model([]), space=line)
    search._predict()
    search._explore()
    assert search.probed == []


@pytest.mark.parametrize(("best", "generated"), [(None, 1), (drift(0.5), 0)])
def test_hypothesis_explores_only_while_no_drift_fails(
    best: Point | None, generated: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    trail: list[Any] = []
    search = searching(monkeypatch, Model([]), best)
    monkeypatch.setattr(Nearest, "_predict", lambda self: trail.append("predict"))
    monkeypatch.setattr(Nearest, "_generate", lambda self: trail.append("generate"))
    monkeypatch.setattr(Nearest, "explore", lambda self, rounds: trail.append(rounds))
    search.approach(7)
    assert trail == ["predict", *["generate", "predict"] * generated, 7]


def test_exploration_and_prediction_alternate(monkeypatch: pytest.MonkeyPatch) -> None:
    trail: list[str] = []
    search = searching(monkeypatch, Model([]))
    for name in ("predict", "explore", "descend"):
        monkeypatch.setattr(Nearest, f"_{name}", lambda self, name=name: trail.append(name))
    search.explore(2)
    assert trail == ["explore", "predict"] * 2
    trail.clear()
    search.refine()
    assert trail == ["predict", "descend"] * nearest.ROUNDS


def test_search_evolves_and_then_shrinks_the_best_drift(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    trail: list[Any] = []
    search = searching(monkeypatch, Model([]), drift(0.5))
    monkeypatch.setattr(Nearest, "_predict", lambda self: trail.append("predict"))
    monkeypatch.setattr(Nearest, "explore", lambda self, rounds: trail.append(rounds))
    monkeypatch.setattr(Nearest, "_evolve", lambda self: trail.append("evolve"))
    monkeypatch.setattr(nearest, "shrunk", lambda point, evaluator: drift(0.25))
    search.improve()
    assert trail == ["predict", nearest.AGAIN, "evolve"]
    assert search.tried == [drift(0.25)]
    monkeypatch.setattr(Nearest, "best", None)
    search.tried.clear()
    search.improve()
    assert search.tried == []


def test_evolution_starts_at_the_best_drift(monkeypatch: pytest.MonkeyPatch) -> None:
    starts: list[Any] = []

    def evolve(start: Any, size: float, draws: Any, margin: Any) -> None:
        starts.append((start.tolist(), size))
        while margin(np.array([0.3, 0.3])) is not None:
            pass

    monkeypatch.setattr(nearest, "evolve", evolve)
    search = searching(monkeypatch, Model([]), drift(0.6, 0.8))
    search._evolve()
    assert starts == [([0.6, 0.8], pytest.approx(SPREAD))]
    assert len(search.probed) == TRIES
    starts.clear()
    unknown = searching(monkeypatch, Model([]), None)
    unknown._evolve()
    assert starts == [([0.5, 0.5], SPREAD)]


def test_a_probe_runs_more_episodes_only_while_they_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    for margins, examined_at in (
        (["holds"], []),
        (["open-", "holds"], [4]),
        (["open-", "open-", "fails"], [4, 8]),
        (["fails"], []),
    ):
        asked: list[int] = []
        results = iter(
            [
                seen(-0.1 if one == "open-" else 1.0 if one == "holds" else -1.0, one.strip("-"))
                for one in margins
            ]
        )
        evaluator: Any = SimpleNamespace(
            glance=lambda point, turn, results=results: next(results),
            examine=lambda point, most, results=results, asked=asked: asked.append(most) or next(results),
        )
        search = Nearest(evaluator, [])
        search._probe(drift(0.5))
        assert asked == examined_at
        assert search.tried == [drift(0.5)]


def test_detectable_failure_rate_exceeds_the_refuting_rate() -> None:
    evaluator = evaluator_of(lambda *_: (True, 10.0), SQUARE)
    search = Nearest(evaluator, [], risk=0.02)
    most = most_passed(evaluator.guarantee, NEAREST[-1], 0.02 * SPENT[-1])
    share = (NEAREST[-1] - most) / NEAREST[-1]
    assert search._share == pytest.approx(share + 0.6 * math.sqrt(share * (1 - share) / NEAREST[-1]))
    hopeless_ = Nearest(evaluator, [], risk=1e-99)
    evaluator.guarantee = replace(evaluator.guarantee, rate=0.01)
    assert hopeless_._share == 0.99


def test_bisection_stops_at_a_fiftieth_of_the_range() -> None:
    space = space_of(b=Drift.range(-1.0, 1.0, nominal=0.0))
    evaluator = evaluator_of(lambda point, _: (point["b"] < 0.6, 10.0), space)
    one = Curve(
        rays(space, {})[1], {0.5: evaluator.examine({"b": 0.5}, 16), 0.75: evaluator.examine({"b": 0.75}, 16)}
    )
    bisect(one, evaluator)
    assert one.bracket == (0.59375, 0.625)  # 0.03125 of a ray that is half of the range


# random drifts


def test_spread_vectors_respect_lengths_and_signs() -> None:
    coordinates = Coordinates(SPACE, SPACE.nominal)
    found = [
        vector for vector, _ in zip(spread(coordinates, np.random.default_rng(3)), range(200), strict=False)
    ]
    lengths = [float(np.linalg.norm(one)) for one in found]
    assert CLOSEST <= min(lengths) < 0.45
    assert 0.95 < max(lengths) <= 1.0
    assert all(one[0] <= 0.0 for one in found)  # mud is nominal at its upper end
    assert {bool(one[1] < 0.0) for one in found} == {True, False}
    unchanged = sum(one[0] == 0.0 for one in found)
    assert 20 <= unchanged <= 65  # a fifth, apart from vectors without any change


def test_nearby_vectors_move_by_a_quarter() -> None:
    draws: Any = SimpleNamespace(
        standard_normal=lambda count: np.array([1.0, 0.0]), uniform=lambda low, high: 0.9
    )
    found = next(around(Coordinates(SQUARE, SQUARE.nominal), np.array([0.4, 0.3]), draws))
    moved = np.array([0.4 + ASIDE * 0.5, 0.3])
    assert found == pytest.approx(moved / np.linalg.norm(moved) * 0.45)


def test_best_random_vector_is_refined() -> None:
    samples = [Sample(np.array([0.5, 0.0]), 0.5, 0.1, 0, [("search", 0), ("search", 1)])]
    model = Prediction(Coordinates(SQUARE, SQUARE.nominal), GIVEN, samples, Shown(0.1, 0.25), 0.01, 0.0)
    shapes: list[int] = []

    def score(vectors: np.ndarray) -> np.ndarray:
        shapes.append(len(vectors))
        found: np.ndarray = -np.abs(vectors - np.array([0.37, 0.61])).sum(axis=1)
        return found

    vector, highest = model._largest(score, 2.0, np.random.default_rng(0))
    assert vector == pytest.approx([0.37, 0.61], abs=0.02)
    assert highest == pytest.approx(0.0, abs=0.03)
    assert shapes == [400 + 3, *[100] * ROUNDS]
    short, _ = model._largest(score, 0.3, np.random.default_rng(0))
    assert np.linalg.norm(short) <= 0.3 + 1e-9


def test_random_drifts_are_compared_with_the_shortest() -> None:
    lengths = np.linspace(0.01, 1.0, 100)
    samples = [
        Sample(np.array([one, 0.0]), 2.0 * one, 0.01, 0, [("search", number)])
        for number, one in enumerate(lengths)
    ]
    model = Prediction(Coordinates(SQUARE, SQUARE.nominal), GIVEN, samples, Shown(0.1, 0.25), 0.01, 0.0)
    near = model._promising_known(0.8)[:, 0]
    assert len(near) == NEAR
    assert near[0] == pytest.approx(0.55, abs=0.03)  # the first that loses 1.1
    assert (np.diff(near[:20]) > 0.0).all()  # the failing ones follow by length
    assert 0.8 / 0.9 > near.max() > 0.8  # a longer one that fails as well when shortened
    assert near.min() < 0.5  # then those that almost fail


def test_error_allowance_lowers_the_excess() -> None:
    sources = [("search", number) for number in range(8)]
    failing = [
        Sample(np.array([0.9, 0.0]), 0.1, 0.01, 8, sources),
        Sample(np.array([0.1, 0.0]), 0.0, 0.01, 0, sources),
    ]
    model = Prediction(Coordinates(SQUARE, SQUARE.nominal), GIVEN, failing, Shown(0.1, 0.25), 0.01, 0.0)
    near = np.array([[0.9, 0.0], [0.6, 0.0]])
    (means, deviations), _ = model._moments(near)
    assert (model.excess(near) > means - 1.1 + 0.1).all()  # failures exceed what is tolerated, losses do not
    assert (model.excess(near, 1.0) < model.excess(near)).all()
    assert (model.excess(near, -1.0) > model.excess(near)).all()
    assert (deviations > 0.0).all()


def test_evolution_ends_at_an_unknown_margin(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def margin(vector: Any) -> float | None:
        asked.append(vector.tolist())
        return None if len(asked) == 9 else float(((vector - 0.2) ** 2).sum())

    evolving.evolve(np.array([0.5, 0.5]), 0.3, np.random.default_rng(1), margin)
    assert len(asked) == 9
    again: list[Any] = []
    evolving.evolve(
        np.array([0.5, 0.5]), 0.3, np.random.default_rng(1), lambda one: again.append(one.tolist())
    )
    assert again == asked[:1]


# what episodes show


def outcomes(*totals: float, failed: int = 0) -> list[Outcome]:
    return [Outcome(number >= failed, total) for number, total in enumerate(totals)]


USUAL = outcomes(*[10.0] * 64)


def test_eight_good_episodes_show_the_guarantee() -> None:
    one = examined(GIVEN, outcomes(*[9.9] * 8), USUAL[:8])
    assert (one.result, one.episodes, one.passed, one.loss, one.spread) == (
        "holds",
        8,
        8,
        pytest.approx(0.1),
        pytest.approx(0.0, abs=1e-9),
    )
    assert examined(GIVEN, outcomes(*[9.9] * 7), USUAL[:7]).result == "open"
    assert examined(GIVEN, outcomes(*[9.9] * 8, failed=1), USUAL[:8]).result == "open"
    assert examined(GIVEN, outcomes(*[9.0] * 4), USUAL[:4]).result == "fails"
    assert examined(GIVEN, outcomes(*[10.0] * 8, failed=6), USUAL[:8]).result == "fails"
    assert examined(GIVEN, outcomes(9.0), USUAL[:1]).spread == 0.0


def test_margin_with_failures_has_a_minimum_error() -> None:
    margin, error = margin_of(replace(GIVEN, share=1.0), outcomes(*[10.0] * 64, failed=1), USUAL)
    assert margin == pytest.approx((63 / 64 - 0.9) / 0.1)
    assert error > 0.1
    flat, error = margin_of(replace(GIVEN, rate=0.0), outcomes(*[10.0] * 64, failed=1), USUAL)
    assert error == 0.1
    assert margin_of(GIVEN, outcomes(*[-99.0] * 4), USUAL[:4])[0] == -1.5
    assert margin_of(replace(GIVEN, tolerance=0.0), outcomes(*[10.0] * 4), USUAL[:4]) == (1.0, 1.0)
    assert flat <= 1.0


def test_test_of_one_part_ignores_the_other() -> None:
    losing, failing = outcomes(*[9.0] * 32), outcomes(*[10.0] * 32, failed=16)
    for part, by_loss, by_rate in (("both", True, True), ("loss", True, False), ("rate", False, True)):
        found = [refuted(GIVEN, one, USUAL[:32], 0.01, part) for one in (losing, failing)]  # type: ignore[arg-type]
        assert found == [by_loss, by_rate]


def test_hopeless_test_can_refute_neither_part() -> None:
    fine, failing = outcomes(*[10.0] * 16), outcomes(*[10.0] * 16, failed=4)
    assert hopeless(GIVEN, fine, USUAL[:16], 32, 0.01)
    assert not hopeless(GIVEN, failing, USUAL[:16], 64, 0.01)
    assert hopeless(GIVEN, failing, USUAL[:16], 64, 0.01, "loss")
    assert not hopeless(GIVEN, outcomes(*[9.45] * 16), USUAL[:16], 64, 0.01)
    assert hopeless(GIVEN, outcomes(*[9.45] * 16), USUAL[:16], 64, 0.01, "rate")


def test_enough_passes_show_the_guarantee_at_a_risk() -> None:
    assert enough_pass(GIVEN, USUAL[:29], 0.05)
    assert not enough_pass(GIVEN, USUAL[:28], 0.05)
    assert little_lost(GIVEN, outcomes(*[9.9] * 16), USUAL[:16], 0.05)
    assert not little_lost(GIVEN, outcomes(*[9.4] * 16), USUAL[:16], 0.05)
    declared = replace(GIVEN, declared=Range(0.0, 10.0))
    assert not little_lost(
        declared, outcomes(*[9.9] * 16), USUAL[:16], 0.05
    )  # 16 episodes bound a range of 20 badly


def test_failing_nominal_world_differs_from_the_recording() -> None:
    assert not unlike_recorded(GIVEN, outcomes(*[10.0] * 16), 0.01)
    assert unlike_recorded(GIVEN, outcomes(*[10.0] * 16, failed=8), 0.01)
    assert unlike_recorded(GIVEN, outcomes(*[5.0] * 16), 0.01)
    assert not unlike_recorded(GIVEN, outcomes(*[9.6] * 16), 0.01)


# how far the guarantee holds


def test_farther_value_is_tested_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def holds(ray: Any, t: float, evaluator: Any, risk: float, paired: int) -> bool:
        asked.append((t, risk, paired))
        return t < 0.6

    monkeypatch.setattr(holding, "holds", holds)
    evaluator: Any = SimpleNamespace(guarantee=GIVEN)
    one = curve(MUD, {0.5: 1.0, 1.0: 1.0})
    holding.hold(one, evaluator)
    assert asked == [(1.0, pytest.approx(0.85 * NEAR_RISK), 32), (0.5, pytest.approx(0.15 * NEAR_RISK), 32)]
    assert one.held == 0.5
    option = curve(DOWN, {1.0: 1.0})
    asked.clear()
    holding.hold(option, evaluator)
    assert asked == [(1.0, pytest.approx(0.85 * NEAR_RISK), 16)]  # a value of 0 is not tested
    assert option.held is None


@pytest.mark.parametrize(("failed", "shown", "spent"), [(0, True, 1), (1, True, 2), (2, False, 1)])
def test_longer_second_test_allows_one_failure(
    failed: int, shown: bool, spent: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    sizes: list[int] = []
    first, second = (
        holding.least(0.9, allowed, share * 0.05) for allowed, share in enumerate(holding.SHARES)
    )
    evaluator: Any = SimpleNamespace(
        guarantee=GIVEN,
        space=SPACE,
        affords=lambda point, episodes, paired: sizes.append(episodes) or True,
        fresh=lambda point, size: outcomes(*[10.0] * size, failed=failed if point != SPACE.nominal else 0),
    )
    assert holding.holds(MUD, 0.5, evaluator, 0.05, 16) is shown
    assert sizes == [first, second][:spent]


def test_nothing_is_shown_if_the_budget_is_spent() -> None:
    def evaluator(total: float, affordable: bool = True) -> Any:
        return SimpleNamespace(
            guarantee=GIVEN,
            space=SPACE,
            affords=lambda *_: affordable,
            fresh=lambda point, size: outcomes(*[10.0 if point == SPACE.nominal else total] * size),
        )

    assert holding.holds(MUD, 0.5, evaluator(9.9), 0.05, 16)
    assert not holding.holds(MUD, 0.5, evaluator(9.3), 0.05, 16)
    assert not holding.holds(MUD, 0.5, evaluator(9.9, affordable=False), 0.05, 16)


# rays, files and sentences


def test_ray_through_a_failure_ends_with_its_first_direction() -> None:
    found = outwards(SPACE, failure(SPACE, {**SPACE.nominal, "mud": 3.0, "slope": 0.5, "camera": 1.0}))
    assert found.farthest == {"mud": 2.0, "slope": 1.0, "camera": 1.0}
    assert found.names == ("mud", "slope", "camera")
    only = outwards(SPACE, failure(SPACE, {**SPACE.nominal, "camera": 2.0}))
    assert only.farthest == {**SPACE.nominal, "camera": 2.0}


@pytest.mark.parametrize(
    ("value", "kept"),
    [
        ({"mud": 0.0, "slope": -1.0, "camera": 2}, True),
        ({"mud": -0.1, "slope": 0.0, "camera": 0}, False),
        ({"mud": 1.0, "slope": 1.1, "camera": 0}, False),
        ({"mud": 1.0, "slope": 0.0, "camera": 3}, False),
        ({"mud": 1.0, "slope": 0.0, "camera": 0.5}, False),
        ({"mud": 1.0, "slope": 0.0}, False),
        ({"mud": 1.0, "slope": 0.0, "camera": 0, "more": 1}, False),
        ({"mud": 4.0, "slope": 0.0, "camera": 0}, False),  # nominal
        ({"mud": "1", "slope": 0.0, "camera": 0}, False),
        ([1, 2], False),
    ],
)
def test_only_drifts_of_the_space_are_read_back(value: Any, kept: bool) -> None:
    data = _as_bytes(value) if isinstance(value, dict) else b"[1, 2]"
    assert (_as_point(data, SPACE) is not None) is kept


def test_margin_file_with_a_nominal_end_is_refused() -> None:
    text = (
        '{"format": 1, "test": "t", "drift": "d", "guarantee": {"success": 0.9, "loss": 1}, "confidence": 0.9, '
        '"directions": [{"name": "a", "nominal": 0, "end": %s, "holds_to": null, "fails_at": 0.5}]}'
    )
    found = read((text % "2").encode(), "m.json")
    assert (found.title, found.sides[0].share(0.5), found.sides[0].holds_to) == ("t[d]", 0.25, None)
    for wrong in ("0", '"x"', "1e999"):
        with pytest.raises(Exception, match=r"^m\.json: not a file of margins"):
            read((text % wrong).encode(), "m.json")


def test_report_has_one_label_per_block() -> None:
    told = list(
        lines(
            stress(
                curve(MUD, GOOD, confirmed=0.75),
                curve(STEEP, {1.0: 1.0}, swept=False),
                curve(FLAT, {1.0: 1.0}),
            )
        )
    )
    assert told[0] == "t.py::test_a[world]: stress, 150 episodes"
    assert told[1].startswith("  guarantee  At least 90 % of the episodes pass")
    assert told[2].startswith("  mud        No failure found while mud ≥")
    ended = list(lines(stress(ended="nominal")))
    assert len(ended) == 3
    assert ended[2].startswith("  nominal    The guarantee already fails at the nominal values")


def test_both_sides_of_a_range_are_printed_together() -> None:
    found = dict(directions(stress(curve(FLAT, GOOD), curve(STEEP, {1.0: 1.0}), curve(DOWN, swept=False))))
    assert list(found) == ["slope", "camera"]
    assert len(found["slope"]) == 2
    assert found["camera"] == ["Not examined with camera='down'."]
    nothing = dict(directions(stress(curve(FLAT, swept=False), curve(STEEP, swept=False))))
    assert nothing == {"slope": ["Not examined."]}
    calm = dict(directions(stress(curve(FLAT, {0.5: 1.0, 1.0: 1.0}), curve(STEEP, {1.0: 1.0}))))
    assert calm == {"slope": ["Not affected by slope: no failure found from -1 to 1 (3 values)."]}


def test_interrupted_run_searches_no_statements(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from pytest_tarl.stressing import stress_run

    monkeypatch.setattr(
        stress_run,
        "statements",
        lambda source, evaluator, curves, failures: [one.distance for one in failures],
    )
    together: Any = SimpleNamespace(
        curves=[curve(STEEP, {0.5: -1.0}, confirmed=0.5)],
        found=[failure(SPACE, {**SPACE.nominal, "slope": 0.1, "mud": 3.9})],
    )
    request: Any = SimpleNamespace(source="source")
    evaluator: Any = None
    found, ended = _executed(request, evaluator, together, "")
    assert (found, ended) == ([pytest.approx(math.hypot(0.05, 0.025)), 0.25], "")
    assert _executed(request, evaluator, together, "interrupted") == (None, "interrupted")
    assert _executed(SimpleNamespace(source=None), evaluator, together, "budget") == (None, "budget")  # type: ignore[arg-type]


def test_one_ray_has_at_most_the_risk_of_a_far_end(monkeypatch: pytest.MonkeyPatch) -> None:
    from pytest_tarl.stressing import stress_run

    asked: list[Any] = []
    monkeypatch.setattr(stress_run, "_evaluator", lambda request, space: "evaluator")
    monkeypatch.setattr(stress_run, "along_rays", lambda curves, evaluator, share: asked.append(share))
    monkeypatch.setattr(stress_run, "near_ends", lambda curves, evaluator: asked.append(len(curves)))
    for alpha, share in ((0.01, 0.01), (0.5, 0.1 / 6)):
        request: Any = SimpleNamespace(
            designation=SimpleNamespace(drifts={"d": SimpleNamespace(value=SPACE)}),
            drift="d",
            options=SimpleNamespace(alpha=alpha),
        )
        assert along(request, MUD).ray is MUD
        assert asked == [pytest.approx(share), 1]
        asked.clear()


def test_a_guarantee_is_printed_with_its_rate_and_tolerance() -> None:
    (told,) = [
        one for one in lines(stress(guarantee=Guarantee(0.9543, 0.12345, (1.0,), 1.0))) if "guarantee " in one
    ][:1]
    assert told.endswith(
        "At least 95.43 % of the episodes pass, and the mean reward is at most 0.123 below the recorded one."
    )


# the end of the budget


def test_map_is_drawn_without_a_budget() -> None:
    space = space_of(
        a=Drift.range(0.0, 1.0, nominal=0.0),
        b=Drift.range(0.0, 1.0, nominal=0.0),
        camera=Drift.choice("up", "down"),
    )
    evaluator = evaluator_of(lambda point, _: (not point["camera"], 10.0), space)
    curves = [Curve(ray) for ray in rays(space, {})]
    both = Combined(evaluator, Together(0.01, curves))
    for one in curves:
        for t in one.ray.places:
            one.evidence[t] = evaluator.glance(one.ray.point(t))
    spent, evaluator.budget = evaluator.spent, evaluator.spent
    both.draw()  # more episodes of the failing option would decide whether it fails
    assert both.nearest.best is None
    evaluator.budget = 1000
    both.draw()
    assert (both.together.expected, evaluator.spent) == ([], spent)
    assert both.nearest.best == {**space.nominal, "camera": 1.0}
