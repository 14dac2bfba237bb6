"""Small parts of the stress search with values worked out by hand: noise, coordinates, figures, pages, files."""

from __future__ import annotations

import re
from dataclasses import replace
from math import sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Drift
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import delivering, page
from pytest_tarl.stressing.combinations import _apart, pairs
from pytest_tarl.stressing.coordinates import Coordinates
from pytest_tarl.stressing.failing_statements import chosen, only_in_failures, places_in
from pytest_tarl.stressing.fields import relevant
from pytest_tarl.stressing.findings import (
    APART,
    Attempt,
    Boundary,
    Draws,
    Executed,
    Failure,
    Moved,
    Share,
    Sobol,
    Statements,
    contains,
    failure,
    place_on,
)
from pytest_tarl.stressing.generating import _number, _point
from pytest_tarl.stressing.guarantee import Evidence, Guarantee, hopeful
from pytest_tarl.stressing.holding import least
from pytest_tarl.stressing.loss_noise import (
    HIGHEST,
    cut_off,
    nominal_variance,
    standard_error,
    typical_variance,
    variance_near,
)
from pytest_tarl.stressing.mapping import importance, lost
from pytest_tarl.stressing.margins import margins, text
from pytest_tarl.stressing.prediction import _normal, _within
from pytest_tarl.stressing.rays import Ray, rays
from pytest_tarl.stressing.regions import end, regions
from pytest_tarl.stressing.surrogates import variance
from pytest_tarl.stressing.words import (
    _sign,
    broken_promises,
    of_point,
    repair_lines,
    sobol_words,
    statement_words,
)
from tests.plugin.stressing.test_words_by_hand import (
    DOWN,
    FLAT,
    GIVEN,
    GOOD,
    LEFT,
    MUD,
    SPACE,
    STEEP,
    curve,
    seen,
    stress,
)
from tests.plugin.stressing.worlds import space_of

# noise


def test_losses_are_cut_off_at_both_limits() -> None:
    assert cut_off([-9.0, 0.5, 9.0]).tolist() == [-1.5, 0.5, 2.5]
    assert HIGHEST == 2.5


def test_typical_variance_is_a_mean() -> None:
    one, other = np.array([0.0, 1.0]), np.array([0.0, 2.0])
    assert typical_variance([one, other]) == pytest.approx((0.5 + 2.0) / 2)
    assert typical_variance([one, np.array([3.0])]) == pytest.approx(0.5)
    assert typical_variance([np.array([1.0, 1.0]), one]) == pytest.approx(0.25)
    assert typical_variance([np.array([2.5, 2.5]), one]) == pytest.approx(0.5)
    assert typical_variance([np.array([1.0, 1.0])]) == 1e-6
    assert typical_variance([]) == 1e-6


def test_noisy_drift_counts_four_medians_at_most() -> None:
    calm = [np.array([0.0, 1.0]), np.array([0.0, 1.0])]
    assert typical_variance([*calm, np.array([-1.5, 2.5])]) == pytest.approx((0.5 + 0.5 + 2.0) / 3)


def test_nominal_variance_is_half_at_most() -> None:
    given = replace(GIVEN, totals=(9.0, 10.0, 11.0), tolerance=2.0)
    assert nominal_variance(given, 10.0) == pytest.approx(1.0 / 4.0)
    assert nominal_variance(given, 0.2) == pytest.approx(0.1)
    assert nominal_variance(replace(given, totals=(9.0,)), 10.0) == 5.0
    assert nominal_variance(replace(given, tolerance=0.0), 10.0) == 5.0


def test_variance_near_a_loss_is_weighted() -> None:
    near, far = np.array([0.5, 1.5]), np.array([-1.0, 1.0])
    weight = np.exp(-((1.0 / 0.3) ** 2) / 2.0)
    expected = (1.0 * 0.5 + weight * 2.0 + 2.0 * 0.1) / (1.0 + weight + 2.0)
    assert variance_near(1.0, [near, far], 0.1) == pytest.approx(expected)
    assert variance_near(1.0, [np.array([1.0]), np.array([2.5, 2.5])], 0.1) == 0.1


