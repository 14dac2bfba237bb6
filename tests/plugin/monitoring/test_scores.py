"""A logged mission has the same scores as the same mission in a recording."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.errors import FixtureError
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.packing import represented
from pytest_tarl.learning.residuals import in_fit
from pytest_tarl.learning.statistics import sample
from pytest_tarl.monitoring.scores import WHOLE, Missions, Scale, binned, sampled, scale
from pytest_tarl.seeds import episode_seed
from tests.plugin.monitoring.missions import Walk, fixture, trace, walks


@pytest.fixture(scope="module")
def fitted(tmp_path_factory: pytest.TempPathFactory) -> Scale:
    return scale(fixture(tmp_path_factory.mktemp("scores") / "f.npz", walks(60, 1)))[0]


def columns(how: Scale, some: list[Walk]) -> Missions:
    number = how.number
    rows = [[number.get(cell, len(how.cells)) for cell in one.cells] for one in some]
    return Missions(
        passed=np.array([one.passed for one in some]),
        time=np.zeros(len(some)),
        mission=np.repeat(np.arange(len(some)), [len(one.cells) for one in some]),
        cell=np.array([row for one in rows for row in one], np.int64),
        reward=np.array([amount for one in some for amount in one.reward], np.float64),
    )


rewards = st.one_of(st.floats(-1e6, 1e6), st.sampled_from([0.0, 0.1, -0.1, 1.0]))
cells = st.tuples(st.integers(-1, 4), st.integers(0, 1))
missions = st.builds(
    lambda steps, passed: Walk(
        tuple(cell for cell, _ in steps), tuple(amount for _, amount in steps), passed
    ),
    st.lists(st.tuples(cells, rewards), min_size=1, max_size=12),
    st.booleans(),
)


@given(some=st.lists(missions, min_size=1, max_size=6))
def test_chain_totals_equal_recorded_totals(fitted: Scale, some: list[Walk]) -> None:
    ours = sampled(fitted, columns(fitted, some))
    kept = [
        represented(merge([sample(trace(one), n, one.passed, ())], fitted.cells))
        for n, one in enumerate(some)
    ]
    for n, (one, walked) in enumerate(zip(kept, some, strict=True)):
        assert ours.total[n] == one.total[0]
        assert ours.steps[n] == one.steps[0]
        if not {*walked.cells} <= {*fitted.cells}:
            continue  # cells outside the recording share one row here
        mine = ours.chain.episode == n
        assert list(one.cells) == list(fitted.cells)
        for name in ("cell", "next_cell", "count", "reward"):
            np.testing.assert_array_equal(getattr(ours.chain, name)[mine], getattr(one.chain, name))


@given(some=st.lists(missions, min_size=2, max_size=8), cut=st.integers(1, 7))
def test_mission_scores_are_independent(fitted: Scale, some: list[Walk], cut: int) -> None:
    parts = [part for part in (some[:cut], some[cut:]) if part]
    whole = binned(fitted, sampled(fitted, columns(fitted, some)))
    found = [binned(fitted, sampled(fitted, columns(fitted, part))) for part in parts]
    np.testing.assert_array_equal(whole, np.concatenate(found))


def test_episode_logs_have_the_recorded_bins(tmp_path: Path) -> None:
    some = walks(60, 1)
    constant = [replace(one, reward=(-0.1,) * len(one.cells)) for one in some]
    for number, world in enumerate((some, constant)):
        recorded = fixture(tmp_path / f"{number}.npz", world)
        how, held_out = scale(recorded)
        bins = binned(how, sampled(how, columns(how, world)))
        seeds = sorted((episode_seed(0, "x", n), n) for n in range(len(world)))
        np.testing.assert_array_equal(held_out, bins[[n for seed, n in seeds if not in_fit(seed)]])


def test_missing_steps_do_not_affect_other_scores(
    fitted: Scale,
) -> None:
    known = walks(1, 5)[0]
    some = [Walk((), (), False), replace(known, reward=(float("nan"),) * len(known.cells)), known]
    empty, unjudged, whole = binned(fitted, sampled(fitted, columns(fitted, some)))
    count = len(fitted.cells)
    names = [*WHOLE, *(["cell"] * count)]
    assert {names[place] for place in np.flatnonzero(empty >= 0)} == {"success"}
    assert {names[place] for place in np.flatnonzero(unjudged >= 0)} == {
        "success",
        "unknown",
        "steps",
    }
    assert {names[place] for place in np.flatnonzero(whole >= 0)} == {*names}


def test_a_recording_with_few_episodes_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FixtureError, match="has 2 episodes: too few"):
        scale(fixture(tmp_path / "f.npz", walks(2, 1)))
