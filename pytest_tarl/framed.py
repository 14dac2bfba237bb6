"""Records in a file that only grows: each with its length and a checksum, so that an incomplete one is recognised.

A record is `length, crc32` (two little-endian 32-bit numbers) and that many bytes.
"""

from __future__ import annotations

import struct
import zlib
from typing import BinaryIO

_HEAD = struct.Struct("<II")
HEAD = _HEAD.size  # bytes before a record's payload
unpack_head = _HEAD.unpack_from  # length and checksum of the payload, from a buffer and an offset


def framed(payload: bytes) -> bytes:
    """Return the bytes of a record in the file."""
    return _HEAD.pack(len(payload), zlib.crc32(payload)) + payload


def next_payload(file: BinaryIO, largest: int) -> bytes | None:
    """Return the payload of the record at the file's position, None if it is incomplete or over `largest` bytes."""
    head = file.read(HEAD)
    if len(head) < HEAD:
        return None
    length, checksum = _HEAD.unpack(head)
    if length > largest:
        return None
    payload = file.read(length)
    return payload if len(payload) == length and zlib.crc32(payload) == checksum else None