def test_a_standard_error_adds_four_episodes_of_typical_variance() -> None:
    assert standard_error(np.array([0.0, 2.0]), 0.5) == pytest.approx(sqrt((2.0 + 4 * 0.5) / 5 / 2))
    assert standard_error(np.array([1.0]), 0.5) == pytest.approx(sqrt(4 * 0.5 / 4 / 1))


# coordinates


def point(**changes: float) -> Point:
    return {**SPACE.nominal, **changes}


NOMINAL = Coordinates(SPACE, SPACE.nominal)
OTHER = Coordinates(SPACE, point(camera=2.0))


def test_drifts_are_converted_to_vectors_and_back() -> None:
    assert NOMINAL.vector(point(mud=1.0, slope=-0.5)).tolist() == [-0.75, -0.25]
    assert NOMINAL.point(np.array([-0.75, -0.25])) == point(mud=1.0, slope=-0.5)
    assert OTHER.point(np.array([0.0, 0.0])) == point(camera=2.0)


def test_vector_beyond_the_ranges_is_clipped() -> None:
    assert NOMINAL.point(np.array([-9.0, 9.0])) == point(mud=0.0, slope=1.0)
    assert NOMINAL.point(np.array([-1e-13, 1e-13])) == SPACE.nominal
    assert NOMINAL.point(np.array([-1e-11, 0.0]))["mud"] < 4.0


def test_base_knows_its_ranges_and_options() -> None:
    assert (NOMINAL.low.tolist(), NOMINAL.high.tolist()) == ([-1.0, -0.5], [0.0, 0.5])
    assert (NOMINAL.options, OTHER.options) == (0, 1)
    assert list(NOMINAL.spans) == ["mud", "slope"]


def test_coordinates_cover_the_options_of_their_base() -> None:
    assert NOMINAL.covers(point(mud=0.0))
    assert not NOMINAL.covers(point(camera=1.0))
    assert OTHER.covers(point(camera=2.0, slope=1.0))


def test_vector_is_shortened_to_its_limit() -> None:
    vector = np.array([-0.6, 0.3])
    assert NOMINAL.within(vector, 1.0) is not None
    found = NOMINAL.within(np.array([-0.8, 0.0]), 0.4)
    assert found is not None
    assert found[0] == pytest.approx(-0.4)
    assert OTHER.within(vector, 1.0) is None
    shorter = OTHER.within(np.array([-0.8, 0.0]), 1.25)
    assert shorter is not None
    assert shorter[0] == pytest.approx(-0.75)


# generated drifts


def test_drawn_bits_give_a_size_in_the_range() -> None:
    slope, mud, camera = (SPACE.extents[name] for name in ("slope", "mud", "camera"))
    assert [_number(slope, True, number) for number in (0, 7, 15)] == [1 / 16, 0.5, 1.0]
    assert [_number(slope, False, number) for number in (0, 15)] == [-1 / 16, -1.0]
    assert [_number(mud, side, 15) for side in (True, False)] == [0.0, 0.0]  # nominal is the upper end
    low = space_of(a=Drift.range(0.0, 1.0, nominal=0.0)).extents["a"]
    assert [_number(low, side, 3) for side in (True, False)] == [0.25, 0.25]
    assert [_number(camera, True, number) for number in range(4)] == [0.0, 1.0, 2.0, 0.0]


def test_a_direction_that_is_not_drawn_is_nominal() -> None:
    bits = (True, False, True, False)  # 1 + 4 = 5, so 6 sixteenths
    drawn = ((True, True, *bits), (False, True, *bits), (True, False, *bits))
    assert _point(SPACE, drawn) == {"mud": 4.0 - 4.0 * 6 / 16, "slope": 0.0, "camera": 2.0}


