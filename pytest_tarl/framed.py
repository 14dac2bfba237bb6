"""Records of an append-only file; length and checksum let readers recognise incomplete records.

A record is `length, crc32` (two little-endian 32-bit numbers), followed by that many bytes.
"""

from __future__ import annotations

import struct
import zlib
from typing import BinaryIO

_HEAD = struct.Struct("<II")
HEAD = _HEAD.size  # bytes before a record's payload
unpack_head = _HEAD.unpack_from  # (buffer, offset) → length and checksum of the payload


def framed(payload: bytes) -> bytes:
    """Return a payload as a record: header and payload."""
    return _HEAD.pack(len(payload), zlib.crc32(payload)) + payload


def next_payload(file: BinaryIO, largest: int) -> bytes | None:
    """Read a record's payload; return None if it is incomplete, damaged or longer than `largest` bytes."""
    head = file.read(HEAD)
    if len(head) < HEAD:
        return None
    length, checksum = _HEAD.unpack(head)
    if length > largest:
        return None
    payload = file.read(length)
    return payload if len(payload) == length and zlib.crc32(payload) == checksum else None
