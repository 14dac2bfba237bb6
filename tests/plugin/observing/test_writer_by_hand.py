"""The writer's program and its log, in the process of the test."""

from __future__ import annotations

import base64
import io
import json
import marshal
import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.errors import LogError
from pytest_tarl.observing import ring, writer_main
from pytest_tarl.observing import writer as writing
from pytest_tarl.observing.log_format import MAGIC, LogFile, encoded, records, set_aside
from pytest_tarl.observing.ring import Ring, shared_memory
from pytest_tarl.observing.writer import Rotation, Writer, packed, unpacked
from pytest_tarl.observing.writer_main import LENGTH, PERIOD


class Clock:
    def __init__(self, now: float) -> None:
        self.now = now

    def __call__(self) -> float:
        return self.now


class Log:
    """A log file that keeps the records."""

    def __init__(self, size: int = 0) -> None:
        self.records: list[dict[str, Any]] = []
        self.size = size
        self.log: list[Any] = []

    def append(self, record: dict[str, Any]) -> None:
        self.records.append(record)
        self.log.append(record["kind"])

    def sync(self) -> None:
        self.log.append("sync")

    def close(self) -> None:
        self.log.append("close")

    def set_aside(self, keep: int) -> None:
        self.log.append(("aside", keep))


def cut(*rewards: float, entries: list[Any] | None = None, cells: list[Any] | None = None) -> tuple[Any, ...]:
    """Return a cut with a mark for each reward; all events come before the first one."""
    marks, given = len(rewards), entries or []
    return (cells or [], [0] * marks, [*range(marks)], [*rewards], [(given, [len(given)] * marks)])


def written(*messages: tuple[Any, ...], log: Log | None = None, rotation: Rotation | None = None) -> Log:
    made: Any = Log() if log is None else log
    one = Writer(made, {"node": "n"}, rotation or Rotation())
    for each in messages:
        one.take(each)
    one.close()
    found: Log = made
    return found


def test_log_start_is_on_disk_at_once() -> None:
    log = written(("start", 5.0))
    assert log.records == [{"kind": "start", "time": 5.0, "node": "n"}]
    assert log.log == ["start", "sync", "close"]


def test_steps_are_collected_until_the_mission_ends() -> None:
    log = written(
        ("mission", 1.0),
        ("steps", cut(1.0, 2.0, entries=[3, 0.5], cells=[(4,)]), [7.0, None, 8.0, "auto"], 0, None),
        ("steps", cut(3.0, entries=[5, 1.5, 6, -2.5]), [9.0, None], 4, None),
        ("end", {"passed": True}),
        ("steps", cut(4.0), [], 4, None),
    )
    assert log.log == ["mission", "steps", "end", "steps", "close"]
    one = log.records[1]
    assert one["readings"] == [[7.0, None], [8.0, "auto"], [9.0, None]]
    assert (one["dropped"], one["cells"]) == (4, [[4]])
    kinds = {
        "site": ("int32", [3, 5, 6]),
        "flow": ("float64", [0.5, 1.5, 2.5]),
        "cell": ("int32", [-1, 0, 0]),
        "step": ("int32", [0, 2, 2]),
        "thread": ("int32", [0, 0, 0]),
        "step_cell": ("int32", [0, 0, 0]),
        "reward": ("float64", [1.0, 2.0, 3.0]),
    }
    assert {name: unpacked(one[name], kind).tolist() for name, (kind, _) in kinds.items()} == {
        name: values for name, (_, values) in kinds.items()
    }
    assert [*one] == ["kind", "cells", *kinds, "readings", "dropped"]
    assert log.records[2] == {"kind": "end", "passed": True}
    assert (log.records[3]["readings"], log.records[3]["cells"]) == ([[]], [[4]])


def test_record_with_formulas_has_step_times_and_changes() -> None:
    log = written(
        ("steps", cut(1.0), [], 0, ([0.5], [[0.25, "tilt", 1.0]])),
        ("steps", cut(2.0), [], 0, ([1.5], [[1.25, "tilt", 2.0]])),
        ("mission", 2.0),
        ("steps", cut(3.0), [], 0, ([0.125], [])),
    )
    first, _, second = log.records
    assert (first["times"], first["changes"]) == ([0.5, 1.5], [[0.25, "tilt", 1.0], [1.25, "tilt", 2.0]])
    assert (second["times"], second["changes"]) == ([0.125], [])


def test_steps_are_written_before_their_record_becomes_too_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(writing, "MOST_HELD", 4)
    steps = ("steps", cut(1.0, entries=[1, 0.5]), [], 0, None)
    log = written(*[steps] * 5)
    assert [len(unpacked(one["reward"], "float64")) for one in log.records] == [3, 2]


def test_cells_outside_missions_are_known_to_later_steps() -> None:
    log = written(("cells", [[7]]), ("steps", cut(1.0, cells=[[8]]), [], 0, None))
    assert log.records[0]["cells"] == [[7], [8]]