# predictions


def test_longer_vectors_get_a_random_length() -> None:
    vectors = np.array([[0.3, 0.4], [3.0, 4.0]])
    draws: Any = SimpleNamespace(random=lambda count: np.full(count, 1 / 16))
    assert _within(vectors, 1.0, draws)[0].tolist() == [0.3, 0.4]
    assert np.linalg.norm(_within(vectors, 1.0, draws)[1]) == pytest.approx(0.5)
    assert np.linalg.norm(_within(np.array([[0.6, 0.8]]), 1.0, draws)) == pytest.approx(1.0)


def test_the_normal_distribution_is_approximated_within_a_hundredth() -> None:
    assert _normal(np.array([0.0]))[0] == 0.5
    assert _normal(np.array([1.0, -1.0, 1.96])) == pytest.approx([0.8413, 0.1587, 0.975], abs=0.01)
    assert _normal(np.array([1e9, -1e9])) == pytest.approx([1.0, 0.0], abs=1e-20)


def test_irrelevant_direction_must_increase_the_evidence() -> None:
    vectors = np.array([[1.0, 0.0], [0.0, 1.0]])

    def field(prior: np.ndarray) -> Any:
        return SimpleNamespace(evidence=-prior[1, 1] + 0.5 * prior[0, 0])

    def units_of(size: float) -> float:
        return float(variance(np.array([[size, 0.0]]))[0])

    best, units = relevant(field, vectors)
    assert units.tolist() == [1.0, 0.3]
    assert best.evidence == pytest.approx(-units_of(0.3) + 0.5 * units_of(1.0))
    _, same = relevant(lambda prior: SimpleNamespace(evidence=1.0), vectors)
    assert same.tolist() == [1.0, 1.0]


# results


def test_a_boundary_without_a_confirmed_failure_is_unknown() -> None:
    assert curve(MUD, GOOD).boundary is None
    assert curve(MUD, {1.0: 1.0}, confirmed=1.0).boundary is None


def test_boundary_is_at_the_failure_without_a_margin_before() -> None:
    found = curve(MUD, {0.5: 0.0, 0.75: -1.0}, confirmed=0.75).boundary
    assert found == Boundary(0.5, None, 0.75, True)
    assert curve(DOWN, {1.0: -1.0}, confirmed=1.0).boundary == Boundary(1.0, None, 1.0, True)


def test_boundary_lies_between_holding_and_failing_values() -> None:
    found = curve(MUD, {0.25: 1.0, 0.5: -1.0}, confirmed=0.45, held=0.4)
    assert found.boundary == Boundary(0.4, 0.4, 0.45, True)
    found = curve(MUD, {0.25: 1.0, 0.5: -0.1}, confirmed=0.3, held=0.3)
    assert found.boundary == Boundary(0.3, None, 0.3, True)


def test_margin_falls_from_one_at_nominal() -> None:
    found = curve(MUD, {0.5: -1.0}, confirmed=0.5).boundary
    assert found is not None
    assert found.at == pytest.approx(0.25)


def test_undecided_negative_margin_is_a_failure() -> None:
    results = [("open", -0.1), ("open", 0.0), ("holds", -0.1), ("fails", 0.1)]
    assert [seen(margin, result).failing for result, margin in results] == [True, False, False, True]


def test_monotone_curve_never_holds_after_a_failure() -> None:
    assert curve(MUD, {0.5: 1.0, 1.0: 1.0}).monotone
    assert curve(MUD, {0.5: -1.0, 1.0: -1.0}).monotone
    assert not curve(MUD, {0.5: -1.0, 1.0: 1.0}).monotone


def test_a_failure_names_only_the_directions_that_changed() -> None:
    found = failure(SPACE, point(slope=0.5, camera=1.0))
    assert found.names == ("slope", "camera")
    assert found.distance == pytest.approx(sqrt(0.25**2 + 1.0))


