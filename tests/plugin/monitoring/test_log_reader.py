"""Logs that grow, are rotated, truncated, damaged or of another recording: each mission counts at most once."""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl.monitoring import log_blocks
from pytest_tarl.monitoring import log_reader as reading_module
from pytest_tarl.monitoring.assembling import Expected
from pytest_tarl.monitoring.log_reader import LogReader
from pytest_tarl.monitoring.mission import Mission, Progress, columns
from pytest_tarl.observing.log_format import MAGIC, Record, encoded
from pytest_tarl.observing.observer import Observer
from pytest_tarl.sensors import binning_digest
from tests.plugin.monitoring.missions import SENSORS, TEST, content, log, records, start, walks
from tests.slow import SLOW

CELLS = sorted({cell for one in walks(30, 0) for cell in one.cells})
EXPECTED = Expected(
    TEST,
    tuple(one.name for one in SENSORS),
    binning_digest(SENSORS),
    {cell: n for n, cell in enumerate(CELLS)},
)


OPEN: list[Reading] = []


@pytest.fixture(autouse=True)
def _closed() -> Iterator[None]:
    yield
    while OPEN:
        OPEN.pop().close()


class Reading:
    """Readers of some logs, and the position up to which each was counted."""

    def __init__(self, *paths: Path) -> None:
        self.known: dict[str, Progress] = {}
        owners: dict[str, Path] = {}
        self.readers = [LogReader(path, EXPECTED, self.known, owners) for path in paths]
        self.rewards: list[float] = []
        OPEN.append(self)

    def read(self) -> int:
        """Read to the end of the logs; return the number of missions read so far."""
        for reader in self.readers:
            for mission in reader.missions():
                self.take(mission)
        return len(self.rewards)

    def take(self, mission: Mission) -> None:
        self.known[mission.progress.log] = mission.progress
        self.rewards.append(float(columns([mission])[2].sum()))

    def close(self) -> None:
        for reader in self.readers:
            reader.close()

    @property
    def problems(self) -> list[str]:
        return [one.problem for one in self.readers if one.problem]


