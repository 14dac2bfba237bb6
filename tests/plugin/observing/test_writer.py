"""The writer process: sent records reach the log whichever process ends first, and the node never waits."""

from __future__ import annotations

import fcntl
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable
from itertools import chain
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import pytest

from pytest_tarl import Sensor
from pytest_tarl.errors import LogError
from pytest_tarl.observing import outlet, stream
from pytest_tarl.observing.log_format import MAGIC, LogFile, records, set_aside
from pytest_tarl.observing.observer import Observer
from pytest_tarl.observing.writer import Rotation, Writer, unpacked

SENSOR = Sensor("x", topic="/x", field="x", low=0, high=10, bins=5)
ABOUT = {"node": "node.py", "sites": [], "sensors": ["x"]}


class Message:
    def __init__(self, x: float) -> None:
        self.x = x


def until(true: Callable[[], object]) -> None:
    end = monotonic() + 20
    while not true() and monotonic() < end:
        sleep(0.01)
    assert true()


def mission(observer: Observer, steps: int) -> None:
    observer.begin()
    for number in range(steps):
        observer.told(SENSOR, Message(number % 10))
        observer.stream.hook(0, float(number))
        observer.step(float(number))


def rewards(path: Path) -> list[float]:
    found: list[float] = []
    for one in (*set_aside(path), path):
        for record in records(one):
            if record["kind"] == "steps":
                found += unpacked(record["reward"], "float64").tolist()
    return found


def column(steps: list[dict[str, Any]], name: str, kind: str) -> list[Any]:
    return [*chain.from_iterable(unpacked(one[name], kind).tolist() for one in steps)]


def test_steps_events_and_cells_are_written_in_order(tmp_path: Path) -> None:
    observer = Observer([SENSOR], tmp_path / "log", ABOUT)
    observer.told(SENSOR, Message(9.0))  # the cell that was current when the mission began
    until(lambda: not observer.stream._cells or observer.stream._told)
    mission(observer, 5000)
    observer.end(passed=False, failure="it fell")
    observer.close()
    assert observer.problem == ""
    start, begun, *steps, end = records(tmp_path / "log")
    assert (start["kind"], start["node"], begun["kind"]) == ("start", "node.py", "mission")
    assert (end["kind"], end["passed"], end["failure"]) == ("end", False, "it fell")
    assert column(steps, "reward", "float64") == [float(number) for number in range(5000)]
    assert [*chain.from_iterable(one["readings"] for one in steps)] == [
        [number % 10] for number in range(5000)
    ]
    assert [tuple(cell) for cell in steps[-1]["cells"]] == [(4,), (0,), (1,), (2,), (3,)]
    cells = column(steps, "step_cell", "int32")
    assert [steps[-1]["cells"][cell][0] for cell in cells] == [number % 10 // 2 for number in range(5000)]
    assert column(steps, "flow", "float64") == [float(number) for number in range(5000)]
    assert len(steps) < 5000 / 20  # fewer records than cuts


NODE = """
import os, sys, time
from pathlib import Path
from pytest_tarl import Sensor
from pytest_tarl.observing.observer import Observer
observer = Observer([], Path(sys.argv[1]), {"node": "n", "sites": [], "sensors": []})
observer.begin()
for number in range(10**6):
    observer.step(float(number))
    if number % 10 == 0:
        time.sleep(0.001)
    if number % 200 == 0 and not observer._outlet._waiting:
        print(number, flush=True)
"""


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_records_sent_before_the_node_is_killed_are_written(tmp_path: Path, how: signal.Signals) -> None:
    path = tmp_path / "log"
    command = [sys.executable, "-c", NODE, str(path)]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, start_new_session=True
    ) as node:
        assert node.stdout is not None
        for _ in range(6):
            last = int(node.stdout.readline())
        os.killpg(node.pid, signal.SIGINT)  # Ctrl-C also sends the signal to the writer
        if how is signal.SIGKILL:
            node.send_signal(how)
        node.wait()

    def free() -> bool:
        with path.open("rb") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                return False
            return True

    until(free)
    found = rewards(path)
    assert found == [float(number) for number in range(len(found))]
    assert len(found) > last - 200