def near(distance: float, **changes: float) -> Failure:
    return replace(failure(SPACE, point(**changes)), distance=distance)


def test_expected_failure_must_be_two_percent_nearer() -> None:
    one = stress(expected=(near(0.5, slope=0.5),), combinations=(near(0.6, slope=0.9, mud=1.0),))
    assert one.nearer == one.expected[0]
    limit = replace(one, combinations=(near(0.5 / 0.98, slope=0.9, mud=1.0),))
    assert replace(limit, expected=(near(0.5001, slope=0.5),)).nearer is None
    assert stress().nearer is None
    assert stress(expected=(near(9.0, slope=0.5),)).nearer is not None


def test_failures_are_sorted_by_distance_and_then_by_name() -> None:
    found = stress(
        curve(STEEP, {0.5: -1.0}, confirmed=0.5),
        combinations=(near(0.25, slope=0.5, mud=1.0), near(0.1, mud=3.0, slope=0.1)),
    )
    assert [one.names for one in found.failures] == [("mud", "slope"), ("mud", "slope"), ("slope",)]
    assert [one.distance for one in found.failures] == [0.1, 0.25, 0.25]


# combinations


def test_containing_failures_must_be_farther() -> None:
    evaluator: Any = SimpleNamespace(space=SPACE)
    small = near(1.0, slope=0.5, mud=2.0)
    for distance, kept in ((APART - 0.005, 1), (APART, 2), (APART + 0.005, 2)):
        larger = near(distance, slope=0.6, mud=2.0)
        assert len(_apart([larger, small], evaluator)) == kept
    aside = near(1.005, slope=-0.5, mud=2.0)
    assert _apart([aside, small], evaluator) == [aside, small]


def test_each_place_along_a_single_direction_is_found_on_its_own_ray_only() -> None:
    space = space_of(mud=Drift.range(-1.0, 1.6, nominal=-0.78), tool=Drift.choice("old", "new", "worn"))
    along = rays(space, {"mud": [0.0]})
    for ray in along:
        for t in ray.places:
            one = failure(space, ray.point(t))
            assert place_on(ray, one) == pytest.approx(t)
            assert [other for other in along if place_on(other, one) is not None] == [ray]
    both = failure(space, {"mud": 0.0, "tool": 1.0})
    assert all(place_on(ray, both) is None for ray in along)


def test_nearer_drift_lies_on_the_nominal_side_everywhere() -> None:
    evaluator: Any = SimpleNamespace(space=SPACE)
    assert contains(evaluator.space, point(slope=0.5, mud=1.0), point(slope=0.5))
    assert contains(evaluator.space, point(slope=-0.5), point(slope=-0.1))
    assert not contains(evaluator.space, point(slope=0.5), point(slope=-0.1))
    assert not contains(evaluator.space, point(mud=3.0, slope=0.5), point(mud=3.0, slope=0.6))


def test_both_ends_of_one_range_are_not_a_pair() -> None:
    asked: list[Point] = []

    def examine(where: Point, most: int) -> Evidence:
        asked.append(where)
        return seen(1.0)

    evaluator: Any = SimpleNamespace(space=SPACE, examine=examine)
    together: Any = SimpleNamespace(curves=[curve(FLAT), curve(STEEP), curve(MUD)], found=[], tried=0)
    proposed: list[Point] = []
    pairs(evaluator, together, proposed)
    assert asked == [point(slope=-1.0, mud=0.0), point(slope=1.0, mud=0.0)]
    assert (together.tried, proposed) == (2, [])


# regions


def test_region_extends_to_the_failing_end() -> None:
    slope, mud, camera = (SPACE.extents[name] for name in ("slope", "mud", "camera"))
    assert (end(slope, 0.5), end(slope, -0.5), end(mud, 3.0), end(camera, 2.0)) == (1.0, -1.0, 0.0, 2.0)
    found = [one.words for one in regions(SPACE, failure(SPACE, point(slope=0.5, mud=2.0)))]
    assert found == [
        "mud from 2 to 0 and slope from 0.5 to 1",
        "mud from 2 to 1.5 and slope from 0.5 to 0.625",
    ]


