"""Robots that are monitored in one array have, bitwise, the states of separate monitors."""

from __future__ import annotations

from dataclasses import fields, replace

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from pytest_tarl.fleet import changed_robots, side_by_side
from pytest_tarl.fleet.scores import Scores
from pytest_tarl.learning.bounds import Range
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.tables import Chain, Sample
from pytest_tarl.monitoring import restarts
from pytest_tarl.monitoring.monitor import begun
from pytest_tarl.monitoring.restarts import Processes
from pytest_tarl.monitoring.scores import binned
from tests.plugin.monitoring import missions


@pytest.fixture(scope="module", params=[None, Range(-20.0, 20.0)], ids=["success", "both bounds"])
def recording(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Fixture:
    path = tmp_path_factory.mktemp("recording") / "test.npz"
    return missions.fixture(path, missions.walks(40, 1), request.param)


def field_missions(counts: list[int], width: int, seed: int) -> Sample:
    """Return missions of robots, half of which get worse; some have no steps, some no known total."""
    rng = np.random.default_rng(seed)
    worse = np.repeat(np.arange(len(counts)) % 2, counts)
    steps = np.where(rng.random(worse.size) < 0.1, 0, rng.integers(1, 6, worse.size))
    episode = np.repeat(np.arange(worse.size), steps)
    cell = np.concatenate(
        [np.empty(0, np.int64), *(np.sort(rng.choice(width, size, replace=False)) for size in steps)]
    )
    reward = rng.normal(1.0, 0.2, cell.size) - 2.0 * worse[episode]
    total = np.bincount(episode, reward, worse.size)
    chain = Chain(
        episode, cell, np.full(cell.size, -1), np.ones(cell.size, np.int64), reward, np.zeros((cell.size, 0))
    )
    return Sample(
        cells=((),) * width,
        seeds=tuple(range(worse.size)),
        passed=rng.random(worse.size) >= 0.02 + 0.9 * worse,
        total=np.where((steps == 0) | (rng.random(worse.size) < 0.1), np.nan, total),
        steps=steps,
        part_names=(),
        chain=chain,
        lists=(),
    )  # fmt: skip


@given(
    counts=st.lists(st.integers(1, 150), min_size=1, max_size=7),
    together=st.sampled_from([1, 60, 1000]),
    large=st.sampled_from([8, 600]),
    seed=st.integers(0, 99),
)
@settings(max_examples=6, deadline=None)
def test_each_robot_has_the_state_of_its_own_monitor(
    recording: Fixture, counts: list[int], together: int, large: int, seed: int
) -> None:
    first = begun(recording, alpha=0.05, seed=3)
    sample = field_missions(counts, len(recording.sample.cells) + 1, seed)
    ends = np.cumsum(counts)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(side_by_side, "COLUMNS", together)
        patched.setattr(restarts, "LARGE", large)  # so that stakes are scaled down at different missions
        found = {}
        none = np.empty(0, np.int64)
        time = np.arange(sample.episodes, dtype=float)
        bins = binned(first.scale, sample).astype(np.int8)
        scores = Scores(sample.passed, sample.total, sample.steps, time, bins, none, none, ())
        for some in side_by_side.watched(first, scores, ends):
            for place, robot in enumerate(some.robots.tolist()):
                found[robot] = (*some.state(place), some.peaks()[place])
        assert sorted(found) == [*range(len(counts))]
        for robot, end in enumerate(ends.tolist()):
            alone = changed_robots.fresh(first)
            low = end - counts[robot]
            rows = (sample.chain.episode >= low) & (sample.chain.episode < end)
            columns = {name: column[rows] for name, column in vars(sample.chain).items()}
            mine = replace(
                sample,
                seeds=sample.seeds[low:end],
                passed=sample.passed[low:end],
                total=sample.total[low:end],
                steps=sample.steps[low:end],
                chain=Chain(**columns | {"episode": columns["episode"] - low}),
            )
            alone.take(mine, np.arange(mine.episodes, dtype=float))
            processes, pool, peak = found[robot]
            assert np.array_equal(pool, alone.pool)
            assert peak.tobytes() == alone.processes.peak.tobytes()
            for one in fields(Processes):
                expected = getattr(alone.processes, one.name)
                assert getattr(processes, one.name).tobytes() == expected.tobytes(), one.name
