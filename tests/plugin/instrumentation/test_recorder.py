from __future__ import annotations

import _thread
import ast
import math
import threading
from typing import Any

import greenlet
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.instrumentation import recorder as recording
from pytest_tarl.instrumentation.entries import Entries
from pytest_tarl.instrumentation.events import paired, sizes
from pytest_tarl.instrumentation.instrument import compiled, instrument
from pytest_tarl.instrumentation.magnitude import LIMIT, magnitude
from pytest_tarl.instrumentation.recorder import Recorder

SOURCE = """
def work(values):
    for value in values:
        doubled = value * 2
        if doubled > 2:
            note(doubled)
"""
SITES = {(3, 4): 0, (4, 8): 1, (5, 8): 2, (6, 12): 3}


def program(recorder: Recorder, **extra: Any) -> dict[str, Any]:
    space: dict[str, Any] = {"note": lambda value: value, **extra}
    exec(recorder.bind(compiled(instrument(ast.parse(SOURCE), SITES, inline=True), "<p>")), space)
    return space


@pytest.mark.parametrize("threads", [False, True])
def test_events_are_in_order_with_their_flow_values(threads):
    recorder = Recorder(threads=threads)
    program(recorder)["work"]([0.5, 2])
    recorder.reward(1.0)
    trace = recorder.finish()
    assert trace.site.tolist() == [0, 1, 2, 0, 1, 2, 3]
    assert trace.flow.tolist() == [0.5, 1.0, 0.0, 2.0, 4.0, 1.0, 4.0]
    assert trace.thread is None


def test_signs_are_kept_if_requested():
    recorder = Recorder()
    program(recorder)["work"]([-0.5, -2, math.nan])
    recorder.reward(1.0)
    # in each round: the value, its double, and whether the double is larger than 2; NaN is no measurement
    assert recorder.finish(signed=True).flow.tolist() == [-0.5, -1.0, 0.0, -2.0, -4.0, 0.0, 0.0, 0.0, 0.0]


def test_events_after_a_reward_belong_to_its_step():
    recorder = Recorder()
    for step in range(3):
        recorder.hook(0, float(step))
        recorder.hook(1, float(step))
        recorder.reward(10.0 * step, {"progress": step, "late": 1.0} if step == 1 else {"progress": step})
    recorder.hook(2, 9.0)
    trace = recorder.finish()
    assert trace.event_step.tolist() == [0, 0, 1, 1, 2, 2, 2]
    assert trace.reward.tolist() == [0.0, 10.0, 20.0]
    assert {name: part.tolist() for name, part in trace.parts.items()} == {
        "progress": [0.0, 1.0, 2.0],
        "late": [0.0, 1.0, 0.0],
    }


def test_a_cell_is_valid_until_the_next_cell_begins():
    recorder = Recorder()
    recorder.hook(0, 0.0)
    recorder.latch((4, 1))
    recorder.hook(1, 0.0)
    recorder.reward(0.0)
    recorder.hook(2, 0.0)
    recorder.latch((2, 0))
    recorder.latch((4, 1))
    recorder.hook(3, 0.0)
    recorder.reward(0.0)
    recorder.latch(None)
    recorder.hook(4, 0.0)
    recorder.reward(0.0)
    trace = recorder.finish()
    assert trace.cells == ((4, 1), (2, 0))
    assert trace.event_cell.tolist() == [-1, 0, 0, 0, -1]
    assert trace.step_cell.tolist() == [0, 0, -1]


def test_a_recorder_without_events_returns_an_empty_trace():
    trace = Recorder().finish()
    assert trace.cells == ()
    assert [len(column) for column in (trace.site, trace.flow, trace.event_cell, trace.event_step)] == [0] * 4
    assert (trace.steps, trace.parts) == (0, {})


def test_events_of_an_episode_without_rewards_are_kept():
    recorder = Recorder()
    recorder.hook(0, 1.0)
    assert recorder.finish().event_step.tolist() == [0]


VALUES = [
    1.5,
    -2.0,
    math.nan,
    -math.inf,
    1e300,
    7,
    -7,
    10**400,
    True,
    None,
    "text",
    [3.0, 4.0],
    np.float32(2),
    object(),
]