@contextmanager
def blocks_of(size: int) -> Iterator[None]:
    """Read logs in blocks of `size` bytes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reading_module, "next_block", partial(log_blocks.next_block, size=size))
        yield


def sums(some: list) -> list[float]:  # type: ignore[type-arg]
    return [float(np.sum(one.reward)) for one in some]


SIZES = st.sampled_from([1, 7, 100, 400, 1000, 5000, log_blocks.BLOCK])


@settings(max_examples=200 if SLOW else 40)
@given(cuts=st.lists(st.integers(0, 10_000), max_size=12), restart=st.booleans(), size=SIZES)
def test_each_mission_of_a_growing_log_is_read_once(
    tmp_path_factory: pytest.TempPathFactory, cuts: list[int], restart: bool, size: int
) -> None:
    some = walks(6, 3)
    path = tmp_path_factory.mktemp("grows") / "m.log"
    whole = MAGIC + encoded(start()) + content(some[:3]) + encoded(start(time=3.0)) + content(some[3:])
    reading = Reading(path)
    for end in [*sorted(min(cut, len(whole)) for cut in cuts), len(whole)]:
        path.write_bytes(whole[:end]) if not path.exists() else _grow(path, whole[:end])
        with blocks_of(size):
            reading.read()
        if restart:
            again = Reading(path)
            again.known.update(reading.known)
            again.rewards = reading.rewards
            reading.close()
            reading = again
    reading.close()
    assert reading.rewards == sums(some)
    assert reading.problems == []


def _grow(path: Path, content: bytes) -> None:
    with path.open("ab") as file:
        file.write(content[path.stat().st_size :])


KINDS = (
    "at once",
    "in pieces",
    "otherwise",
    "new cell",
    "without steps",
    "torn",
    "stray",
    "start",
    "foreign",
)


def written(kind: str, number: int) -> bytes:
    """Return records that an observer or another program appends to a log."""
    one, began = walks(1, number)[0], 2000.0 + number
    if kind in ("start", "foreign"):
        return encoded(start(time=began, **({"sensors": ["y"]} if kind == "foreign" else {})))
    if kind == "new cell":
        one = type(one)(((9, 9), (0, 0)), (1.0, 2.0), False)
    told = records(one, began, pieces=3 if kind == "in pieces" else 1)
    if kind == "otherwise":
        told = [dict(reversed(one.items())) for one in told]
    if kind == "without steps":
        told = [told[0], told[-1]]
    if kind == "torn":
        told = told[:-1]
    if kind == "stray":
        told = told[1:]
    return b"".join(map(encoded, told))


def everything(path: Path, size: int) -> tuple[list[tuple[object, ...]], object]:
    """Return all missions of a log, read in blocks of `size` bytes, and the position after each."""
    reader = LogReader(path, EXPECTED, {}, {})
    with blocks_of(size):
        found = [
            (one.passed, one.time, one.new, one.progress, *(column.tobytes() for column in columns([one])))
            for one in reader.missions()
        ]
    progress, problem = reader.progress, reader.problem
    reader.close()
    return found, (progress, problem)


@settings(max_examples=300 if SLOW else 30)
@given(kinds=st.lists(st.sampled_from(KINDS), max_size=14), size=SIZES, torn=st.integers(0, 60))
def test_the_result_does_not_depend_on_block_boundaries(
    tmp_path_factory: pytest.TempPathFactory, kinds: list[str], size: int, torn: int
) -> None:
    """With one record per block, each record is parsed as JSON; in a large block, short missions match a pattern."""
    path = tmp_path_factory.mktemp("blocks") / "m.log"
    whole = MAGIC + encoded(start()) + b"".join(written(kind, number) for number, kind in enumerate(kinds))
    path.write_bytes(whole[: max(len(MAGIC) + len(encoded(start())), len(whole) - torn)])
    assert everything(path, size) == everything(path, 1)


@pytest.mark.parametrize("at_start", [True, False])
def test_short_missions_are_taken_without_decoding_their_records(tmp_path: Path, at_start: bool) -> None:
    path = log(tmp_path / "m.log", walks(5, 3))
    with path.open("rb") as file:
        block = log_blocks.next_block(file, len(MAGIC))
        assert block.record()["kind"] == "start"
        if at_start:  # at the start of a block
            block = log_blocks.next_block(file, log_blocks.end_of(block.spot()))
        assert [one[4] for one in block.at_once()] == [
            b"true" if one.passed else b"false" for one in walks(5, 3)
        ]
    assert not block.left()


def test_hand_made_records_equal_written_records(tmp_path: Path) -> None:
    (walk,) = walks(1, 3)
    observer = Observer(SENSORS, tmp_path / "m.log", {"sites": [], "sensors": [one.name for one in SENSORS]})
    observer.begin()
    for cell, reward in zip(walk.cells, walk.reward, strict=True):
        observer.stream.latch(cell)
        observer.step(reward)
    observer.end(passed=walk.passed)
    observer.close()
    with (tmp_path / "m.log").open("rb") as file:
        block = log_blocks.next_block(file, len(MAGIC))
    kept, made = list(records_of(block)), records(walk)
    assert [[*one] for one in kept[1:]] == [[*one] for one in made]
    assert all(kept[2][name] == made[1][name] for name in ("cells", "step_cell", "reward", "site"))


def records_of(block: log_blocks.Block) -> Iterator[Record]:
    while block.left():
        yield block.record()


def test_unprocessed_missions_are_read_again(tmp_path: Path) -> None:
    some = walks(5, 3)
    reading = Reading(log(tmp_path / "m.log", some))
    for mission in reading.readers[0].missions():
        reading.take(mission)
        break
    assert reading.read() == 5
    assert reading.rewards == sums(some)


def test_an_invalid_json_record_is_reported(tmp_path: Path) -> None:
    path = log(tmp_path / "m.log", walks(2, 2))
    payload = zlib.compress(b"no json")
    with path.open("ab") as file:
        file.write(struct.pack("<II", len(payload), zlib.crc32(payload)) + payload + content(walks(1, 3)))
    reading = Reading(path)
    assert reading.read() == 2
    assert "is damaged at byte" in reading.problems[0]


def test_mission_cells_are_read_from_a_log(tmp_path: Path) -> None:
    some = walks(4, 7)
    other = type(some[0])(((9, 9), (0, 0), (9, 9)), (1.0, 2.0, 3.0), True)
    path = log(tmp_path / "m.log", [*some, other])
    reader = LogReader(path, EXPECTED, {}, {})
    missions = list(reader.missions())
    reader.close()
    assert missions[-1].new == ((9, 9),)
    assert columns(missions[-1:])[1].tolist() == [len(CELLS), CELLS.index((0, 0)), len(CELLS)]
    for mission, one in zip(missions, some, strict=False):
        assert [CELLS[row] for row in columns([mission])[1].tolist()] == [*one.cells]
        assert mission.new == ()


def test_rotated_log_is_finished_first(tmp_path: Path) -> None:
    some = walks(6, 2)
    path, old = tmp_path / "m.log", tmp_path / "m.log.1"
    log(path, some[:2])
    reading = Reading(path, old)
    assert reading.read() == 2
    with path.open("ab") as file:
        file.write(content(some[2:4]))
    path.rename(old)
    log(path, some[4:], time=5000.0)
    reading.read()
    reading.read()
    assert reading.rewards == sums(some)
    assert reading.problems == []
    reading.close()
    again = Reading(old, path)
    again.known.update(reading.known)
    assert again.read() == 0


def test_log_under_two_names_is_counted_once(tmp_path: Path) -> None:
    path = log(tmp_path / "m.log", walks(3, 2))
    os.link(path, tmp_path / "same.log")
    reading = Reading(path, tmp_path / "same.log")
    assert reading.read() == 3
    assert "is the same log as" in reading.problems[0]


def test_a_truncated_log_is_reported_and_counted_once(tmp_path: Path) -> None:
    some = walks(5, 2)
    path = log(tmp_path / "m.log", some)
    reading = Reading(path)
    reading.read()
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    reading.read()
    assert "was truncated or changed" in reading.problems[0]
    path.write_bytes(whole + content(some[:1]))
    reading.read()
    assert reading.rewards == sums([*some, some[0]])
    assert reading.problems == []


def test_a_problem_is_forgotten_once_another_file_is_in_its_place(tmp_path: Path) -> None:
    path = tmp_path / "m.log"
    path.write_bytes(b"another format")
    reading = Reading(path)
    reading.read()
    assert "is not a log of `tarl observe`" in reading.problems[0]
    path.write_bytes(b"")  # a new log, still empty
    assert (reading.read(), reading.problems) == (0, [])


def test_a_replaced_log_is_read_from_the_beginning(tmp_path: Path) -> None:
    some = walks(5, 2)
    path = log(tmp_path / "m.log", some[:3])
    reading = Reading(path)
    reading.read()
    path.unlink()
    log(path, some[3:], time=9.0)
    reading.read()
    assert reading.rewards == sums(some)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"sensors": ["y"]}, "was written with the sensors y, but the recording"),
        ({"test": "test_other.py::test_x"}, "was written for the recording of test_other.py::test_x"),
        ({"bins": "0123"}, "had other bins"),
    ],
)
def test_missions_of_another_recording_are_reported_and_not_counted(
    tmp_path: Path, changes: dict[str, object], says: str
) -> None:
    some = walks(4, 2)
    path = log(tmp_path / "m.log", some[:2])
    log(path, some[2:3], **changes)
    reading = Reading(path)
    assert reading.read() == 2
    assert says in reading.problems[0]
    again = Reading(path)  # a continued watch still knows the log
    again.known.update({one.progress.log: one.progress for one in reading.readers if one.progress})
    assert again.read() == 0
    assert says in again.problems[0]
    log(path, some[3:])
    assert reading.read() == 3
    assert reading.problems == []


def test_old_log_without_bins_is_read(tmp_path: Path) -> None:
    begin = start()
    del begin["bins"]
    path = tmp_path / "m.log"
    path.write_bytes(MAGIC + encoded(begin) + content(walks(2, 2)))
    assert Reading(path).read() == 2


def test_a_damaged_record_is_reported(tmp_path: Path) -> None:
    path = log(tmp_path / "m.log", walks(5, 2))
    whole = bytearray(path.read_bytes())
    whole[len(whole) // 2] ^= 1
    path.write_bytes(whole)
    reading = Reading(path)
    assert 0 < reading.read() < 5
    assert "is damaged at byte" in reading.problems[0]


def test_missing_files_and_other_formats_are_reported(tmp_path: Path) -> None:
    other = tmp_path / "picture.png"
    other.write_bytes(b"\x89PNG")
    reading = Reading(other, tmp_path / "none.log", tmp_path)
    assert reading.read() == 0
    assert [
        next(words for words in ("is not a log", "does not exist yet", "cannot be read") if words in one)
        for one in reading.problems
    ] == ["is not a log", "does not exist yet", "cannot be read"]
    log(tmp_path / "none.log", walks(1, 0))
    assert reading.read() == 1


def test_missions_without_an_end_are_counted_separately(tmp_path: Path) -> None:
    some = walks(3, 2)
    path = tmp_path / "m.log"
    pieces = [encoded(record) for one in some for record in records(one, pieces=3)]
    path.write_bytes(MAGIC + encoded(start()) + b"".join(pieces[:4] + pieces[5:]))
    reading = Reading(path)
    assert reading.read() == 2
    assert reading.readers[0].progress is not None
    assert reading.readers[0].progress.unfinished == 1
    assert reading.rewards == sums(some[1:])


def test_a_record_of_no_mission_is_not_read_again(tmp_path: Path) -> None:
    """Between two missions is a part of a third one, whose beginning was lost."""
    first, second = ([*records(one, pieces=3)] for one in walks(2, 2))
    done = MAGIC + b"".join(map(encoded, [start(), *first, first[1]]))
    path = tmp_path / "m.log"
    path.write_bytes(done + b"".join(map(encoded, second[:2])))
    reading = Reading(path)
    assert reading.read() == 1
    progress = reading.readers[0].progress
    assert progress is not None
    assert (progress.offset, progress.missions, progress.unfinished) == (len(done), 1, 0)
    with path.open("ab") as file:
        file.write(b"".join(map(encoded, second[2:])))
    assert reading.read() == 2