def test_failure_at_the_ends_has_one_region() -> None:
    (one,) = regions(SPACE, failure(SPACE, point(slope=1.0, camera=1.0)))
    assert one.words == "slope=1 and camera='down'"
    assert one.drift.value == (1.0, "down")
    (single,) = regions(SPACE, failure(SPACE, point(camera=2.0)))
    assert single.drift.value == "left"


# maps


def test_the_margin_lost_along_a_ray_is_cut_off() -> None:
    assert lost(curve(MUD, {0.5: 0.25, 1.0: -9.0})) == 2.5
    assert lost(curve(MUD, {0.5: 0.25})) == 0.75
    assert lost(curve(MUD)) == 0.0
    found = importance(
        [curve(FLAT, {1.0: 0.5}), curve(STEEP, {1.0: -0.5}), curve(MUD, {1.0: 0.0}), curve(DOWN)]
    )
    assert found == {"slope": 1.5, "mud": 1.0}
    assert list(found) == ["slope", "mud"]


# statements


def test_statements_that_only_declare_have_no_place() -> None:
    text_ = 'import os\n"""doc"""\nclass A:\n    x = 1\n\ndef f():\n    global y\n    pass\n    return 1\n'
    assert list(places_in(text_)) == [(4, 5), (9, 5)]


def test_columns_count_characters_and_not_bytes() -> None:
    assert list(places_in('é = "ü"; b = 2')) == [(1, 1), (1, 10)]


def test_statement_of_passing_episodes_is_not_listed() -> None:
    places = [("a.py", 1, "x"), ("a.py", 2, "y"), ("a.py", 3, "z")]
    found = only_in_failures(places, [{0, 1}, {1, 2}, {0}], [{0}])
    assert found == (Executed("a.py", 2, "y", 2), Executed("a.py", 3, "z", 1))


class Recalling:
    """An evaluator that recalls episodes by pool and place: (name, whether it failed)."""

    def __init__(self, known: dict[tuple[str, float], list[tuple[str, bool]]]) -> None:
        self.known = known
        self.space = SPACE
        self.fresh_pools = ["rays", "chain 0"]

    def recalled(self, pool: str, where: Point) -> list[tuple[str, bool]]:
        return self.known.get((pool, where["slope"]), [])


def test_failing_episodes_are_compared_with_similar_passes() -> None:
    evaluator: Any = Recalling(
        {
            ("rays", 0.5): [("f1", True), ("p1", False), ("f2", True)],
            ("chain 0", 0.9): [("g1", True), ("q1", False)],
            ("rays", 0.0): [("n1", False), ("n2", True)],
            ("rays", 0.25): [("h1", False)],
            ("search", 0.125): [("s1", False), ("s2", True)],
            ("search", 0.25): [("s3", False)],
        }
    )
    one = curve(STEEP, {0.125: 1.0, 0.25: 1.0, 0.5: -1.0}, held=0.25)
    failures = [failure(SPACE, point(slope=number)) for number in (0.5, 0.9)]
    failing, others = chosen(evaluator, [one], failures)
    assert failing == ["f1", "g1", "f2"]
    assert others == ["p1", "q1", "n1", "h1", "s3", "s1"]


# sentences


def test_side_of_nominal_decides_below_or_above() -> None:
    assert [_sign(ray) for ray in (MUD, FLAT, STEEP)] == ["≥", "≥", "≤"]
    up = Ray(space_of(a=Drift.range(0.0, 0.5, nominal=0.0)), ("a",), {"a": 0.5})
    assert _sign(up) == "≤"


def test_a_point_is_printed_with_its_changed_values() -> None:
    assert of_point(SPACE, point(mud=1.23456, camera=1.0)) == "mud=1.23 and camera='down'"
    assert of_point(SPACE, SPACE.nominal) == ""


