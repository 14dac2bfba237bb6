"""Read the complete records of a log in blocks."""

from __future__ import annotations

import json
import re
import zlib
from collections.abc import Iterator
from typing import BinaryIO

from pytest_tarl.framed import HEAD, unpack_head
from pytest_tarl.observing.log_format import LARGEST, Record

BLOCK = 1 << 15  # bytes per read, about 200 records
_DECODED = json.JSONDecoder().raw_decode
_TEXTS = b"".join(rb'"%s":"[^"\n]*",' % name for name in (b"site", b"flow", b"cell", b"step", b"thread"))
# a mission in three consecutive records (mission, steps, end), the usual form of a short mission
_AT_ONCE = re.compile(
    rb'\{"kind":"mission","time":([0-9.e+-]+)\}\n'
    rb'\{"kind":"steps","cells":(\[[^"\n]*\]),'
    + _TEXTS
    + rb'"step_cell":"([^"\n]*)","reward":"([^"\n]*)",.*\}\n'
    rb'\{"kind":"end","passed":(true|false),.*\}\n'
)
RECORDS = 3  # number of records of a mission that matches `_AT_ONCE`


Spot = tuple[int, int, int]  # offset of a record in its log, with the length and checksum of its payload


# A mission in three consecutive records: its time and table of cells (both JSON), the cell and the reward of each step
# (both base64), whether it passed (JSON), and where its last record is in the log.
AtOnce = tuple[bytes, bytes, bytes, bytes, bytes, Spot]


class Block:
    """Consecutive records, read one by one or as missions of three records."""

    def __init__(self, texts: list[bytes], spots: list[Spot]) -> None:
        self._texts = texts
        self._spots = spots
        self._number = 0  # index of the next record
        joined = b"\n".join((*texts, b""))
        self._lines = (
            joined if joined.count(b"\n") == len(texts) else b""
        )  # all records as text, one per line; empty if a record itself has several lines
        self._at = 0

    def left(self) -> bool:
        """Return whether any record is left to read."""
        return self._number < len(self._texts)

    def at_once(self) -> Iterator[AtOnce]:
        """Yield missions of three records, until a different record follows."""
        match, lines = _AT_ONCE.match, self._lines
        while (found := match(lines, self._at)) is not None:
            self._at = found.end()
            self._number += RECORDS
            time, cells, cell, reward, passed = found.groups()
            yield time, cells, cell, reward, passed, self._spots[self._number - 1]

    def record(self) -> Record:
        """Return the next record. Raise ValueError if it is invalid."""
        text = self._texts[self._number]
        found: Record = _DECODED(text.decode())[0]
        self._number += 1
        self._at += len(text) + 1
        return found

    def spot(self) -> Spot:
        """Return the spot of the last record that was read."""
        return self._spots[self._number - 1]


def end_of(spot: Spot) -> int:
    """Return the offset of the following record."""
    begin, length, _ = spot
    return begin + HEAD + length


def next_block(file: BinaryIO, place: int, size: int = BLOCK) -> Block:
    """Return the complete records from `place` on; if the first is larger than a block, only this one."""
    file.seek(place)
    data = file.read(max(size, HEAD))
    texts: list[bytes] = []
    spots: list[Spot] = []
    at, most = 0, len(data) - HEAD
    while at <= most:
        length, checksum = unpack_head(data, at)
        begin = at + HEAD
        if length > most - at and not spots and length <= LARGEST:
            # the first record is larger than a block: read the rest of it
            data += file.read(begin + length - len(data))
        payload = data[begin : begin + length]
        if len(payload) < length or length > LARGEST or zlib.crc32(payload) != checksum:
            break
        try:
            texts.append(zlib.decompress(payload))
        except zlib.error:
            break
        spots.append((place + at, length, checksum))
        at = begin + length
    return Block(texts, spots)
