"""Records of an append-only file, whole and damaged."""

from __future__ import annotations

import io

import pytest

from pytest_tarl.framed import HEAD, framed, next_payload, unpack_head


def test_records_are_read_in_order() -> None:
    file = io.BytesIO(framed(b"one") + framed(b"") + framed(b"three"))
    assert [next_payload(file, 100) for _ in range(4)] == [b"one", b"", b"three", None]


def test_record_has_length_checksum_and_payload() -> None:
    assert framed(b"123456789") == bytes.fromhex("09000000 2639f4cb") + b"123456789"
    assert unpack_head(framed(b"123456789"), 0) == (9, 0xCBF43926)
    assert HEAD == 8


@pytest.mark.parametrize("at", range(len(framed(b"four"))))
def test_damaged_record_is_recognised(at: int) -> None:
    whole = framed(b"four")
    assert next_payload(io.BytesIO(whole[:at]), 100) is None
    assert next_payload(io.BytesIO(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :]), 100) is None


def test_a_record_may_have_the_largest_length() -> None:
    assert next_payload(io.BytesIO(framed(b"four")), 4) == b"four"
    assert next_payload(io.BytesIO(framed(b"four")), 3) is None