@pytest.mark.parametrize("value", VALUES, ids=lambda value: type(value).__name__)
@pytest.mark.parametrize("threads", [False, True])
def test_all_hooks_record_and_return_the_value(value, threads):
    recorder = Recorder(threads=threads)
    space: dict[str, Any] = {"value": value}
    source = "x = value\ny = [value][0]\nz = (lambda: value)()"
    tree = instrument(ast.parse(source), {(1, 0): 0, (2, 0): 1, (3, 13): 2}, inline=True)
    exec(recorder.bind(compiled(tree, "<p>")), space)
    assert space["x"] is space["z"] is value
    assert recorder.hook(3, value) is value
    trace = recorder.finish()
    assert trace.site.tolist() == [0, 1, 2, 3]
    assert trace.flow.tolist() == [magnitude(value)] * 4


def test_events_of_two_threads_are_separate():
    recorder = Recorder()
    started, go_on = threading.Event(), threading.Event()

    def pause(value):
        if threading.current_thread() is not threading.main_thread():
            started.set()
            go_on.wait(5)
        return value

    space = program(recorder, note=pause)
    space["work"]([1.0])
    other = threading.Thread(target=space["work"], args=([5.0, 6.0],))
    other.start()
    started.wait(5)
    space["work"]([2.0])
    go_on.set()
    other.join()
    recorder.reward(0.0)
    trace = recorder.finish()
    assert trace.thread is not None
    assert trace.flow[trace.thread == 0].tolist() == [1.0, 2.0, 0.0, 2.0, 4.0, 1.0, 4.0]
    assert trace.flow[trace.thread == 1].tolist() == [5.0, 10.0, 1.0, 10.0, 6.0, 12.0, 1.0, 12.0]
    assert np.all(np.diff(trace.thread) >= 0)


def test_thread_events_belong_to_their_step():
    recorder = Recorder()
    space = program(recorder)
    for step in range(2):
        space["work"]([1.0])
        thread = threading.Thread(target=space["work"], args=([float(step)],))
        recorder.latch((step,))
        thread.start()
        thread.join()
        recorder.reward(float(step))
    trace = recorder.finish()
    assert trace.event_step.tolist() == sorted(trace.event_step.tolist())
    assert trace.thread is not None
    of_threads = trace.thread > 0
    assert trace.event_step[of_threads].tolist() == [0, 0, 0, 1, 1, 1]
    assert trace.event_cell[of_threads].tolist() == [0, 0, 0, 1, 1, 1]
    assert trace.event_cell[~of_threads].tolist() == [-1, -1, -1, 0, 0, 0]


def test_greenlets_of_a_thread_record_into_one_sequence():
    recorder = Recorder()
    main = greenlet.getcurrent()
    space = program(recorder, note=lambda value: main.switch())
    node = greenlet.greenlet(space["work"])
    node.switch([3.0])
    recorder.reward(1.0)
    node.switch()
    space["work"]([0.0])
    trace = recorder.finish()
    assert trace.site.tolist() == [0, 1, 2, 3, 0, 1, 2]
    assert trace.thread is None


def test_thread_profilers_stay_installed():
    def profile(*_: object) -> None: ...

    threading.setprofile(profile)
    try:
        recorder = Recorder()
        program(recorder)
        assert threading.getprofile() is profile
        recorder.finish()
        assert threading.getprofile() is profile
    finally:
        threading.setprofile(None)  # type: ignore[arg-type]


def test_threading_is_restored_after_an_episode():
    names = [name for name in ("_start_new_thread", "_start_joinable_thread") if hasattr(threading, name)]
    before = [getattr(threading, name) for name in names]
    recorder = Recorder()
    program(recorder)
    assert all(getattr(threading, name) is not one for name, one in zip(names, before, strict=True))
    recorder.finish()
    assert [getattr(threading, name) for name in names] == before


def test_events_of_module_threads_are_separate():
    before = _thread.start_new_thread
    recorder, done = Recorder(), threading.Event()
    space = program(recorder)

    def job(values: list[float]) -> None:
        space["work"](values)
        done.set()

    space["work"]([3.0])
    _thread.start_new_thread(job, ([5.0],))
    assert done.wait(5)
    trace = recorder.finish()
    assert _thread.start_new_thread is before
    assert trace.thread is not None
    assert trace.flow[trace.thread == 0].tolist() == [3.0, 6.0, 1.0, 6.0]
    assert trace.flow[trace.thread == 1].tolist() == [5.0, 10.0, 1.0, 10.0]


