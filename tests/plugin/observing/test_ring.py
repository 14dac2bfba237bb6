"""Bytes through shared memory arrive whole and in order, whatever their sizes and however far the reader is behind."""

from __future__ import annotations

import os

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.observing import ring
from pytest_tarl.observing.ring import Ring, shared_memory


def ends(size: int) -> tuple[Ring, Ring]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ring, "SIZE", size)
        memory = shared_memory()
    try:
        return Ring(memory, writes=True), Ring(memory)
    finally:
        os.close(memory)


@given(st.integers(9, 64), st.lists(st.integers(0, 60) | st.none(), max_size=40))
def test_pieces_are_refused_only_if_the_ring_is_full(size: int, steps: list[int | None]) -> None:
    writer, reader = ends(size)
    waiting: list[bytes] = []
    held = 0
    for number, length in enumerate(steps):
        if length is None:
            piece = reader.read()
            assert piece == (waiting.pop(0) if waiting else None)
            held -= 0 if piece is None else len(piece) + 8
        else:
            piece = bytes([number % 256]) * length
            fits = held + length + 8 <= size
            assert writer.write(piece) is fits
            if fits:
                waiting.append(piece)
                held += length + 8
        assert writer.unread == reader.unread == held
    assert [*iter(reader.read, None)] == waiting


@pytest.mark.parametrize("at", [0, 5, 9])
def test_incomplete_piece_is_read_later(at: int) -> None:
    writer, reader = ends(64)
    assert writer.write(b"first")
    place = 16 + at
    byte = reader._memory[place]
    writer._memory[place] = byte ^ 0xFF
    assert reader.read() is None
    writer._memory[place] = byte
    assert reader.read() == b"first"


def test_counter_without_a_header_is_not_a_piece() -> None:
    writer, reader = ends(64)
    writer._counters[0] = 7
    assert reader.read() is None
    writer._counters[0] = 8
    assert reader.read() == b""  # a header of zeros is valid: no bytes, with checksum 0