def test_repair_is_printed_with_its_boundaries_and_reason() -> None:
    moved = (
        Moved("slope to 1", "more robust", "0.5 to 0.6", "beyond 1", 0.5, 0.6, 1.0, None),
        Moved("mud to 0", "no significant change", "beyond 1", "beyond 1", 1.0, None, 1.0, None),
        Moved("slope to -1", "no significant change", "beyond -0.5", "beyond -0.6", -0.5, None, -0.6, None),
    )
    draws = Draws(40, 20, 38, 5.0, 9.5, 0.8345)
    one = Attempt("slope=0.5", "GAIN = 2", True, "a.patch", "it breaks must_hold", moved, draws)
    assert list(repair_lines(stress(repairs=(one,)))) == [
        "slope=0.5: GAIN = 2",
        "slope to 1: 0.5 to 0.6 → beyond 1: more robust",
        "slope to -1: beyond -0.5 → beyond -0.6: no significant change",
        (
            "over the declared space: 38 of 40 fresh draws pass with the repair, 20 without it; success at least "
            "83.5 % with 95 % confidence; mean reward 9.5 instead of 5."
        ),
        "The repair is withheld, since it breaks must_hold.",
    ]
    assert list(repair_lines(stress())) == []


def executed(count: int) -> Statements:
    return Statements(6, 12, tuple(Executed("n.py", 3 + at, "x = 1", 6 - at) for at in range(count)))


@pytest.mark.parametrize(
    ("count", "more"), [(5, []), (6, ["1 more statement that ran only in failures is in the JSON result."])]
)
def test_at_most_five_statements_are_printed(count: int, more: list[str]) -> None:
    found = list(statement_words(stress(statements=executed(count))))
    assert found[0] == "n.py:3 ran in 6 of 6 failing episodes and in none of 12 others: x = 1"
    assert found[5:] == more


def test_single_direction_promise_is_printed() -> None:
    found = stress(
        curve(STEEP, {0.5: -1.0}, confirmed=0.5),
        curve(DOWN, {1.0: -1.0}, confirmed=1.0),
        must_hold={"slope": (-0.5, 0.5), "camera": ("up", "down")},
    )
    assert broken_promises(found) == [
        "The guarantee fails at slope=0.5, but must_hold is -0.5 to 0.5.",
        "The guarantee fails with camera='down', but must_hold includes 'down'.",
    ]


def test_a_negative_share_is_printed_as_0_percent() -> None:
    shares = (Share("mud", -0.01, 0.0, 0.2, 0.05), Share("slope", 0.6, 0.1, 0.9, 0.1))
    assert list(sobol_words(stress(sobol=Sobol(1280, shares)))) == [
        (
            "Shares of the margin's variance over the space: slope 60 % alone, 90 % ± 10 % with combinations; mud 0 % "
            "alone, 20 % ± 5 % with combinations (Sobol indices, 1280 episodes)."
        )
    ]


# the page


def test_the_values_of_a_direction_are_a_table() -> None:
    told = page._table(stress(), "slope", [(0.5, Evidence("open", -0.256, 8, 7, 0.12345, 0.0))])
    assert told == (
        "<details><summary>All values</summary><table><tr><th>slope<th>margin<th>guarantee<th>passed<th>loss"
        "<tr><td>0.5<td>-0.26<td>open<td>7 of 8<td>0.123</table></details>"
    )