@pytest.mark.parametrize(
    ("size", "limit", "rotated"), [(10, 0, False), (9, 10, False), (10, 10, True), (11, 10, True)]
)
def test_large_log_is_rotated_before_a_mission(size: int, limit: int, rotated: bool) -> None:
    log = written(("mission", 4.0), log=Log(size), rotation=Rotation(limit, 3))
    begun = [("aside", 3), "start", "sync"] if rotated else []
    assert log.log == [*begun, "mission", "close"]
    assert log.records[-1] == {"kind": "mission", "time": 4.0}


def test_syncing_writes_pending_steps_first() -> None:
    log: Any = Log()
    one = Writer(log, {}, Rotation())
    one.take(("steps", cut(1.0), [], 0, None))
    one.sync()
    one.sync()
    assert log.log == ["steps", "sync", "sync"]


@pytest.mark.parametrize("kind", ["int32", "float64"])
@pytest.mark.parametrize("order", ["<", ">"])
def test_columns_are_stored_as_little_endian_bytes(kind: str, order: str) -> None:
    column = np.array([1, 256, -3], np.dtype(kind).newbyteorder(order))
    text = packed(column)
    assert base64.b64decode(text) == np.array([1, 256, -3], np.dtype(kind).newbyteorder("<")).tobytes()
    found = unpacked(text, kind)
    assert (found.tolist(), found.dtype, found.flags.writeable) == ([1, 256, -3], np.dtype(kind), True)


@pytest.fixture
def program(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> Iterator[Callable[..., tuple[int, str, list[Any]]]]:
    """Return a function that runs the writer's program, and returns its status, output and calls."""
    calls: list[Any] = []
    memory: list[int] = []

    def run(before: Callable[[Ring], None] = lambda end: None, log: Path | None = None) -> Any:
        monkeypatch.setattr(ring, "SIZE", 400)
        memory.append(shared_memory())
        before(Ring(memory[-1], writes=True))
        order = {"log": str(log or tmp_path / "log"), "about": {"node": "n"}, "rotation": [0, 0]}
        monkeypatch.setattr(sys, "argv", ["writer_main", json.dumps({**order, "ring": memory[-1]})])
        monkeypatch.setattr(signal, "signal", lambda *given: calls.append(given))
        monkeypatch.setattr(os, "sched_setscheduler", lambda *given: calls.append(("scheduler", *given)))
        monkeypatch.setattr(os, "nice", lambda by: calls.append(("nice", by)))
        monkeypatch.setattr(sys, "stdin", SimpleNamespace(fileno=lambda: 99))
        # the pipe is closed from the third look on
        looks = iter([[], [], *[[99]] * 9])
        monkeypatch.setattr(
            writer_main.select, "select", lambda *given: calls.append(("select", *given)) or [next(looks)]
        )
        status = writer_main.main()
        return status, capsys.readouterr().out, calls

    yield run
    for one in memory:
        os.close(one)


def send(end: Ring, *messages: Any) -> None:
    for one in messages:
        text = b"" if one == "END" else marshal.dumps(one, 2)
        assert end.write(LENGTH.pack(len(text)) + text)


def test_writer_leaves_signals_to_the_node(program: Any, tmp_path: Path) -> None:
    status, said, calls = program(lambda end: send(end, ("start", 5.0), ("mission", 6.0)))
    assert (status, said) == (0, "ready\n")
    ignored = [(one, signal.SIG_IGN) for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)]
    assert calls[:3] == ignored
    kind, process, policy, parameters = calls[3]
    assert (kind, process, policy, parameters.sched_priority) == ("scheduler", 0, os.SCHED_OTHER, 0)
    assert calls[4] == ("nice", 5)
    assert [one[0] for one in calls[5:]] == ["select"] * 3  # until the pipe is closed
    assert calls[5] == ("select", [99], [], [], 0.02)
    assert [one["kind"] for one in records(tmp_path / "log")] == ["start", "mission"]


def test_the_writer_runs_where_priorities_cannot_be_changed(
    program: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_: Any) -> None:
        raise PermissionError

    original = monkeypatch.setattr
    monkeypatch.setattr = lambda target, name, value: original(  # type: ignore[method-assign]
        target, name, refused if name in ("sched_setscheduler", "nice") else value
    )
    assert program()[0] == 0


def test_the_writer_ends_with_the_end_mark(program: Any, tmp_path: Path) -> None:
    status, _, calls = program(lambda end: send(end, ("start", 5.0), "END"))
    assert status == 0
    assert len([one for one in calls if one[0] == "select"]) == 1
    assert len([*records(tmp_path / "log")]) == 1


def test_bytes_that_were_damaged_in_memory_are_reported(program: Any, tmp_path: Path) -> None:
    def damaged(end: Ring) -> None:
        send(end, ("start", 5.0))
        at = 16 + end._counters[0]
        send(end, ("mission", 5.0))
        end._memory[at + 10] ^= 0xFF

    status, said, _ = program(damaged)
    length = LENGTH.size + len(marshal.dumps(("mission", 5.0), 2)) + 8
    lost = f"the last {length} bytes of records were damaged in memory and are lost."
    assert (status, said) == (1, f"ready\n{tmp_path / 'log'}: {lost}\n")