def test_killed_writer_is_reported_and_the_node_continues(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    observer = Observer([SENSOR], tmp_path / "log", ABOUT)
    mission(observer, 10)
    observer._outlet._process.kill()
    observer._outlet._process.wait()
    mission(observer, 100)
    until(lambda: observer._outlet.problem)
    mission(observer, 100)
    observer.close()
    assert observer.problem == outlet.ENDED
    assert capsys.readouterr().err == f"observe: {outlet.ENDED}\n"


def test_writer_killed_near_the_end_is_reported(tmp_path: Path) -> None:
    observer = Observer([SENSOR], tmp_path / "log", ABOUT)
    mission(observer, 10)
    observer._thread.join(0.05)
    observer._outlet._process.kill()
    observer.told(SENSOR, Message("far"))  # type: ignore[arg-type]
    observer.close()
    sensor, _, writer = observer.problem.partition("; ")
    assert sensor.startswith("Sensor 'x'")
    assert writer == outlet.ENDED


def test_damaged_records_are_reported_and_others_written(tmp_path: Path) -> None:
    observer = Observer([SENSOR], tmp_path / "log", ABOUT)
    mission(observer, 1)
    until(lambda: not observer._outlet.unsent and not observer.stream._rewards)
    with observer._lock:
        observer._outlet._process.send_signal(signal.SIGSTOP)
        start, memory = observer._outlet._ring._counters[0], observer._outlet._ring._memory
        observer.step(1.0)
        observer._flush()
        memory[16 + start + 20] ^= 0xFF
        observer._outlet._process.send_signal(signal.SIGCONT)
    observer.end(passed=True)
    observer.close()
    assert re.search(
        r"log: the last \d+ bytes of records were damaged in memory and are lost", observer.problem
    )
    assert rewards(tmp_path / "log") == [0.0]


def test_messages_larger_than_the_shared_memory_arrive_whole(tmp_path: Path) -> None:
    observer = Observer([], tmp_path / "log", ABOUT)
    observer.begin()
    with observer._lock:  # one cut of 4 MB
        for number in range(200_000):
            observer.stream.hook(0, float(number))
        observer.step(1.0)
        observer._flush()
        assert observer._outlet.unsent > outlet.SIZE
        observer.step(2.0)
    observer.end(passed=True)
    observer.close()
    assert not observer.problem
    steps = [one for one in records(tmp_path / "log") if one["kind"] == "steps"]
    assert column(steps, "flow", "float64") == [*map(float, range(200_000))]
    assert rewards(tmp_path / "log") == [1.0, 2.0]


def test_a_forked_child_of_the_node_writes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "log"
    program = FORKING.replace("PATH", repr(str(path)))
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "''\n"
    assert rewards(path) == [1.0, 2.0]
    assert [one["kind"] for one in records(path)].count("end") == 1


FORKING = """
import os
from pathlib import Path
from pytest_tarl.observing.observer import Observer
observer = Observer([], Path(PATH), {"node": "n", "sites": [], "sensors": []})
observer.begin()
observer.step(1.0)
child = os.fork()
if not child:
    observer.step(100.0)
    observer.end(passed=False)
    observer._outlet.pump()
    observer._outlet.close()
    os._exit(0)
os.waitpid(child, 0)
observer.step(2.0)
observer.end(passed=True)
observer.close()
print(repr(observer.problem))
"""


def test_blocked_disk_loses_events_without_delay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outlet, "MOST_WAITING", 1000)
    monkeypatch.setattr(stream, "MOST_ENTRIES", 2000)
    observer = Observer([SENSOR], tmp_path / "log", ABOUT)
    process = observer._outlet._process
    process.send_signal(signal.SIGSTOP)
    begun = monotonic()
    rounds = 0
    while not observer.stream.dropped and monotonic() - begun < 20:
        mission(observer, 3000)
        rounds += 1
        sleep(0.01)
    held = sum(len(buffer.entries) for buffer in observer.stream._buffers)
    process.send_signal(signal.SIGCONT)
    observer.close()
    assert observer.stream.dropped
    assert held < 10_000
    assert [record["kind"] for record in records(tmp_path / "log")].count("mission") == rounds


@pytest.mark.parametrize("content", [b"PK\x03\x04 a fixture", b"tarl log 2\n"])
def test_an_unusable_log_is_refused_before_the_node_starts(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "log").write_bytes(content)
    with pytest.raises(LogError, match="is not a log of"):
        Observer([SENSOR], tmp_path / "log", ABOUT)
    assert (tmp_path / "log").read_bytes() == content
    observer = Observer([SENSOR], tmp_path / "other", ABOUT)
    with pytest.raises(LogError, match="being written by another observer"):
        Observer([SENSOR], tmp_path / "other", ABOUT)
    observer.close()


def long_log(path: Path, missions: int, rotation: Rotation) -> None:
    writer = Writer(LogFile(path), {**ABOUT, "format": 1}, rotation)
    writer.take(("start", 0.0))
    for number in range(missions):
        writer.take(("mission", float(number)))
        cut: tuple[Any, ...] = ([(number,)], [number], [0], [float(number)], [([], [0])])
        writer.take(("steps", cut, [number], 0, None))
        writer.take(("end", {"passed": True, "failure": "", "time": float(number)}))
    writer.close()


def test_long_log_is_split_between_missions(tmp_path: Path) -> None:
    path = tmp_path / "missions.log"
    (tmp_path / "missions.log.gz").write_text("not ours")
    long_log(path, 40, Rotation(size=2000))
    parts = [*set_aside(path), path]
    assert [part.name for part in parts[:2]] == ["missions.log.1", "missions.log.2"]
    assert 3 < len(parts) < 30
    for part in parts:
        kinds = [record["kind"] for record in records(part)]
        assert kinds == ["start", *["mission", "steps", "end"] * (len(kinds) // 3)]
        assert next(records(part))["node"] == "node.py"
    assert all(2000 <= part.stat().st_size < 3500 for part in parts[:-1])
    assert rewards(path) == [float(number) for number in range(40)]
    last = list(records(path))[-2]
    assert last["cells"][unpacked(last["step_cell"], "int32")[0]] == [39]


def test_only_the_newest_renamed_logs_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "missions.log"
    long_log(path, 40, Rotation(size=2000, keep=2))
    kept = set_aside(path)
    assert len(kept) == 2
    found = rewards(path)
    assert found == [float(number) for number in range(40 - len(found), 40)]
    assert int(kept[0].suffix[1:]) > 1
    assert path.read_bytes().startswith(MAGIC)