def test_figure_has_the_margin_vertically() -> None:
    measured = [(0.5, seen(-0.25)), (1.0, seen(-9.0))]
    drawn = page._figure("slope", SPACE.extents["slope"], [], measured)  # type: ignore[arg-type]
    line = re.search(r'points="([^"]*)"', drawn)
    assert line is not None
    # nominal at the middle with margin 1; margins below -1.25 at the bottom
    assert line[1] == "320.0,26.0 458.0,106.0 596.0,170.0"
    assert f'y1="{10 + 160 * 0.5:.1f}"' in drawn
    assert re.findall(r'<text x="([\d.]+)" y="192"', drawn) == ["44.0", "320.0", "596.0"]
    assert re.findall(r'<text x="38" y="([\d.]+)" text-anchor="end">([-\d]+)<', drawn) == [
        ("30.0", "1"),
        ("94.0", "0"),
        ("158.0", "-1"),
    ]
    assert "<title>0.5: margin -0.25, 8 of 8 passed</title>" in drawn
    assert re.findall(r'fill="(#\w{6})">', drawn) == [page.COLOURS["fails"]] * 2


def test_band_begins_at_nominal_and_is_visible() -> None:
    wide = page._band(curve(STEEP, {0.5: -1.0}, confirmed=0.5), lambda value: 100 * value)
    assert 'x="0.0" y="10" width="50.0" height="160"' in wide
    thin = page._band(
        curve(STEEP, {0.25: 1.0, 0.5: -1.0}, confirmed=0.5, held=0.499), lambda value: 100 * value
    )
    assert 'x="49.9" y="10" width="1.0"' in thin
    assert page._band(curve(STEEP), lambda value: value) == ""


def test_repairs_are_a_table_with_places() -> None:
    assert list(page._repairs(stress())) == []
    nothing = ["<h2>Repair</h2>", "<p>No failure was confirmed, so nothing was repaired.</p>"]
    assert list(page._repairs(stress(repairs=()))) == nothing
    moved = (Moved("slope to 1", "more robust", "0.5", "<1", 0.5, 0.6, 1.0, None),)
    one = Attempt("slope=0.5", "GAIN = 2", True, "a&b.patch", "", moved)
    assert list(page._repairs(stress(repairs=(one, replace(one, moved=(), patch=None)))))[3:] == [
        (
            "<table><tr><th>boundary<th>before<th>after<th>change<tr><td>slope to 1<td>0.5<td>&lt;1"
            "<td>more robust</table>"
        ),
        "<p>Patch: <code>a&amp;b.patch</code></p>",
        "<p>slope=0.5: GAIN = 2</p>",
    ]


def test_statements_of_failures_are_a_table_or_a_sentence() -> None:
    assert list(page._statements(stress())) == []
    head, told, rows = page._statements(stress(statements=executed(1)))
    assert head == "<h2>Statements of failures</h2>"
    assert "some of the 6 failing episodes" in told
    assert "none of 12 other episodes" in told
    assert "<td>n.py:3<td>6 of 6<td" in rows
    assert len(list(page._statements(stress(statements=executed(0))))) == 2


def test_largest_variance_comes_first() -> None:
    shares = (Share("mud", 0.1, 0.01, 0.2, 0.05), Share("slope", 0.6, 0.1, 0.9, 0.1))
    *_, table = page._variance(stress(sobol=Sobol(1280, shares)))
    assert table.endswith(
        "<tr><td>slope<td>0.60 ± 0.10<td>0.90 ± 0.10<tr><td>mud<td>0.10 ± 0.01<td>0.20 ± 0.05</table>"
    )
    assert list(page._variance(stress())) == []


# files


def test_missing_package_is_advised_if_needed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(delivering, "missing_sobol", lambda what: f"{what} needs SALib.")
    rich = stress(budget=1000, episodes=100)
    assert delivering._without_salib(rich) == ("  variance   The table of variances needs SALib.",)
    assert delivering._without_salib(replace(rich, ended="budget")) != ()
    for other in (
        replace(rich, episodes=1000),
        replace(rich, seconds=3.0),
        replace(rich, ended="interrupted"),
        replace(rich, ended="nominal"),
    ):
        assert delivering._without_salib(other) == ()
    monkeypatch.setattr(delivering, "missing_sobol", lambda what: None)
    assert delivering._without_salib(rich) == ()


