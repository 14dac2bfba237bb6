"""Estimated Sobol indices equal the known ones of small worlds."""

from __future__ import annotations

import json
from dataclasses import replace

import jsonschema
import numpy as np
import pytest

from pytest_tarl import Drift, extras
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import delivering, json_result, page, words
from pytest_tarl.stressing.sobol_indices import ROWS, affordable, sobol
from tests.plugin.stressing.worlds import evaluator_of, space_of, stressed

pytest.importorskip("SALib")

RANGE = Drift.range(0.0, 1.0, nominal=0.0)
SPACE = space_of(a=RANGE, b=RANGE, **{"c<": Drift.choice("up", "down")})


def added(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
    return True, 10.0 - 0.2 * point["a"] - 0.1 * point["b"] + float(draws.normal(0.0, 3.0))


def multiplied(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
    return True, 10.0 + (point["a"] - 0.5) * (point["b"] - 0.5)


def test_additive_directions_have_correct_first_order_indices_despite_noise() -> None:
    found = sobol(evaluator_of(added, SPACE, budget=400))
    assert found is not None
    assert found.episodes == 64 * 6
    a, b, c = found.shares  # variances 0.2² : 0.1²
    assert (a.first, a.total) == pytest.approx((0.8, 0.8), abs=0.05)
    assert (b.first, b.total) == pytest.approx((0.2, 0.2), abs=0.05)
    assert (c.first, c.total) == (0.0, 0.0)
    assert abs(a.first - 0.8) <= a.first_error


def test_interacting_directions_have_large_total_indices() -> None:
    found = sobol(evaluator_of(multiplied, SPACE, budget=800))
    assert found is not None
    for one in found.shares[:2]:
        assert abs(one.first) < 0.15
        assert one.total > 0.8


def test_deciding_option_has_all_variance() -> None:
    found = sobol(evaluator_of(lambda point, _: (point["c<"] < 1.0, 1.0), SPACE, budget=400))
    assert found is not None
    assert [round(one.total, 1) for one in found.shares] == [0.0, 0.0, 1.0]
    found = sobol(evaluator_of(lambda *_: (True, 1.0), SPACE, budget=400))
    assert found is not None
    assert not any(one.total for one in found.shares)


def test_always_failing_draws_say_nothing_about_directions() -> None:
    found = sobol(evaluator_of(lambda point, _: (point["a"] == point["b"] == 0.0, 1.0), SPACE, budget=400))
    assert found is not None
    assert found.hopeless
    (told,) = words.sobol_words(replace(stressed(added, SPACE, budget=150, combined=False), sobol=found))
    assert told.startswith("All 384 episodes drawn from the whole space fail clearly")
    found = sobol(evaluator_of(lambda *_: (True, 1.0), SPACE, budget=400))
    assert found is not None
    assert not found.hopeless


def test_the_sample_is_as_large_as_the_budget_allows() -> None:
    assert affordable(1, 10**6) == 0  # one direction explains everything
    assert affordable(4, 32 * 7 - 1) == 0
    assert affordable(4, 32 * 7) == 32
    assert affordable(4, 10**6) == max(ROWS)
    evaluator = evaluator_of(added, SPACE, budget=191)
    assert sobol(evaluator) is None
    assert evaluator.spent == 0


def test_reports_state_the_variance_shares() -> None:
    state = np.random.get_state()[1]
    found = stressed(added, SPACE, budget=600, variance=True, combined=False)
    assert (np.random.get_state()[1] == state).all()  # nodes may use the global generator
    document = json.loads(json_result.text(replace(found, test="t")))
    jsonschema.validate(document, json_result.schema())
    assert [one["name"] for one in document["sobol"]["directions"]] == ["a", "b", "c<"]
    (told,) = [line for line in words.lines(found) if line.startswith("  variance")]
    assert told.index("space: a ") < told.index("; b ") < told.index("; c< 0 % alone")
    assert "<h2>Variance</h2>" in page.render(found)
    assert "<td>c&lt;<td>" in page.render(found)
    assert found == stressed(added, SPACE, budget=600, variance=True, combined=False)
    small = stressed(added, SPACE, budget=150, variance=True, combined=False)
    assert small.sobol is None
    assert "variance" not in "".join(words.lines(small))
    assert json_result.document(small)["sobol"] is None


def test_missing_salib_is_named_and_changes_no_result(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = stressed(added, SPACE, budget=600, variance=True, combined=False)
    monkeypatch.setattr(extras, "SOBOL", ("no_such_package",))
    found = stressed(added, SPACE, budget=600, variance=True, combined=False)
    assert found.sobol is None
    assert found.curves == whole.curves
    (line,) = delivering._without_salib(found)
    assert "no_such_package, which is not installed" in line
    assert "[sobol]" in line
    assert delivering._without_salib(replace(found, ended="interrupted")) == ()
