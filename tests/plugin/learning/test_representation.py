"""Samples from a file and from memory give the same comparison."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning.drift import as_compared, compare
from pytest_tarl.learning.fixture import load, save
from pytest_tarl.learning.merging import aligned, merge
from pytest_tarl.learning.packing import represented
from pytest_tarl.learning.permutation import max_statistic, permuted_loss
from pytest_tarl.learning.residuals import fitted, residuals
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Sample
from pytest_tarl.seeds import generator
from tests.plugin.learning.test_fixture import example
from tests.plugin.learning.test_statistics import same

Monitor = st.sampled_from(["constant", "saturated", "whole", "one-off", "there and back", "by cell"])
SIZES = st.sampled_from([1e-9, 0.1, 0.7, 3.0, 1e6])


def rewards(kind: str, size: float, cells: np.ndarray, draws: np.random.Generator) -> np.ndarray:
    """Return the rewards of an episode, which are constant in some cells."""
    steps = cells.size
    if kind == "saturated":
        return np.minimum(size, size * draws.uniform(0.5, 3.0, steps))
    if kind == "whole":
        return np.where(draws.random(steps) < 0.3, -3.0, 7.0)
    if kind == "one-off":
        return np.append(np.zeros(steps - 1), size)
    if kind == "there and back":
        half = size * draws.uniform(0.1, 1.0, steps // 2)
        return np.concatenate((half, -half[::-1], np.zeros(steps % 2)))
    return size * (1.0 + cells) / 3.0 if kind == "by cell" else np.full(steps, -size)


def mission(seed: int, kind: str, size: float, cells: int, most: int, *, equal: bool = False) -> Sample:
    """Return an episode of at most `most` steps, in a world without sites."""
    draws = np.random.default_rng(seed)
    steps = most if equal else int(draws.integers(1, most + 1))
    at = draws.integers(0, cells, steps)
    none = np.empty(0, dtype=np.int32)
    trace = Trace(
        cells=tuple((cell,) for cell in range(cells)),
        site=none,
        flow=np.empty(0),
        event_cell=none,
        event_step=none,
        step_cell=at.astype(np.int32),
        reward=rewards(kind, size, at, draws),
        parts={},
    )
    return sample(trace, seed, True, ())


def world(first: int, count: int, *how: object, **more: object) -> Sample:
    return merge([mission(seed, *how, **more) for seed in range(first, first + count)])  # type: ignore[arg-type]


def through_a_file(recorded: Sample) -> Sample:
    """Return this sample after saving and loading it."""
    fixture = example()
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.npz"
        save(replace(fixture, sensors=fixture.sensors[:1], lists=(), sarsa=(), sample=recorded), path)
        return load(path).sample


@given(Monitor, SIZES, st.integers(1, 4), st.integers(1, 9), st.integers(0, 2**20))
@settings(max_examples=40, deadline=None)
def test_verdict_from_a_file_equals_the_verdict_from_memory(
    kind: str, size: float, cells: int, most: int, seed: int
) -> None:
    offline, online = (world(seed + first, 12, kind, size, cells, most) for first in (0, 100))
    found = [
        compare(one, online, alpha=0.05, tolerance=None, generator=generator(seed, "compare"))
        for one in (offline, through_a_file(offline))
    ]
    assert found[0] == found[1]


@given(
    st.sampled_from(["constant", "by cell"]),
    st.floats(-1e9, 1e9).filter(lambda size: abs(size) > 1e-9),
    st.integers(1, 4),
    st.integers(1, 9),
    st.integers(0, 2**20),
)
@settings(max_examples=60, deadline=None)
def test_a_constant_reward_of_a_cell_leaves_no_residual(
    kind: str, size: float, cells: int, most: int, seed: int
) -> None:
    offline, online = aligned(
        *(as_compared(world(seed + first, 12, kind, size, cells, most)) for first in (0, 100))
    )
    model = fitted(offline.chain, len(offline.cells))
    assert not residuals(online, model).reward.any()


@given(SIZES, st.integers(2, 9), st.integers(0, 2**20))
@settings(max_examples=40, deadline=None)
def test_totals_that_cancel_out_are_exactly_zero(size: float, most: int, seed: int) -> None:
    totals = world(seed, 12, "there and back", size, 2, most).total
    assert not totals.any()
    assert permuted_loss(totals, totals[:4], generator(seed, "a")) == 1.0


@given(st.integers(0, 2**20), st.floats(-1e6, 1e6), st.integers(1, 5))
@settings(max_examples=40, deadline=None)
def test_columns_that_differ_only_by_rounding_are_constant(seed: int, value: float, columns: int) -> None:
    draws = np.random.default_rng(seed)
    jitter = 1.0 + draws.choice([-1e-15, 0.0, 1e-15], (20, columns))
    jitter[:10] = 1.0  # one group has the rounding error, the other does not
    assert max_statistic(value * jitter, 10, generator(seed, "a")).tolist() == [1.0] * columns


@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e200])
def test_the_significance_does_not_depend_on_the_unit(scale: float) -> None:
    columns = np.random.default_rng(0).normal(size=(30, 2))
    columns[:15, 0] += 2.0
    assert (
        max_statistic(scale * columns, 15, generator(0, "a")).tolist()
        == max_statistic(columns, 15, generator(0, "a")).tolist()
    )


def test_representing_a_sample_a_second_time_changes_nothing() -> None:
    recorded = example().sample
    once = represented(recorded)
    assert same(represented(once), once)