def test_writer_is_ready_before_the_node_knows(program: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    class Pipe(io.StringIO):
        def flush(self) -> None:
            told.append(self.getvalue())

    told: list[str] = []
    monkeypatch.setattr(sys, "stdout", Pipe())
    monkeypatch.setattr(writer_main, "_serve", lambda writer, _: told.append("serves") or writer.close())
    assert program()[0] == 0
    assert told[:2] == ["ready\n", "serves"]


def test_a_log_that_cannot_be_opened_is_reported(program: Any, tmp_path: Path) -> None:
    (tmp_path / "other").write_bytes(b"PK")
    status, said, _ = program(log=tmp_path / "other")
    assert status == 1
    assert "is not a log" in said
    assert "ready" not in said


def test_a_full_disk_is_reported(program: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def full(log: LogFile) -> None:
        log._file.close()
        raise OSError(28, "No space left on device")

    def start(end: Ring) -> None:
        send(end, ("start", 5.0))
        LogFile(tmp_path / "log").close()
        monkeypatch.setattr(LogFile, "sync", full)

    status, said, _ = program(start)
    assert status == 1
    assert "can no longer be written (No space left on device): later records are lost" in said


def test_the_writer_syncs_after_each_period(monkeypatch: pytest.MonkeyPatch) -> None:
    now = Clock(50.0)
    monkeypatch.setattr(writer_main, "monotonic", now)
    log: Any = Log()
    one = Writer(log, {}, Rotation())
    assert writer_main._synced(one, 50.5) == 50.5
    assert log.log == []
    assert writer_main._synced(one, 50.0) == 50.0 + PERIOD
    assert log.log == ["sync"]


def test_messages_are_taken_when_they_are_complete() -> None:
    log: Any = Log()
    one = Writer(log, {}, Rotation())
    texts = [marshal.dumps(("mission", float(number)), 2) for number in range(3)]
    whole = b"".join(LENGTH.pack(len(text)) + text for text in texts)
    waiting = bytearray()
    for byte in whole[:-1]:
        waiting.append(byte)
        assert not writer_main._take(one, waiting)
    assert [each["time"] for each in log.records] == [0.0, 1.0]
    assert len(waiting) == LENGTH.size + len(texts[2]) - 1
    waiting += whole[-1:] + LENGTH.pack(0)
    assert writer_main._take(one, waiting)
    assert len(log.records) == 3


def test_a_log_is_rotated_with_the_next_number(tmp_path: Path) -> None:
    path = tmp_path / "a[1].log"
    for name in ("a[1].log.2", "a[1].log.10", "a[1].log.old", "a[1].log.3x", "a1.log.99"):
        (tmp_path / name).write_text("")
    assert [one.name for one in set_aside(path)] == ["a[1].log.2", "a[1].log.10"]
    log = LogFile(path)
    log.append({"n": 1})
    log.set_aside()
    assert [one.name for one in set_aside(path)][-1] == "a[1].log.11"
    assert [*records(tmp_path / "a[1].log.11")] == [{"n": 1}]
    assert log.size == len(MAGIC)
    log.append({"n": 2})
    assert log.size == len(MAGIC) + len(encoded({"n": 2}))
    log.close()
    assert [*records(path)] == [{"n": 2}]


@pytest.mark.parametrize(
    ("keep", "left"), [(0, [1, 2, 3, 4]), (1, [4]), (2, [3, 4]), (4, [1, 2, 3, 4]), (9, [1, 2, 3, 4])]
)
def test_the_oldest_rotated_logs_are_removed(tmp_path: Path, keep: int, left: list[int]) -> None:
    path = tmp_path / "log"
    for number in (1, 2, 3):
        (tmp_path / f"log.{number}").write_text("")
    log = LogFile(path)
    log.set_aside(keep)
    log.close()
    assert [int(one.suffix[1:]) for one in set_aside(path)] == left


def test_log_in_an_impossible_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(LogError, match=r"cannot be written \(.*\): name another file"):
        LogFile(tmp_path / "file" / "log")
    log = LogFile(tmp_path / "new" / "folder" / "log")
    log.close()
    assert (tmp_path / "new" / "folder" / "log").read_bytes() == MAGIC
    with pytest.raises(LogError, match=r"cannot be read \(No such file"):
        next(records(tmp_path / "none"))


def test_each_sync_reaches_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[bytes] = []
    path = tmp_path / "log"
    monkeypatch.setattr(os, "fsync", lambda _: synced.append(path.read_bytes()))
    log = LogFile(path)
    log.append({"n": 1})
    log.sync()
    log.append({"n": 2})
    log.close()
    ends = [MAGIC, MAGIC + encoded({"n": 1}), MAGIC + encoded({"n": 1}) + encoded({"n": 2})]
    assert synced == ends