@pytest.mark.parametrize(
    ("ended", "files"),
    [
        ("", {"margins", "report", "stress"}),
        ("budget", {"margins", "report", "stress"}),
        ("interrupted", {"report", "stress"}),
        ("nominal", {"report", "stress"}),
    ],
)
def test_an_interrupted_run_writes_no_margins(tmp_path: Any, ended: str, files: set[str]) -> None:
    kept: list[Any] = []
    memory: Any = SimpleNamespace(folder=tmp_path / "kept", write=kept.append)
    lines = delivering._written(stress(curve(MUD, GOOD), ended=ended), tmp_path, "t", memory)
    assert {one.name for one in (tmp_path / ".tarl").iterdir()} == files
    assert lines == ["report     .tarl/report/t-stress.html"]
    assert kept == ([()] if not ended else [])


def test_early_end_keeps_the_failures_found(tmp_path: Any) -> None:
    kept: list[Any] = []
    memory: Any = SimpleNamespace(folder=tmp_path / "kept", write=kept.append)
    found = stress(curve(MUD, GOOD, confirmed=0.75), ended="interrupted")
    delivering._written(found, tmp_path, "t", memory)
    assert kept == [found.failures]


def test_unwritable_file_is_reported(tmp_path: Any) -> None:
    (tmp_path / ".tarl").mkdir()
    (tmp_path / ".tarl" / "report").write_text("")
    memory: Any = SimpleNamespace(folder=tmp_path / "kept", write=lambda _: None)
    lines = delivering._written(stress(curve(MUD, GOOD)), tmp_path, "t", memory)
    assert len(lines) == 1
    assert lines[0].endswith("The result above stands.")
    assert "report     " not in lines[0]


def test_broken_promise_fails_the_test() -> None:
    assert delivering._problem(stress()) == ""
    assert delivering._problem(stress(ended="nominal")).startswith(
        "The guarantee already fails at the nominal"
    )
    found = stress(curve(STEEP, {0.5: -1.0}, confirmed=0.5), must_hold={"slope": (-0.5, 0.5)})
    assert delivering._problem(found) == "The guarantee fails at slope=0.5, but must_hold is -0.5 to 0.5."


def test_the_margins_of_an_option_are_zero_and_one() -> None:
    found = margins(stress(curve(DOWN, {1.0: -1.0}, confirmed=1.0), curve(LEFT, {1.0: 1.0}, held=1.0)))
    assert [(one.name, one.nominal, one.end, one.holds_to, one.fails_at) for one in found.sides] == [
        ("camera='down'", 0.0, 1.0, None, 1.0),
        ("camera='left'", 0.0, 1.0, 1.0, None),
    ]
    assert '"holds_to": null' in text(found)


# guarantees


def test_optimistic_failure_rate_is_one_error_higher() -> None:
    assert hopeful(3, 16) == pytest.approx(5 / 16)
    assert hopeful(0, 8) == pytest.approx(1 / 8)


@pytest.mark.parametrize(
    ("share", "failed", "risk", "expected"), [(0.9, 0, 0.05, 29), (0.95, 0, 0.05, 59), (0.9, 1, 0.05, 46)]
)
def test_minimum_number_of_episodes_follows_clopper_and_pearson(
    share: float, failed: int, risk: float, expected: int
) -> None:
    assert least(share, failed, risk) == expected


def test_a_low_rate_needs_at_least_eight_episodes() -> None:
    assert least(0.1, 0, 0.05) == 8


def test_margins_are_limited_by_the_rate_or_the_loss() -> None:
    given = Guarantee(0.9, 0.5, (10.0,), 1.0)
    assert given.margin(0.95, 0.0) == pytest.approx(0.5)
    assert given.margin(1.0, 0.4) == pytest.approx(0.2)
    assert given.margin(1.0, -5.0) == 1.0
    assert given.margin(0.8, 0.0) == pytest.approx(-1.0)
    equal = replace(given, rate=1.0)
    assert equal.margin(0.999, 0.0) < -1e5
