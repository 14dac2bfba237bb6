"""Computations of `tarl fleet` on a few missions, checked by hand: repairs, residual maps, orders of missions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import erfc, inf, log2, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.fleet import changed_robots, clusters, components, partitions, residual_maps
from pytest_tarl.fleet.partitions import Transitions
from pytest_tarl.fleet.repairs import Strata, effect, strata
from pytest_tarl.fleet.residual_maps import ResidualMap, since
from pytest_tarl.fleet.scores import Scores
from pytest_tarl.fleet.side_by_side import Watched
from pytest_tarl.learning.tables import END, Ints
from pytest_tarl.monitoring import restarts
from tests.plugin.fleet.answers import bound, evidence, fixture, robot, status
from tests.plugin.fleet.answers import effect as repaired


def ints(*values: int) -> Ints:
    return np.array(values, np.int64)


@pytest.mark.parametrize(
    ("low", "high", "verdict"),
    [
        (0.25, 0.75, "helps"),
        (0.0, 0.75, "no effect shown"),
        (-0.5, 0.0, "no effect shown"),
        (-0.5, -0.25, "harms"),
        (-inf, inf, "too few robots"),
    ],
)
def test_repair_helps_if_its_whole_interval_is_above_zero(low: float, high: float, verdict: str) -> None:
    assert repaired(reward_bound=bound(low, high)).verdict == verdict
    assert repaired(reward_bound=bound(low, high), strata=0).verdict == "not comparable"


def test_strata_without_missions_of_both_kinds_are_left_out() -> None:
    robot_, stratum = ints(7, 7, 7, 8, 8, 9), ints(0, 0, 2, 2, 2, 1)
    treated, passed = ints(0, 1, 0, 1, 1, 0), ints(1, 0, 1, 1, 0, 1)
    total = np.array([1.0, 2.0, 4.0, 8.0, 16.0, 32.0])
    found = strata(robot_, stratum, treated, total, passed)
    assert found.robot.tolist() == [7, 7, 8]
    assert found.stratum.tolist() == [0, 1, 1]  # numbered anew
    assert found.count.tolist() == [[1, 1], [1, 0], [0, 2]]
    assert found.total.tolist() == [[1, 2], [4, 0], [0, 24]]
    assert found.passed.tolist() == [[1, 0], [1, 0], [0, 1]]


def test_strata_are_weighted_by_mission_pairs() -> None:
    one = Strata(
        ints(0, 0, 1, 2),
        ints(0, 1, 1, 0),
        np.array([[1.0, 1.0], [2.0, 0.0], [0.0, 4.0], [1.0, 0.0]]),
        np.array([[1.0, 5.0], [4.0, 0.0], [0.0, 12.0], [3.0, 0.0]]),
        np.array([[0.0, 1.0], [2.0, 0.0], [0.0, 2.0], [1.0, 0.0]]),
    )
    found = effect("fix", ("a",), one, 0.975)
    # stratum 0: weight 2·1/3, difference 5 - 4/2 = 3; stratum 1: weight 2·4/6, difference 12/4 - 4/2 = 1
    assert found.reward == pytest.approx((2 / 3 * 3 + 4 / 3 * 1) / 2)
    assert found.success == pytest.approx((2 / 3 * (1 - 1 / 2) + 4 / 3 * (2 / 4 - 1)) / 2)
    assert (found.repair, found.values, found.strata) == ("fix", ("a",), 2)
    assert (found.missions, found.robots) == ((5, 4), (2, 2))
    assert found.verdict == "too few robots"


@pytest.mark.parametrize("without", [3, 4])
def test_interval_needs_four_robots_on_each_side(without: int) -> None:
    number = np.arange(without + 4)
    arm, total = (number >= without).astype(np.int64), number.astype(float)
    found = effect("fix", (), strata(number, ints(*[0] * number.size), arm, total, arm), 0.975)
    assert np.isfinite(found.reward_bound.low) == (without == 4)
    assert found.reward == pytest.approx(total[without:].mean() - total[:without].mean())


def test_jackknife_of_a_mean_is_the_classical_interval() -> None:
    """Each robot has one mission with and one without the repair; their difference is its jackknife pseudo-value."""
    number, gain = np.repeat(np.arange(6), 2), np.array([0.0, 1.0, 2.0, 3.0, 4.0, 8.0])
    arm = np.tile([0, 1], 6)
    total = np.where(arm == 1, gain[number], 0.0)
    found = effect("fix", (), strata(number, 0 * number, arm, total, arm), 0.975)
    half = 2.5706 * gain.std(ddof=1) / sqrt(6)  # Student's t with 5 degrees of freedom
    assert found.reward == pytest.approx(3.0)
    assert found.reward_bound.low == pytest.approx(3.0 - half, abs=1e-3)
    assert found.reward_bound.high == pytest.approx(3.0 + half, abs=1e-3)
    assert (found.reward_bound.exact, found.reward_bound.episodes) == (False, 6)


@pytest.mark.parametrize(("world", "limit", "expected"), [(5.0, 4.9, 6), (5.0, 5.0, 8), (5.0, 6.0, 8)])
def test_onset_comes_from_the_test_with_most_evidence(world: float, limit: float, expected: int) -> None:
    told = status(evidence(2.0, 7), (), evidence(1.0, 4), evidence(3.0, 9))
    assert since(robot("r1", world, limit, told)) == expected
    assert since(robot("r1", world, limit)) == 0
    assert since(robot("r1", world, limit, status(evidence(2.0)))) == 0
    assert (
        since(robot("r1", 5.0, 6.0, status(evidence(2.0, 7), (), None))) == 6
    )  # a bound that cannot be tested


def test_residuals_of_the_recorded_missions_are_zero_on_average() -> None:
    recorded = fixture()
    world = residual_maps.designed(recorded)
    mean, variance, visits = residual_maps._mean(
        replace(recorded.sample, cells=((),) * (len(recorded.sample.cells) + 1)), world.model
    )
    rows = recorded.sample.chain
    missions = np.array([len({*rows.episode[rows.cell == cell].tolist()}) for cell in range(len(mean))])
    assert np.isnan(mean).tolist() == (missions < residual_maps.FEWEST).tolist()
    known = ~np.isnan(mean)
    assert visits[known].tolist() == [rows.count[rows.cell == cell].sum() for cell in np.flatnonzero(known)]
    assert np.abs(mean[known] @ visits[known]) < 1e-9 * visits.sum()
    assert world.of_visit[known].tolist() == (variance * visits)[known].tolist()


def test_residual_map_noise_is_at_least_the_recorded_noise() -> None:
    recorded = fixture()
    world = residual_maps.designed(recorded)
    own = replace(recorded.sample, cells=((),) * (len(recorded.sample.cells) + 1))
    doubled = replace(world, of_visit=4.0 * world.of_visit)
    found = residual_maps._map("r1", own, doubled)
    known = ~np.isnan(found.mean)
    assert found.robot == "r1"
    assert found.mean.size == len(recorded.sample.cells)  # without the row of all other cells
    assert known.any()
    assert found.variance[known] == pytest.approx(4.0 * world.variance[:-1][known])
    halved = residual_maps._map("r1", own, replace(world, of_visit=0.25 * world.of_visit))
    assert halved.variance[known] == pytest.approx(world.variance[:-1][known])


def test_robots_share_one_array_of_e_processes() -> None:
    processes = restarts.begun(np.array([1.0] * 6))
    peak = np.array([1.0, 2.0, 10.0, 11.0, 20.0, 21.0])  # a bound of both robots, two scores of each
    some = Watched(ints(4, 7), replace(processes, peak=peak), ints(1, 2, 3, 4), 1)
    assert some.scores == 2
    assert some.peaks().tolist() == [[1.0, 10.0, 11.0], [2.0, 20.0, 21.0]]
    mine, pool = some.state(1)
    assert (mine.peak.tolist(), pool.tolist()) == ([2.0, 20.0, 21.0], [3, 4])


def scores(count: int) -> Scores:
    number = np.arange(count)
    new = number[number % 2 == 1]
    return Scores(
        number % 3 > 0,
        number * 1.5,
        number + 1,
        number * 10.0,
        np.stack([number, -number], axis=1).astype(np.int8),
        np.repeat(new, 2),
        np.tile([0, 1], new.size),
        ((7, 0), (8, 1)),
    )


@given(st.permutations(range(7)), st.integers(0, 7), st.integers(0, 7))
def test_scores_of_a_mission_stay_together(order: list[int], one: int, other: int) -> None:
    begin, end = sorted((one, other))
    found = scores(7).ordered(ints(*order)).between(begin, end)
    some = order[begin:end]
    assert found.total.tolist() == [1.5 * n for n in some]
    assert found.passed.tolist() == [n % 3 > 0 for n in some]
    assert found.steps.tolist() == [n + 1 for n in some]
    assert found.time.tolist() == [10.0 * n for n in some]
    assert found.bins.tolist() == [[n, -n] for n in some]
    places = [place for place, n in enumerate(some) if n % 2 for _ in range(2)]
    assert found.new_mission.tolist() == places
    assert found.new() == [((7, 0), (8, 1))[code % 2] for code in range(len(places))]


def transitions(*rows: tuple[int, int, int, int, float]) -> Transitions:
    number, cell, following, count, reward = zip(*rows, strict=True)
    return Transitions(ints(*number), ints(*cell), ints(*following), ints(*count), np.array(reward, float))


def listed(found: Transitions) -> list[tuple[float, ...]]:
    return list(zip(*(column.tolist() for column in vars(found).values()), strict=True))


ROWS = st.lists(
    st.tuples(
        st.integers(0, 3),
        st.integers(0, 2),
        st.integers(END, 2),
        st.integers(1, 2),
        st.sampled_from([-1.0, 0.5, 2.0]),
    ),
    min_size=1,
    max_size=12,
)


@given(ROWS, st.integers(0, 12))
def test_mission_rows_of_several_files_are_merged(
    rows: list[tuple[int, int, int, int, float]], cut: int
) -> None:
    parts = [transitions(*some) for some in (rows[:cut], rows[cut:]) if some]
    assert listed(partitions.sorted_rows(parts)) == sorted(rows)


@given(ROWS, st.sets(st.integers(0, 3), min_size=1))
def test_transitions_can_be_selected_by_mission(
    rows: list[tuple[int, int, int, int, float]], some: set[int]
) -> None:
    every = partitions.sorted_rows([transitions(*rows)])
    wanted = ints(*sorted(some))
    found = every.of(wanted)
    assert listed(found) == [row for row in sorted(rows) if row[0] in some]
    assert found.chain(wanted).episode.tolist() == [sorted(some).index(int(row[0])) for row in listed(found)]
    low, high = min(some), max(some)
    assert listed(every.between(low, high)) == [row for row in sorted(rows) if low <= row[0] < high]


def test_unrecorded_chain_cells_become_one_cell() -> None:
    """Cells 2 and 3 are not recorded: their transitions of one mission are joined where they become equal."""
    rows = transitions(
        (0, 0, 2, 1, 1.0), (0, 0, 3, 2, 2.0), (0, 2, 3, 1, 4.0), (0, 3, END, 1, 8.0), (1, 2, 3, 1, 16.0)
    )
    found = partitions._without_others(rows.chain(ints(0, 1)), 2)
    columns = (found.episode, found.cell, found.next_cell, found.count, found.reward)
    assert list(zip(*(column.tolist() for column in columns), strict=True)) == [
        (0, 0, 2, 3, 3.0),
        (0, 2, END, 1, 8.0),
        (0, 2, 2, 1, 4.0),
        (1, 2, 2, 1, 16.0),
    ]
    inside = transitions((0, 0, 1, 1, 1.0)).chain(ints(0))
    assert partitions._without_others(inside, 2) is inside


@pytest.mark.parametrize(
    ("sizes", "most", "expected"),
    [((3, 0, 2, 4), 5, [[3, 2], [4]]), ((3, 2), 6, [[3, 2]]), ((6, 1), 5, [[6], [1]]), ((0,), 5, [])],
)
def test_data_set_files_are_divided_into_tasks(
    sizes: tuple[int, ...], most: int, expected: list[list[int]]
) -> None:
    none = np.empty(0, np.uint64)
    wanted = [partitions.Wanted("c", "m", none, np.arange(size)) for size in sizes]
    assert [[one.numbers.size for one in some] for some in partitions.portions(wanted, most)] == expected


def test_robots_are_divided_by_their_missions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(changed_robots, "PORTION", 10)
    ends = ints(4, 10, 11, 35, 40)
    assert [one.tolist() for one in changed_robots.portions(ends)] == [[4, 10], [11], [35, 40]]


def test_weighted_mean_of_e_values_does_not_overflow() -> None:
    assert changed_robots._mean(np.array([]), np.array([])) == -1.0
    assert changed_robots._mean(np.array([3.0, 1.0]), np.array([1.0, 3.0])) == pytest.approx(
        log2((8 + 3 * 2) / 4)
    )
    assert changed_robots._mean(np.array([2000.0, 1.0]), np.array([1.0, 1.0])) == pytest.approx(
        1999.0
    )  # without overflow


def test_map_distance_is_the_largest_difference() -> None:
    nan = np.nan
    maps = [
        ResidualMap("a", np.array([1.0, 0.0, nan]), np.array([0.5, 0.5, nan])),
        ResidualMap("b", np.array([0.0, 3.0, 1.0]), np.array([0.5, 0.5, 1.0])),
        ResidualMap("c", np.array([nan, nan, 1.0]), np.array([nan, nan, 0.0])),
        ResidualMap("d", np.array([1.0, 0.0, nan]), np.array([0.0, 0.0, nan])),
    ]
    found = clusters.distances(maps)
    assert found[0].tolist() == [inf, 3.0, inf, 0.0]
    assert found[1, 2] == found[2, 1] == 0.0  # equal residuals differ by nothing, whatever their error
    assert found[1, 3] == pytest.approx(3.0 / sqrt(0.5))
    assert np.diag(found).tolist() == [inf] * 4


def test_significant_cells_are_corrected_for_the_number_of_cells() -> None:
    p = erfc(2.0 / sqrt(2.0))  # 0.0455
    mean, variance = np.array([2.0, 0.0, np.nan, -4.0]), np.array([1.0, 0.0, 1.0, 1.0])
    assert clusters._standing_out(mean, variance, 3.1 * p).tolist() == [0, 3]
    assert clusters._standing_out(mean, variance, 2.9 * p).tolist() == [3]


def test_complete_linkage_joins_the_nearest_clusters_until_they_differ() -> None:
    apart = np.array([[inf, 1.0, 3.0, 9.0], [1.0, inf, 2.0, 9.0], [3.0, 2.0, inf, 9.0], [9.0, 9.0, 9.0, inf]])
    p = erfc(3.0 / sqrt(2.0)) * 5 * 6  # five cells, six pairs
    assert clusters._linked(apart, 5, 0.9 * p) == [[0, 1, 2], [3]]
    assert clusters._linked(apart, 5, 1.1 * p) == [[0, 1], [2], [3]]
    assert clusters._linked(apart[:1, :1], 5, 0.05) == [[0]]


def test_cluster_weights_maps_by_inverse_variance() -> None:
    maps = [
        ResidualMap("b", np.array([-3.0, np.nan, 0.0]), np.array([0.1, np.nan, 0.1])),
        ResidualMap("a", np.array([-6.0, -4.0, 0.0]), np.array([0.2, 0.1, 0.1])),
    ]
    found = clusters._cluster(maps, np.zeros(3), ((0,), (1,), (2,)), 0.05)
    assert found.robots == ("a", "b")
    assert found.cells == ((0,), (1,))
    assert found.residuals == pytest.approx((-4.0, -4.0))  # (-3·10 - 6·5) / 15


def test_clusters_are_sorted_and_remaining_robots_named() -> None:
    def one(name: str, mean: float) -> ResidualMap:
        return ResidualMap(name, np.array([mean]), np.array([0.01]))

    maps = [one("d", 5.0), one("c", -5.0), one("b", 5.0), one("a", 0.1)]
    found = clusters.of(maps, np.array([0.0]), ((3,),), 0.05, left_out=2)
    assert [group.robots for group in found.found] == [("b", "d"), ("c",)]
    assert (found.unclear, found.left_out) == (("a",), 2)
    assert [*found.maps] == ["a", "b", "c", "d"]
    assert clusters.of(maps[3:], np.array([0.0]), ((3,),), 0.05).found == ()


def test_singular_matrix_gives_a_pseudo_inverse_and_rank() -> None:
    inverse, rank = components._inverse(np.array([[2.0, 2.0], [2.0, 2.0]]))
    assert rank == 1
    assert inverse == pytest.approx(np.full((2, 2), 0.125))
    small, rank = components._inverse(1e-10 * np.eye(2))
    assert rank == 2
    assert small == pytest.approx(1e10 * np.eye(2))
    nothing, rank = components._inverse(np.zeros((2, 2)))
    assert (rank, nothing.tolist()) == (0, [[0.0, 0.0], [0.0, 0.0]])


def test_residual_map_uses_missions_since_the_onset(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[int, int]] = []

    def following(*arguments: Any) -> Iterator[str]:
        asked.extend(arguments[-1])
        return iter(["first", "second", "third"])

    database: Any = SimpleNamespace(columns=lambda _, name: {"first": ints(10), "ends": ints(int(name))})
    monkeypatch.setattr(residual_maps, "following", following)
    monkeypatch.setattr(residual_maps, "_map", lambda name, sample, _: (name, sample))
    told = [status(evidence(2.0, mission)) for mission in (1, 4, 99)]
    some = [robot(name, 5.0, 1.0, one) for name, one in zip(("20", "30", "40"), told, strict=True)]
    nothing: Any = None
    found = residual_maps.residual_maps(database, nothing, nothing, fixture(), nothing, some)
    assert asked == [(10, 20), (13, 30), (39, 40)]  # one mission at least
    assert found == [("20", "first"), ("30", "second"), ("40", "third")]


def test_clustering_compares_the_robots_with_the_most_evidence(monkeypatch: pytest.MonkeyPatch) -> None:
    compared: list[str] = []

    def maps(*arguments: Any) -> list[ResidualMap]:
        compared.extend(one.name for one in arguments[-1])
        return [ResidualMap(one.name, np.array([9.0]), np.array([0.01])) for one in arguments[-1]]

    monkeypatch.setattr(clusters, "MOST", 3)
    monkeypatch.setattr(clusters, "designed", lambda _: SimpleNamespace(variance=np.array([0.0, 0.0])))
    monkeypatch.setattr(clusters, "residual_maps", maps)
    every = [
        robot("a", 1.0, 2.0),
        robot("b", 9.0, 1.0),
        robot("c", 1.0, 5.0),
        robot("d", 2.0, 2.0),
        robot("e", 5.0, 1.0),
    ]
    named = changed_robots.Robots(0.1, tuple(every), tuple(every[:3]), tuple(every[2:]))
    recording: Any = SimpleNamespace(sample=SimpleNamespace(cells=((0,),)))
    nothing: Any = None
    found = clusters.clustered(nothing, nothing, nothing, recording, named, 0.05)
    assert compared == ["b", "c", "e"]
    assert found.left_out == 2
    assert [one.robots for one in found.found] == [("b", "c", "e")]
    none = clusters.clustered(
        nothing, nothing, nothing, recording, changed_robots.Robots(0.1, (), (), ()), 0.05
    )
    assert none == clusters.Clusters()
