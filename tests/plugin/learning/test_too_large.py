"""A recording that does not fit into memory is refused before it is unpacked, and reported while it is recorded."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pytest_tarl import free_memory
from pytest_tarl.errors import FixtureError, RecordingError
from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.learning import archive, footprint
from pytest_tarl.learning.fixture import load, save
from pytest_tarl.learning.footprint import FIRST, PEAK, Footprint, nbytes
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Sample
from tests.plugin.learning.test_fixture import example
from tests.plugin.tank import RECORD, fixture_file


def test_a_recording_larger_than_the_free_memory_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.npz"
    save(example(), path)
    monkeypatch.setattr(archive, "available", lambda: 1000)
    with pytest.raises(
        FixtureError, match=r"a\.npz takes about .* GB of memory to read, and 0\.0 GB are free.*fewer"
    ):
        load(path)
    for free in (10**12, None):
        monkeypatch.setattr(archive, "available", lambda free=free: free)
        assert load(path).test == "test_node.py::test_it"


def test_free_memory_is_read_from_the_system(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    meminfo = tmp_path / "meminfo"
    monkeypatch.setattr(free_memory, "_MEMINFO", meminfo)
    monkeypatch.setattr(free_memory, "_OWN_GROUPS", tmp_path / "no groups")
    assert free_memory.available() is None
    meminfo.write_text("MemTotal:       100 kB\nMemAvailable:     77 kB\nBuffers:    3 kB\n")
    assert free_memory.available() == 77 * 1024
    meminfo.write_text("nothing of it\n")
    assert free_memory.available() is None


def group(folder: Path, version: int, most: str, used: int, droppable: int) -> None:
    """Write the files of a control group with a memory limit."""
    folder.mkdir(parents=True)
    limit, usage, statistic = free_memory._FILES[version]
    (folder / limit).write_text(f"{most}\n")
    (folder / usage).write_text(f"{used}\n")
    (folder / "memory.stat").write_text(f"anon 1\n{statistic} {droppable}\nfile 3\n")


@pytest.mark.parametrize(("version", "line"), [(2, "0::"), (1, "4:cpu,memory:")])
def test_container_memory_limit_applies_at_any_level(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, version: int, line: str
) -> None:
    meminfo, groups, own = tmp_path / "meminfo", tmp_path / "cgroup", tmp_path / "own"
    meminfo.write_text("MemAvailable:     8000 kB\n")
    base = groups / "memory" if version == 1 else groups
    for name, path in {"_MEMINFO": meminfo, "_GROUPS": groups, "_OWN_GROUPS": own}.items():
        monkeypatch.setattr(free_memory, name, path)
    own.write_text(f"3:cpuset:/elsewhere\n{line}/pods/one\n")
    group(base / "pods" / "one", version, "max" if version == 2 else str(2**63 - 4096), 500_000, 0)
    assert free_memory.available() == 8000 * 1024
    group(base / "pods" / "two", version, "1000", 0, 0)  # a sibling group with another limit
    (base / "pods" / "memory.stat").write_text("")
    limit, usage, _ = free_memory._FILES[version]
    (base / "pods" / limit).write_text("3000000")
    (base / "pods" / usage).write_text("1000000")
    assert free_memory.available() == 2_000_000  # limit of the enclosing control group
    statistic = free_memory._FILES[version][2]
    (base / "pods" / "memory.stat").write_text(f"{statistic} 500000\n")
    assert free_memory.available() == 2_500_000
    (base / "pods" / usage).write_text("9000000")
    assert free_memory.available() == 0
    own.write_text(f"{line}/not/seen/in/here\n")  # a container sees its own group as the root
    (base / "memory.stat").write_text("anon 1\n")
    (base / limit).write_text("700000")
    (base / usage).write_text("0")
    assert free_memory.available() == 700_000


def walk(seed: int, steps: int = 300) -> Sample:
    """Return the statistics of an episode that wanders through 100 cells and runs 10 sites."""
    draws = np.random.default_rng(seed)
    recorder = Recorder()
    place = 50
    for _ in range(steps):
        place = (place + int(draws.integers(-3, 4))) % 100
        recorder.latch((place,))
        for site in range(10):
            recorder.hook(site, float(place))
        recorder.reward(float(draws.normal()))
    return sample(recorder.finish(), seed, True, [range(10)])


def test_merging_and_writing_stay_within_the_predicted_memory(tmp_path: Path) -> None:
    template = example()
    lists = (replace(template.lists[0], sites=template.lists[0].sites[:1] * 10),)
    template = replace(template, sensors=template.sensors[:1], lists=lists)
    samples = [walk(seed) for seed in range(20)]
    held = sum(map(nbytes, samples))
    tracemalloc.start()
    try:
        whole = merge(samples)
        table = np.full((len(whole.cells), 10), np.nan)
        save(replace(template, sample=whole, sarsa=(table,)), tmp_path / "a.npz")
        peak = held + tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert 0.4 * PEAK * held < peak <= PEAK * held
    assert nbytes(whole) == pytest.approx(held, rel=0.01)


def test_the_first_episodes_predict_that_memory_will_not_suffice(monkeypatch: pytest.MonkeyPatch) -> None:
    one = walk(0)
    told: list[str] = []
    need = PEAK * nbytes(one)
    monkeypatch.setattr(footprint, "available", lambda: 500 * need)
    seen = Footprint(expected=1000, tell=told.append)
    for _ in range(FIRST - 1):
        seen.add(one)
    assert told == []
    for _ in range(10):
        seen.add(one)
    assert told == [seen.warning]  # once
    assert "1,000 episodes will need about" in seen.warning
    assert "at most 500 with --tarl-episodes" in seen.warning
    enough = Footprint(expected=499, tell=told.append)
    unknown = Footprint(expected=10**9, tell=told.append)
    for _ in range(10):
        enough.add(one)
        monkeypatch.setattr(footprint, "available", lambda: None)
        unknown.add(one)
        monkeypatch.setattr(footprint, "available", lambda: 500 * need)
    assert len(told) == 1
    assert (enough.warning, unknown.warning) == ("", "")


def test_larger_later_episodes_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    small, large = walk(0, 10), walk(0, 2000)
    monkeypatch.setattr(footprint, "available", lambda: 60 * PEAK * nbytes(large))
    told: list[str] = []
    seen = Footprint(expected=100, tell=told.append)
    for one in [small] * 10 + [large] * 38:
        seen.add(one)
    assert "100 episodes will need" in told[0]


def test_recording_stops_before_memory_is_exhausted(monkeypatch: pytest.MonkeyPatch) -> None:
    one = walk(0)
    monkeypatch.setattr(footprint, "STRIDE", 1)
    seen = Footprint(expected=1000)
    monkeypatch.setattr(footprint, "available", lambda: 20 * PEAK * nbytes(one) - seen.held)
    for _ in range(20):
        seen.add(one)
    with pytest.raises(
        RecordingError, match=r"Stopped after 21 of 1,000 episodes.*GB are free.*at most 20 with"
    ):
        seen.add(one)


def test_insufficient_memory_is_reported_early_and_nothing_is_written(
    tank: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(footprint, "available", lambda: 1000)
    warned = tank.runpytest(*RECORD)
    warned.assert_outcomes(passed=1, deselected=1)
    text = warned.stdout.str()
    assert text.index("16 episodes will need about") < text.index("recorded ATR")
    before = fixture_file(tank).read_bytes()
    monkeypatch.setattr(footprint, "STRIDE", 1)
    stopped = tank.runpytest(*RECORD, "--tarl-seed=5")
    stopped.assert_outcomes(failed=1, deselected=1)
    stopped.stdout.fnmatch_lines(["*Stopped after 1 of 16 episodes: writing them needs about*GB are free.*"])
    assert fixture_file(tank).read_bytes() == before
