"""`tarl merge`: the recording of several robots equals that of all their missions together."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from pytest_tarl.commands.cli import main
from pytest_tarl.errors import FixtureError, LogError
from pytest_tarl.fleet.merged import merged
from pytest_tarl.learning.fixture import Fixture, load, save
from pytest_tarl.learning.guarantees import stated
from pytest_tarl.learning.merging import merge
from tests.plugin.learning.test_fixture import example
from tests.plugin.learning.test_statistics import random_sample
from tests.plugin.monitoring import missions


def recording(folder: Path, name: str, seeds: list[int], **changes: object) -> Path:
    sample = merge([random_sample(seed) for seed in seeds])
    bounds = stated(sample.passed.tolist(), sample.total.tolist())
    path = folder / f"{name}.npz"
    save(replace(example(sample), stated=bounds, **changes), path)  # type: ignore[arg-type]
    return path


def content(found: Fixture, folder: Path) -> bytes:
    save(found, folder / "content.npz")
    return (folder / "content.npz").read_bytes()


@given(
    st.lists(
        st.tuples(st.integers(0, 60), st.integers(0, 3)),
        min_size=2,
        max_size=12,
        unique_by=lambda one: one[0],
    ),
    st.randoms(use_true_random=False),
)
@settings(max_examples=25, deadline=None)
def test_merged_recordings_equal_a_single_one(owned: list[tuple[int, int]], random: Random) -> None:
    with TemporaryDirectory() as name:
        folder = Path(name)
        robots = [
            recording(folder, f"robot{robot}", [seed for seed, owner in owned if owner == robot])
            for robot in sorted({owner for _, owner in owned})
        ]
        random.shuffle(robots)
        together, _ = merged([recording(folder, "all", [seed for seed, _ in owned])])
        apart, parts = merged(robots)
        assert content(apart, folder) == content(together, folder)
        assert all(
            np.array_equal(a, b, equal_nan=True) for a, b in zip(apart.sarsa, together.sarsa, strict=True)
        )
        assert sum(one.episodes for one in parts) == together.sample.episodes == len(owned)
        assert not any(one.known for one in parts)


def test_an_episode_in_two_recordings_counts_once(tmp_path: Path) -> None:
    first, second = recording(tmp_path, "a", [1, 2, 3]), recording(tmp_path, "b", [3, 4])
    found, parts = merged([first, second])
    assert found.sample.seeds == (1, 2, 3, 4)
    assert [(one.episodes, one.known) for one in parts] == [(3, 0), (2, 1)]


def test_a_merged_recording_states_bounds_over_all_episodes(tmp_path: Path) -> None:
    found, _ = merged([recording(tmp_path, "a", [*range(9)]), recording(tmp_path, "b", [*range(9, 30)])])
    assert found.stated is not None
    assert found.stated.episodes == 30
    assert found.stated.passed == int(found.sample.passed.sum())
    assert found.stated.success.confidence == 0.95


@pytest.mark.parametrize(("changes", "named"), [
    ({"test": "test_other.py::test_it"}, "test"),
    ({"sensors": example().sensors[:1]}, "sensors or bins"),
    ({"lists": tuple(replace(one, source="/other") for one in example().lists)}, "statements"),
    ({"design": ("worn",)}, "permanent drifts"),
])  # fmt: skip
def test_unmergeable_recordings_are_named_with_the_reason(
    changes: dict[str, object], named: str, tmp_path: Path
) -> None:
    first, second = recording(tmp_path, "a", [1, 2]), tmp_path / "b.npz"
    other = replace(example(merge([random_sample(3)])), **changes)  # type: ignore[arg-type]
    if "sensors" in changes:  # cells have one number per sensor
        cells = tuple((n,) for n in range(len(other.sample.cells)))
        other = replace(other, sample=replace(other.sample, cells=cells))
    save(other, second)
    with pytest.raises(FixtureError, match=rf"b\.npz and .*a\.npz cannot be merged: .*{named}"):
        merged([first, second])


def test_robot_logs_are_merged_with_their_recording(tmp_path: Path) -> None:
    test = tmp_path / "test.npz"
    missions.fixture(test, missions.walks(20, 1))
    robots = [
        missions.log(tmp_path / f"r{n}.log", missions.walks(5 + n, 10 + n), 2000.0 + 100 * n)
        for n in range(3)
    ]
    found, parts = merged([test, *robots])
    assert found.sample.episodes == 20 + 5 + 6 + 7
    assert [one.episodes for one in parts] == [20, 5, 6, 7]
    alone, _ = merged(robots, test)
    assert alone.sample.episodes == 5 + 6 + 7
    expected = sorted(sum(walk.reward) for n in range(3) for walk in missions.walks(5 + n, 10 + n))
    assert sorted(alone.sample.total.tolist()) == pytest.approx(expected)


def test_a_copied_log_adds_no_mission(tmp_path: Path) -> None:
    test = tmp_path / "test.npz"
    missions.fixture(test, missions.walks(20, 1))
    log = missions.log(tmp_path / "r.log", missions.walks(8, 2))
    copy = tmp_path / "backup.log"
    copy.write_bytes(log.read_bytes())
    once, _ = merged([log], test)
    twice, parts = merged([log, copy], test)
    assert content(once, tmp_path) == content(twice, tmp_path)
    assert parts[1].known == 8


def test_merging_logs_by_parts_equals_merging_them_at_once(tmp_path: Path) -> None:
    test = tmp_path / "test.npz"
    missions.fixture(test, missions.walks(20, 1))
    robots = [missions.log(tmp_path / f"r{n}.log", missions.walks(6, n), 3000.0 * n) for n in range(4)]
    halves = []
    for number, some in enumerate((robots[:2], robots[2:])):
        halves.append(tmp_path / f"half{number}.npz")
        save(merged(some, test)[0], halves[-1])
    assert content(merged(halves)[0], tmp_path) == content(merged(robots, test)[0], tmp_path)


def test_merged_recording_can_be_compared_and_merged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first, second = recording(tmp_path, "a", [1, 2, 3]), recording(tmp_path, "b", [3, 4])
    to = tmp_path / "fleet.npz"
    assert main(["merge", str(first), str(second), "--to", str(to)]) == 0
    out = capsys.readouterr().out
    assert f"{second}: 2 episodes, 1 of them already counted" in out
    assert out.endswith("4 episodes of test_node.py::test_it, 8 cells\n")
    assert load(to).sample.episodes == 4


@pytest.mark.parametrize("kind", ["absent", "text", "log alone", "unfinished"])
def test_unmergeable_recordings_write_no_file(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    test, other, to = tmp_path / "test.npz", tmp_path / "other.log", tmp_path / "fleet.npz"
    missions.fixture(test, missions.walks(20, 1))
    if kind == "text":
        other.write_text("no recording")
    elif kind == "log alone":
        missions.log(other, missions.walks(3, 2))
    elif kind == "unfinished":
        missions.log(other, [])
    said = {"absent": "no such recording", "text": "is damaged or is not a recording", "log alone": "--fixture",
            "unfinished": "holds no finished mission"}  # fmt: skip
    named = [str(other)] if kind == "log alone" else [str(test), str(other)]
    assert main(["merge", *named, "--to", str(to)]) == 2
    err = capsys.readouterr().err
    assert said[kind] in err
    assert err.count("\n") == 1
    assert not to.exists()


def test_a_log_of_other_sensors_is_refused(tmp_path: Path) -> None:
    test = tmp_path / "test.npz"
    missions.fixture(test, missions.walks(20, 1))
    log = missions.log(tmp_path / "r.log", missions.walks(3, 2), sensors=["x", "dry"])
    with pytest.raises(LogError, match="was written with the sensors x, dry"):
        merged([test, log])


def test_totals_outside_the_declared_range_are_refused(tmp_path: Path) -> None:
    from pytest_tarl.learning.bounds import Range

    test = tmp_path / "test.npz"
    missions.fixture(test, missions.walks(20, 1), Range(0.0, 10.0))
    rich = [replace(one, reward=tuple(9.0 for _ in one.reward)) for one in missions.walks(3, 2)]
    log = missions.log(tmp_path / "r.log", rich)
    with pytest.raises(FixtureError, match=r"total_range"):
        merged([test, log])
