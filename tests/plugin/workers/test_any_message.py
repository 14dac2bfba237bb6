"""Any plan and any result of an episode arrive in another process as they were sent."""

from __future__ import annotations

import io
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl.formulas.judging import Judged
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.rollout import EpisodePlan, EpisodeRun
from pytest_tarl.workers import protocol

text = st.text(max_size=8)
number = st.floats(allow_nan=False, width=32)
paths = text.filter(lambda one: one not in ("", ".") and "\0" not in one).map(Path)
plans = st.builds(
    EpisodePlan,
    st.integers(0, 2**80),
    st.none() | text,
    st.dictionaries(paths, text, max_size=2),
    st.booleans(),
    st.none() | paths,
    st.none() | st.dictionaries(text, number, max_size=2),
    outputs=st.booleans(),
    signed=st.booleans(),
)


@st.composite
def traces(draw: st.DrawFn) -> Trace:
    events, steps = draw(st.integers(0, 4)), draw(st.integers(0, 3))

    def column(length: int, kind: str) -> np.ndarray[Any, Any]:
        return np.array(draw(st.lists(st.integers(0, 99), min_size=length, max_size=length)), kind)

    names = draw(st.lists(text, max_size=2, unique=True))
    return Trace(
        cells=tuple(draw(st.lists(st.tuples(st.integers(-1, 5), st.integers(-1, 5)), max_size=3))),
        site=column(events, "i4"),
        flow=column(events, "f8"),
        event_cell=column(events, "i4"),
        event_step=column(events, "i4"),
        step_cell=column(steps, "i4"),
        reward=column(steps, "f8"),
        parts={name: column(steps, "f8") for name in names},
        thread=column(events, "i4") if draw(st.booleans()) else None,
    )


runs = st.builds(
    EpisodeRun,
    plan=plans,
    trace=traces(),
    passed=st.booleans(),
    failure=text,
    broken=text,
    topics=st.dictionaries(text, text, max_size=2),
    crashed=st.booleans(),
    stuck=st.booleans(),
    notes=st.lists(text, max_size=2).map(tuple),
    values=st.dictionaries(text, st.lists(number, max_size=2), max_size=2),
    judged=st.lists(st.builds(Judged, text, number, number), max_size=2).map(tuple),
    older=st.lists(paths, max_size=2).map(tuple),
    simulator=st.booleans(),
    outputs=st.dictionaries(text, st.lists(number, min_size=1, max_size=2), max_size=2),
)


@settings(max_examples=25, deadline=None)
@given(plans)
def test_any_plan_arrives_as_it_was_sent(plan: EpisodePlan) -> None:
    assert protocol.planned(protocol.plan_message(plan)) == plan


@settings(max_examples=25, deadline=None)
@given(runs)
def test_any_result_arrives_as_it_was_sent(run: EpisodeRun) -> None:
    found = protocol.answered(run.plan, protocol.run_message(run))
    for one in fields(EpisodeRun):
        if one.name != "trace":
            assert getattr(found, one.name) == getattr(run, one.name), one.name
    for column in fields(Trace):
        wanted, got = getattr(run.trace, column.name), getattr(found.trace, column.name)
        if isinstance(wanted, np.ndarray):
            np.testing.assert_array_equal(got, wanted)
            assert (got.dtype, got.flags.writeable) == (wanted.dtype, True)
        elif column.name == "parts":
            assert {name: one.tolist() for name, one in got.items()} == {
                name: one.tolist() for name, one in wanted.items()
            }
        else:
            assert got == wanted


@settings(max_examples=25, deadline=None)
@given(st.lists(st.binary(max_size=20), max_size=4), st.data())
def test_broken_stream_ends_with_a_whole_message(messages: list[bytes], data: st.DataObject) -> None:
    pipe, ends = io.BytesIO(), []
    for message in messages:
        protocol.write(pipe, message)
        ends.append(pipe.tell())
    cut = data.draw(st.integers(0, pipe.tell()))
    short = io.BytesIO(pipe.getvalue()[:cut])
    found = [*iter(lambda: protocol.read(short), None)]
    assert found == messages[: sum(end <= cut for end in ends)]
