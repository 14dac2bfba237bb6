"""Regions contain only visited cells; rank, score and order of the lines agree."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import hypothesis.strategies as st
import numpy as np
from hypothesis import given, settings

from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning import localize
from pytest_tarl.learning.drift import Difference, compare
from pytest_tarl.learning.marginal import apart, left_out, lent, projected
from pytest_tarl.learning.merging import aligned, merge
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Sample
from pytest_tarl.learning.utility import batch
from pytest_tarl.model import (
    Comparison,
    Culprit,
    ListComparison,
    OperandEffect,
    Region,
    SitePlace,
    Slice,
    TaintList,
    Verdict,
)
from pytest_tarl.report import json_result, terminal
from pytest_tarl.seeds import generator
from pytest_tarl.sensors import Cell
from tests.slow import SLOW

LENGTH = 6
TIMES = 200 if SLOW else 25  # number of random worlds and of random reports


def mission(seed: int, harm: float, mode: int, avoid: int) -> Sample:
    """Walk through some cells in an irrelevant mode; one cell may cost reward and another one may be avoided."""
    draws = np.random.default_rng(seed)
    path = [place for place in range(LENGTH) for _ in range(int(draws.integers(1, 3))) if place != avoid]
    cells = tuple((place, mode) for place in range(LENGTH))
    steps = len(path)
    reward = np.where(np.array(path) == 2, -harm, 0.1) + draws.normal(0, 0.05, steps)
    trace = Trace(
        cells=cells,
        site=np.arange(steps, dtype=np.int32) % 2,
        flow=np.ones(steps),
        event_cell=np.array(path, np.int32),
        event_step=np.arange(steps, dtype=np.int32),
        step_cell=np.array(path, np.int32),
        reward=reward,
        parts={},
    )
    return sample(trace, seed, True, ((0, 1),))


def worlds(seed: int) -> tuple[Sample, Sample]:
    """Return two worlds that may differ by the cost of a cell, by a mode, or by an avoided cell."""
    draws = np.random.default_rng(seed)
    harm, mode, avoid = (
        float(draws.choice([-0.1, 1.0, 5.0])),
        int(draws.integers(0, 3)),
        int(draws.integers(-1, 6)),
    )
    before = merge([mission(10_000 * seed + i, -0.1, int(draws.integers(0, 2)), -1) for i in range(30)])
    after = merge([mission(10_000 * seed + 500 + i, harm, mode, avoid) for i in range(10)])
    return aligned(before, after)


def judged(offline: Sample, online: Sample) -> Difference:
    return compare(
        offline, online, alpha=0.05, tolerance=0.0, generator=generator(0, "compare"), permutations=199
    )


def visited(world: Sample) -> set[Cell]:
    return {world.cells[i] for i in np.unique(world.chain.cell).tolist()}


def test_region_contains_only_visited_cells() -> None:
    named = wrong = left = 0
    for seed in range(TIMES):
        offline, online = worlds(seed)
        region = judged(offline, online).region
        named += bool(region.cells or region.novel)
        wrong += not {*region.cells, *region.novel} <= visited(online)
        wrong += bool({*region.left} & visited(online)) or not {*region.left} <= visited(offline)
        left += bool(region.left)
    assert wrong == 0
    assert named > 0.3 * TIMES
    assert left > 0.05 * TIMES


def test_sensor_with_only_new_values_is_left_out() -> None:
    before = merge([mission(seed, -0.1, seed % 2, -1) for seed in range(30)])
    after = merge([mission(seed + 500, 5.0, 2, -1) for seed in range(10)])
    offline, online = aligned(before, after)
    assert left_out(offline, online) == (1,)
    assert apart(offline, online)
    found = judged(offline, online)
    assert found.region.without == (1,)
    assert found.region.cells == ((2, 2),)
    assert max(found.changes, key=lambda cell: found.changes[cell]) == (2, 2)


def test_no_sensor_is_left_out_with_common_cells() -> None:
    before = merge([mission(seed, -0.1, seed % 2, -1) for seed in range(30)])
    offline, online = aligned(before, merge([mission(seed + 500, 5.0, 1, -1) for seed in range(10)]))
    assert left_out(offline, online) == ()
    assert not apart(offline, online)


def test_leaving_out_a_sensor_keeps_all_steps_and_rewards() -> None:
    world = merge([mission(seed, -0.1, seed % 2, -1) for seed in range(10)])
    short = projected(world, (1,))
    assert short.cells == tuple((place,) for place in range(LENGTH))
    assert short.chain.count.sum() == world.chain.count.sum()
    assert short.chain.reward.sum() == world.chain.reward.sum()


def test_unrecorded_cells_take_the_utility_of_similar_ones() -> None:
    before = merge([mission(seed, -0.1, 0, -1) for seed in range(20)])
    offline, _ = aligned(before, merge([mission(seed + 500, 5.0, 2, -1) for seed in range(10)]))
    table = batch(offline.lists[0], len(offline.cells), 1.0)
    filled = lent(table, offline.lists[0], offline.cells, (1,))
    known = np.array([cell[1] == 0 for cell in offline.cells])
    assert np.array_equal(filled[known], table[known], equal_nan=True)
    assert np.array_equal(filled[~known], table[known], equal_nan=True)


def place(name: int) -> SitePlace:
    return SitePlace(f"node:f:{name}", "node.py", name + 1, f"x{name}", "data", "assign")


SITES = st.integers(0, 11)
VALUES = st.one_of(st.just(0.0), st.floats(-100, 100), st.just(float("nan")))
LISTS = st.lists(st.dictionaries(SITES, st.tuples(VALUES, VALUES), min_size=1), min_size=1, max_size=4)


def reported(culprits: tuple[Culprit, ...], sites: list[list[Slice]]) -> None:
    """Check that terminal and result file rank the lines as the scores do."""
    nothing = np.empty((0, 0))
    lists = tuple(
        ListComparison(TaintList(f"/in{i}", "/out", tuple(s.site for s in one)), nothing, nothing, tuple(one))
        for i, one in enumerate(sites)
    )
    compared = Comparison(
        test="test_node.py::test_x",
        drift=None,
        seed=0,
        sensors=(),
        cells=(),
        lists=lists,
        verdict=Verdict("degraded", 0.01, 0.01, 1.0, 0.1, 0.1, None),
        region=Region(),
        paper_region=(),
        totals={"offline": (1.0, 2.0), "online": (0.0, 0.5)},
        culprits=culprits,
        searches=(),
        repair=None,
        notes=(),
    )
    order = [one.site.line for one in culprits]
    kept: Any = json_result.document(compared, {})["culprits"]
    assert [one["line"] for one in kept] == order
    scores = [one["score"] for one in kept]
    assert scores == sorted(scores, reverse=True)
    told = terminal.lines(compared, width=200, root=Path("/"), page=None)
    ranked = re.findall(r"(\d+)\. node\.py:(\d+)", "\n".join(told))
    assert [int(rank) for rank, _ in ranked] == [*range(1, len(ranked) + 1)]
    assert [int(line) for _, line in ranked] == order[: len(ranked)]


@given(LISTS, st.frozensets(SITES))
@settings(max_examples=TIMES, deadline=None)
def test_changeable_sites_come_first(
    lists: list[dict[int, tuple[float, float]]], changeable: frozenset[int]
) -> None:
    per_list = [
        [Slice(place(n), f"list {i}", *values) for n, values in one.items()] for i, one in enumerate(lists)
    ]
    ids = {place(n).id for n in changeable}
    ranked = localize.prior(per_list, ids)
    found = localize.culprits(ranked, {}, (), 1.0)
    scores = [one.score for one in found]
    assert scores == sorted(scores, reverse=True)
    assert all(0 < score <= 1 for score in scores)
    held = [one.site.id in ids for one in found]
    assert held == sorted(held, reverse=True)
    assert len({one.site.id for one in found}) == len(found)
    reported(found, per_list)


EFFECTS = st.dictionaries(SITES, st.floats(-5, 5), max_size=6)


@given(LISTS, st.frozensets(SITES), EFFECTS, st.frozensets(SITES), st.just(0.0) | st.floats(-1, 4))
@settings(max_examples=TIMES, deadline=None)
def test_after_the_search_a_repaired_line_is_ranked_first(
    lists: list[dict[int, tuple[float, float]]],
    changeable: frozenset[int],
    gained: dict[int, float],
    repaired: frozenset[int],
    loss: float,
) -> None:
    per_list = [[Slice(place(n), "", *values) for n, values in one.items()] for one in lists]
    ranked = dict(localize.prior(per_list, {place(n).id for n in changeable}))
    everything = [*ranked.items(), *((place(n), 0.0) for n in range(12) if place(n) not in ranked)]
    effects = {place(n).id: [OperandEffect("1", 1.0, 2.0, gain)] for n, gain in gained.items()}
    chosen = [place(n).id for n in repaired & gained.keys()]
    found = localize.culprits(everything, effects, chosen, loss)
    scores = [one.score for one in found]
    assert scores == sorted(scores, reverse=True)
    assert all(one.site.id in chosen for one in found[: len(chosen)]) or not effects
    reported(found, per_list)
