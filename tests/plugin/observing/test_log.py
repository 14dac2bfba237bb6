"""The log: complete records are read, whatever happens to the rest."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import zlib
from pathlib import Path
from random import Random

import pytest

from pytest_tarl.errors import LogError
from pytest_tarl.observing.log_format import MAGIC, LogFile, encoded, framed, records

RECORDS = [{"kind": "steps", "number": number, "text": "ä" * number} for number in range(5)]


def written(path: Path, some: list[dict[str, object]]) -> bytes:
    log = LogFile(path)
    for record in some:
        log.append(record)
    log.close()
    return path.read_bytes()


def test_records_are_compressed_at_the_fastest_level_since_the_node_continues_meanwhile() -> None:
    record = encoded({"kind": "start", "n": 1})
    payload = record[len(framed(b"")) :]
    assert record == framed(payload)
    assert json.loads(zlib.decompress(payload)) == {"kind": "start", "n": 1}
    assert payload[1] == 1  # the byte in which zlib notes its level; 0x5e, 0x9c and 0xda are slower ones


def test_appended_records_are_read_in_order(tmp_path: Path) -> None:
    written(tmp_path / "log", RECORDS[:2])
    written(tmp_path / "log", RECORDS[2:])
    assert list(records(tmp_path / "log")) == RECORDS


def test_truncated_log_is_read_and_continued(tmp_path: Path) -> None:
    content = written(tmp_path / "log", RECORDS)
    ends = [len(MAGIC)]
    for record in RECORDS:
        ends.append(ends[-1] + len(encoded(record)))
    for length in range(len(content)):
        torn = tmp_path / "torn"
        torn.write_bytes(content[:length])
        whole = RECORDS[: sum(end <= length for end in ends[1:])]
        assert list(records(torn)) == whole
        written(torn, [{"kind": "start"}])
        assert list(records(torn)) == [*whole, {"kind": "start"}]


def test_reading_stops_at_a_damaged_record(tmp_path: Path) -> None:
    content = bytearray(written(tmp_path / "log", RECORDS))
    content[len(MAGIC) + len(encoded(RECORDS[0])) + 12] ^= 1
    (tmp_path / "log").write_bytes(content)
    assert list(records(tmp_path / "log")) == RECORDS[:1]


@pytest.mark.parametrize("content", [b"PK\x03\x04 a fixture", b"tarl log 2\n"])
def test_foreign_file_is_not_overwritten(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "other"
    path.write_bytes(content)
    with pytest.raises(LogError, match="is not a log"):
        list(records(path))
    with pytest.raises(LogError, match="is not a log"):
        LogFile(path)
    assert path.read_bytes() == content


def test_two_observers_cannot_share_a_log(tmp_path: Path) -> None:
    first = LogFile(tmp_path / "log")
    with pytest.raises(LogError, match="being written by another observer"):
        LogFile(tmp_path / "log")
    first.close()


WRITER = """
import sys
from pathlib import Path
from pytest_tarl.observing.log_format import LogFile
log = LogFile(Path(sys.argv[1]))
for number in range(1_000_000):
    log.append({"number": number, "text": "x" * (number % 3000)})
    if number % 7 == 0:
        log.sync()
        print(number, flush=True)
"""


@pytest.mark.parametrize("seed", range(4))
def test_synced_records_survive_a_kill(tmp_path: Path, seed: int) -> None:
    path = tmp_path / "log"
    process = subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    for _ in range(Random(seed).randrange(1, 60)):
        last = int(process.stdout.readline())
    process.send_signal(signal.SIGKILL)
    process.wait()
    process.stdout.close()
    numbers = [record["number"] for record in records(path)]
    assert numbers == list(range(len(numbers)))
    assert numbers[-1] >= last