@pytest.mark.parametrize("threads", [False, True])
def test_a_long_episode_is_packed_between_steps_without_loss(monkeypatch, threads):
    def recorded(most: int) -> tuple[list[Any], int]:
        monkeypatch.setattr(recording, "MANY", most)
        recorder = Recorder(threads=threads)
        space, longest = program(recorder), 0
        for step in range(30):
            recorder.latch((step % 3,))
            space["work"]([float(step), step % 5])
            recorder.reward(float(step))
            longest = max(longest, len(recorder._own.entries))
        recorder.hook(9, 1.0)
        trace = recorder.finish()
        columns = (trace.site, trace.flow, trace.event_cell, trace.event_step, trace.step_cell)
        return [column.tolist() for column in columns], longest

    whole, all_of_it = recorded(10**9)
    packed, most = recorded(40)
    assert packed == whole
    assert most <= 40 < all_of_it


def test_an_unbound_recorder_does_not_change_threading():
    before = threading.getprofile()
    recorder = Recorder()
    assert threading.getprofile() is before
    recorder.finish()


def test_an_incomplete_event_is_dropped_and_the_others_kept():
    site, flow, starts = paired([0, 1.0, 1, 2, 3.0, 3, 4.0, 4])
    assert site.tolist() == [0, 2, 3]
    assert flow.tolist() == [1.0, 3.0, 4.0]
    assert starts.tolist() == [0, 3, 5]


@given(st.lists(st.floats()))
def test_the_flow_value_of_a_float_is_its_magnitude(values):
    assert sizes(np.array(values, np.float64)).tolist() == [magnitude(value) for value in values]
    assert all(0.0 <= size <= LIMIT for size in sizes(np.array(values, np.float64)))


@given(
    st.lists(
        st.one_of(
            st.tuples(st.just("event"), st.floats(0, 9)),
            st.tuples(st.just("latch"), st.integers(0, 2)),
            st.tuples(st.just("reward"), st.floats(-5, 5)),
        )
    )
)
def test_columns_contain_the_recorded_events(story):
    recorder = Recorder()
    expected, rewards, cell, told = [], [], -1, []
    for what, value in story:
        if what == "event":
            recorder.hook(len(expected), value)
            expected.append((value, cell, len(rewards)))
        elif what == "latch":
            recorder.latch((value,))
            told += [(value,)] if (value,) not in told else []
            cell = told.index((value,))
        else:
            recorder.reward(value)
            rewards.append((value, cell))
    trace = recorder.finish()
    last = max(0, len(rewards) - 1)
    columns = zip(trace.flow.tolist(), trace.event_cell.tolist(), trace.event_step.tolist(), strict=True)
    assert list(columns) == [(value, cell, min(step, last)) for value, cell, step in expected]
    assert list(zip(trace.reward.tolist(), trace.step_cell.tolist(), strict=True)) == rewards
    assert trace.site.tolist() == list(range(len(expected)))


def running(job: threading.Thread) -> threading.Thread:
    job.daemon = True
    job.start()
    return job


@pytest.mark.parametrize(
    ("module", "direct"), [("pytest_tarl.ros.watchdog", True), ("pytest_timeout", True), ("node", False)]
)
def test_threads_of_test_tools_are_ignored(module, direct):
    go_on = threading.Event()

    def job() -> None:
        go_on.wait(5)

    job.__module__ = module
    threads = [running(threading.Thread(target=job)), running(threading.Timer(0.0, job))]
    recorder = Recorder()
    program(recorder)
    assert (type(recorder._own.entries) is Entries) is direct
    go_on.set()
    for thread in threads:
        thread.join()


def test_events_of_older_threads_are_separate():
    begin = threading.Event()
    spaces: list[dict[str, Any]] = []

    def serve() -> None:
        begin.wait(5)
        spaces[0]["work"]([5.0])

    def note(value: float) -> float:
        if threading.current_thread() is not thread:
            begin.set()
            thread.join()
        return value

    thread = running(threading.Thread(target=serve))
    recorder = Recorder()
    spaces.append(program(recorder, note=note))
    spaces[0]["work"]([3.0])
    trace = recorder.finish()
    assert trace.thread is not None
    assert trace.flow[trace.thread == 0].tolist() == [3.0, 6.0, 1.0, 6.0]
    assert trace.flow[trace.thread == 1].tolist() == [5.0, 10.0, 1.0, 10.0]
