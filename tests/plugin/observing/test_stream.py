"""Draining a recorder while it records loses no event and keeps the order of events."""

from __future__ import annotations

import marshal
import threading

import numpy as np

from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.observing import stream
from pytest_tarl.observing.stream import Chunk, Cut, Stream, chunk, merged
from pytest_tarl.sensors import Cell


class Emptied(Stream):
    """A stream whose chunks the test receives."""

    def __init__(self) -> None:
        super().__init__()
        self.known: list[Cell] = []

    def drain(self) -> Chunk:
        return chunk(Cut(*marshal.loads(marshal.dumps(tuple(self.cut()), 2))), self.known)


def drive(recorder: Recorder, begin: int, end: int) -> None:
    for number in range(begin, end):
        recorder.hook(number % 5, float(number))
        if number % 3 == 0:
            recorder.latch((number % 4,))
        if number % 2 == 0:
            recorder.reward(number / 10)


def test_draining_in_pieces_records_the_same_as_draining_once() -> None:
    whole = Recorder(threads=True)
    drive(whole, 0, 60)
    trace = whole.finish()
    pieces = Emptied()
    chunks, done = [], 0
    for end in (1, 2, 17, 30, 31, 59, 60):
        drive(pieces, done, end)
        chunks.append(pieces.drain())
        done = end
    steps = np.cumsum([0, *(chunk.reward.size for chunk in chunks[:-1])])
    assert chunks[-1].cells == trace.cells
    for name, column in (("site", trace.site), ("flow", trace.flow), ("cell", trace.event_cell)):
        np.testing.assert_array_equal(np.concatenate([getattr(chunk, name) for chunk in chunks]), column)
    joined = np.concatenate([chunk.step + before for chunk, before in zip(chunks, steps, strict=True)])
    np.testing.assert_array_equal(np.minimum(joined, trace.steps - 1), trace.event_step)
    np.testing.assert_array_equal(np.concatenate([chunk.step_cell for chunk in chunks]), trace.step_cell)
    np.testing.assert_array_equal(np.concatenate([chunk.reward for chunk in chunks]), trace.reward)


def test_cutting_a_buffer_does_not_change_the_result() -> None:
    whole, pieces = Emptied(), Emptied()
    cuts, done = [], 0
    for end in (1, 2, 17, 30, 31, 59, 60):
        drive(pieces, done, end)
        if end > 20:  # a second thread begins later
            thread = threading.Thread(target=drive, args=(pieces, done, end))
            thread.start()
            thread.join()
        cuts.append(pieces.cut())
        done = end
    done = 0
    for end in (1, 2, 17, 30, 31, 59, 60):
        drive(whole, done, end)
        if end > 20:
            thread = threading.Thread(target=drive, args=(whole, done, end))
            thread.start()
            thread.join()
        done = end
    for first in (0, 3):  # the first cut of a record may continue an earlier one
        parts = [chunk(cut, []) for cut in cuts[first:]]
        one = chunk(merged(cuts[first:]), [])
        for name in ("site", "flow", "cell", "step_cell", "reward"):
            found = sorted(getattr(one, name).tolist())
            assert found == sorted(np.concatenate([getattr(part, name) for part in parts]).tolist())
    one, other = chunk(merged(cuts), []), whole.drain()
    assert one.cells == other.cells
    order, others = (np.lexsort((each.flow, each.site, each.step)) for each in (one, other))
    for name in ("site", "flow", "cell", "step"):
        np.testing.assert_array_equal(getattr(one, name)[order], getattr(other, name)[others])
    for name in ("step_cell", "reward"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_event_is_complete_with_its_flow_value() -> None:
    recorder = Emptied()
    entries = recorder._entries()
    entries.append(3)
    assert recorder.drain().empty
    entries += [0.5, 7, 2.5, 3]
    chunk = recorder.drain()
    assert (chunk.site.tolist(), chunk.flow.tolist()) == ([3, 7], [0.5, 2.5])
    entries.append(1.5)
    chunk = recorder.drain()
    assert (chunk.site.tolist(), chunk.flow.tolist()) == ([3], [1.5])


def test_draining_the_buffer_loses_no_concurrent_event() -> None:
    recorder = Emptied()
    count, over = 20_000, threading.Event()

    def work(site: int) -> None:
        for number in range(count):
            recorder.hook(site, float(number))

    threads = [threading.Thread(target=work, args=(site,)) for site in range(3)]
    for thread in threads:
        thread.start()
    chunks = []
    while any(thread.is_alive() for thread in threads):
        chunks.append(recorder.drain())
        over.wait(0.001)
    chunks.append(recorder.drain())
    site = np.concatenate([chunk.site for chunk in chunks])
    flow = np.concatenate([chunk.flow for chunk in chunks])
    for number in range(3):
        assert flow[site == number].tolist() == list(range(count))


def test_memory_is_bounded_while_the_disk_is_blocked(monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(stream, "MOST_ENTRIES", 100)
    recorder = Emptied()
    for _ in range(10):
        drive(recorder, 0, 60)
        recorder.relieve()
    assert sum(len(buffer.entries) for buffer in recorder._buffers) <= 220
    assert recorder.dropped > 0
    recorder.drain()
