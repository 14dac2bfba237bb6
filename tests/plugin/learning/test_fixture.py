"""The recording file: complete, reproducible to the byte, and never used in part."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from pytest_tarl.errors import FixtureError
from pytest_tarl.learning import fixture as fixtures
from pytest_tarl.learning.fixture import Fixture, load, save
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.packing import packed_table, unpacked_table
from pytest_tarl.learning.tables import Sample
from pytest_tarl.model import SitePlace, TaintList
from pytest_tarl.sensors import Sensor
from tests.plugin.learning.test_statistics import MEMBERS, random_sample, same, tables


def site(n: int) -> SitePlace:
    return SitePlace(f"node:run:x{n} = «{n}»", "node.py", n + 1, f"x{n} = «{n}»", "data", "assign")


def example(sample: Sample | None = None) -> Fixture:
    whole = sample or merge([random_sample(seed) for seed in range(6)])
    lists = tuple(
        TaintList(f"/in{i}", "/out", tuple(map(site, members))) for i, members in enumerate(MEMBERS)
    )
    return Fixture(
        test="test_node.py::test_it",
        seed=3,
        sensors=(Sensor("x", topic="/in0", field="data", low=0, high=1, bins=4), Sensor("terrain")),
        lists=lists,
        topics={"/in0": "std_msgs/msg/Float64"},
        sample=whole,
        sarsa=tuple(np.full((len(whole.cells), len(members)), np.nan) for members in MEMBERS),
    )


def close(first: Sample, second: Sample) -> bool:
    """Return whether counts are equal, sums within 1e-5 (relative) and sums of squares within 0.3 %."""
    plain = (first.cells, first.seeds, first.part_names) == (second.cells, second.seeds, second.part_names)
    return plain and all(
        np.allclose(mine, theirs, rtol=3e-3 if name.endswith("squared") else 1e-5, atol=0)
        for one, other in zip(tables(first), tables(second), strict=True)
        for (name, mine), theirs in zip(vars(one).items(), vars(other).values(), strict=True)
        if isinstance(mine, np.ndarray)
    )


def test_recording_is_equal_after_loading(tmp_path: Path) -> None:
    fixture, path = example(), tmp_path / "deep" / "a.npz"
    save(fixture, path)
    loaded = load(path)
    assert loaded.sample.total.tobytes() == fixture.sample.total.tobytes()
    assert close(loaded.sample, fixture.sample)
    assert (loaded.test, loaded.seed, loaded.sensors, loaded.lists, loaded.topics) == (
        fixture.test,
        fixture.seed,
        fixture.sensors,
        fixture.lists,
        fixture.topics,
    )
    assert [table.shape for table in loaded.sarsa] == [table.shape for table in fixture.sarsa]


def test_saving_a_loaded_recording_gives_the_same_bytes(tmp_path: Path) -> None:
    first, second = tmp_path / "a.npz", tmp_path / "b.npz"
    save(example(), first)
    save(load(first), second)
    assert first.read_bytes() == second.read_bytes()


@given(st.lists(st.integers(0, 40), min_size=1, max_size=6, unique=True), st.randoms(use_true_random=False))
@settings(max_examples=25)
def test_recordings_merged_in_any_order_give_the_same_file(seeds: list[int], random: object) -> None:
    singles = [random_sample(seed) for seed in seeds]
    random.shuffle(singles)  # type: ignore[attr-defined]
    half = len(singles) // 2
    groups = [merge(group) for group in (singles[:half], singles[half:]) if group]
    with TemporaryDirectory() as folder:
        one, other = Path(folder, "one.npz"), Path(folder, "other.npz")
        save(example(merge([random_sample(seed) for seed in sorted(seeds)])), one)
        save(example(merge(groups)), other)
        assert one.read_bytes() == other.read_bytes()
        assert same(load(one).sample, load(other).sample)


@given(st.lists(st.floats(-1e300, 1e300, allow_subnormal=False), min_size=1, max_size=30))
def test_numbers_are_restored_within_five_in_a_million(values: list[float]) -> None:
    table = np.array([[*values, np.nan]])
    found = unpacked_table("t", packed_table("t", table))
    assert np.allclose(found, table, rtol=6e-6, atol=0, equal_nan=True)


def test_older_format_names_the_command_to_record_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.npz"
    monkeypatch.setattr(fixtures, "FORMAT_VERSION", 1)
    save(example(), path)
    monkeypatch.undo()
    with pytest.raises(
        FixtureError, match=r"a\.npz has format 1, but this version of tarl reads 2\..*--tarl-record"
    ):
        load(path)


def test_newer_format_names_the_required_version(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.npz"
    monkeypatch.setattr(fixtures, "FORMAT_VERSION", 3)
    save(example(), path)
    monkeypatch.undo()
    with pytest.raises(FixtureError, match=r"has format 3.*Use the version of tarl"):
        load(path)


def test_incomplete_header_is_refused_despite_its_digest(tmp_path: Path) -> None:
    header: dict[str, object] = {"format": fixtures.FORMAT_VERSION, "test": "t"}
    header["digest"] = fixtures._digest(header, {})
    path = tmp_path / "a.npz"
    np.savez(path, header=np.frombuffer(json.dumps(header).encode(), dtype=np.uint8))
    with pytest.raises(FixtureError, match=r"a\.npz is not valid in format"):
        load(path)


def test_equal_episodes_give_equal_bytes(tmp_path: Path) -> None:
    first, second = tmp_path / "a.npz", tmp_path / "b.npz"
    save(example(), first)
    save(example(), second)
    assert first.read_bytes() == second.read_bytes()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.npz", "b.npz"]


@pytest.mark.parametrize("cut", [0, 1, 50, 500, -1, -40])
def test_the_error_about_a_truncated_file_names_the_file(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "a.npz"
    save(example(), path)
    path.write_bytes(path.read_bytes()[:cut])
    with pytest.raises(FixtureError, match=r"a\.npz is damaged.*--tarl-record"):
        load(path)


def test_the_digest_detects_a_changed_column(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    save(example(), path)
    with np.load(path) as archive:
        columns = dict(archive)
    columns["total"] = columns["total"] + 1
    np.savez(path, **columns)
    with pytest.raises(FixtureError, match="digest"):
        load(path)


def test_archives_of_other_programs_and_pickled_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    np.savez(path, other=np.arange(3))
    with pytest.raises(FixtureError, match="damaged or is not a recording"):
        load(path)
    np.savez(path, header=np.array([{}], dtype=object))
    with pytest.raises(FixtureError, match="damaged or is not a recording"):
        load(path)


def test_foreign_format_error_names_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.npz"
    monkeypatch.setattr("pytest_tarl.learning.fixture.FORMAT_VERSION", 99)
    save(example(), path)
    monkeypatch.undo()
    with pytest.raises(FixtureError, match="format 99"):
        load(path)


def test_missing_recording_error_names_the_command(tmp_path: Path) -> None:
    with pytest.raises(FixtureError, match=r"no such recording.*--tarl-record"):
        load(tmp_path / "a.npz")


def test_an_interrupted_write_keeps_the_old_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.npz"
    save(example(), path)
    before = path.read_bytes()

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        save(replace(example(), seed=4), path)
    monkeypatch.undo()
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["a.npz"]
