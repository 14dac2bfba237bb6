"""Values between one that is too little and one far beyond it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pytest_tarl.patching.charts import offset
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.bisecting import JUMP, bisected, nearest, on_values
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.refining import amid
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_gains import constant
from tests.plugin.searching.test_preferring_by_hand import Scripted

FRONT = Unit((constant(3, "FRONT", 0.34),))


def scripted(low: float, high: float, tried: dict[float, float]) -> Scripted:
    """Return a search in which factors between two bounds reach the goal."""

    def run(candidate: Candidate, _: int) -> Outcome:
        factor = float(candidate.mutations[0].value)
        return Outcome(10.0, True) if low <= factor <= high else Outcome(0.0, False)

    made = Scripted([FRONT], run)
    for factor, gain in tried.items():
        made.gains.enter((FRONT, ALWAYS), factor, gain)
    made.holds = {(FRONT, factor) for factor in (3.809, 11.419)}
    return made


def test_value_beyond_the_good_range_is_moved_inside() -> None:
    search = scripted(3.0, 25.0, {2.2: 0.0})
    found = bisected(search, FRONT, 19.77, ALWAYS, 0)
    assert found is not None
    unit, factor, candidate = found
    assert (unit, factor) == (FRONT, 3.809)
    assert factor / 2.2 < JUMP
    assert float(candidate.mutations[0].value) == factor


@pytest.mark.parametrize(
    ("low", "tried", "factor", "values"),
    [
        (3.0, {2.2: 0.0}, 19.77, [6.595, 3.809, 3.117]),
        (8.0, {2.2: 0.0}, 19.77, [6.595, 11.419, 7.925]),
        (1.5, {}, 5.0, [2.236, 1.981]),
        (3.0, {2.2: 0.0}, 5.0, []),
        (1.1, {}, 2.2, []),
    ],
    ids=["below", "above", "nothing tried", "close", "near the old value"],
)
def test_halfway_values_are_tried_until_two_values_are_close(
    low: float, tried: dict[float, float], factor: float, values: list[float]
) -> None:
    search = scripted(low, 25.0, tried)
    bisected(search, FRONT, factor, ALWAYS, 0)
    assert [value for _, value in search.of("reaches")] == pytest.approx(values, abs=2e-3)


def test_the_search_also_bisects_towards_a_smaller_value() -> None:
    search = scripted(0.0, 0.25, {})
    found = bisected(search, FRONT, 0.02, ALWAYS, 0)
    first, second = (value for _, value in search.of("reaches")[:2])
    assert (first, second) == pytest.approx((0.141, 0.375), abs=2e-3)
    assert found is None  # not confirmed


def test_value_is_offered_only_if_a_smaller_one_passes() -> None:
    search = scripted(6.5, 25.0, {2.2: 0.0})
    assert bisected(search, FRONT, 19.77, ALWAYS, 0) is None
    assert search.of("holding") == []


def test_step_on_a_scale_is_compared_by_its_value() -> None:
    charted = replace(FRONT, chart=offset(5.3))
    plain, by = on_values(charted, 2.2)
    assert plain == FRONT
    assert by == pytest.approx(1.0 + 5.3 * 1.2 / 0.34)
    assert on_values(charted, 0.4) == (FRONT, None)  # a changed sign
    assert on_values(Unit((constant(3, "ON", True),)), 2.2)[1] is None
    assert on_values(Unit((constant(3, "ZERO", 0.0),)), 2.2)[1] is None


def test_nearest_factor_is_on_the_old_side() -> None:
    assert nearest(19.7, {2.2: 0.0, 5.0: 1.0, 30.0: 0.0, 0.4: 0.0}) == 5.0
    assert nearest(0.1, {0.4: 0.0, 0.05: 1.0, 2.2: 0.0}) == 0.4
    assert nearest(5.0, {}) == 1.0


@pytest.mark.parametrize(
    ("gains", "factors"),
    [
        ({1.0: 0.0, 2.2: 0.1, 5.0: -4.0}, [3.317]),
        ({1.0: 0.0, 0.4: 0.0, 0.15: -4.0}, [0.245]),
        ({1.0: 0.0, 2.2: -4.0, 5.0: -4.0}, []),
        ({1.0: 0.0, 2.2: 3.0, 5.0: -4.0}, []),
        ({1.0: 0.0, 2.2: 0.0, 3.0: -4.0}, []),
        ({1.0: 0.0, 2.2: -4.0}, []),
    ],
    ids=["up", "down", "both lose", "a gain is refined", "close", "first step"],
)
def test_value_between_too_little_and_too_much_is_tried(
    gains: dict[float, float], factors: list[float]
) -> None:
    assert amid(gains, 0.5) == factors
