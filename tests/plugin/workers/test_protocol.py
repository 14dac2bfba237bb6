"""Plans and results of episodes arrive in another process as they were sent."""

from __future__ import annotations

import io
from dataclasses import MISSING, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pytest_tarl.errors import RecordingError, TarlError
from pytest_tarl.formulas.judging import Judged
from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.rollout import EpisodePlan, EpisodeRun
from pytest_tarl.workers import protocol

PLAN = EpisodePlan(
    seed=2**70,
    drift="clogged",
    overlay={Path("/a/node.py"): "x = 'é'\n"},
    record=True,
    bag=Path("/bags/one"),
    point={"friction": 0.25},
    outputs=True,
    signed=True,
)


def trace(*, threads: bool = False) -> Trace:
    recorder = Recorder(threads=threads)
    recorder.latch((1, -1))
    recorder.hook(3, 0.5)
    recorder.reward(-1.5, {"time": -1.0, "effort": -0.5})
    found = recorder.finish()
    return replace(found, thread=np.zeros(1, np.int32)) if threads else found


RUN = EpisodeRun(
    plan=PLAN,
    trace=trace(),
    passed=True,
    failure="fell",
    broken="a traceback",
    topics={"/odom": "nav_msgs/Odometry"},
    crashed=True,
    stuck=True,
    notes=("slow", "late"),
    lost=("it ended with status 3",),
    values={"x": [1.0, 2.5]},
    judged=(Judged("level < 1", 0.5, 1.5), Judged("x > 0", -1.0, 2.0)),
    older=(Path("/a/node.py"), Path("gains.py")),
    simulator=True,
    outputs={"/cmd": [2.0, 5.0]},
    parameters={"/keeper/gain": 2.0, "/keeper/reverse": True},
    silent="Sensor 'level' received no message on /lvl.",
)


def differs_from_default(value: Any) -> list[str]:
    """Return the fields with a default that the value does not change: a message that drops them would pass."""
    defaults = {
        one.name: one.default if one.default_factory is MISSING else one.default_factory()
        for one in fields(value)
    }
    return [name for name, default in defaults.items() if getattr(value, name) == default]


def test_the_examples_of_these_tests_set_every_field() -> None:
    assert differs_from_default(PLAN) == differs_from_default(RUN) == []


@pytest.mark.parametrize(
    "plan", [PLAN, EpisodePlan(0), EpisodePlan(1, point={})], ids=["all", "none", "point"]
)
def test_a_plan_survives_transport_to_a_worker(plan: EpisodePlan) -> None:
    assert protocol.planned(protocol.plan_message(plan)) == plan


@pytest.mark.parametrize("threads", [False, True])
def test_episode_result_survives_transport(threads: bool) -> None:
    run = replace(RUN, trace=trace(threads=threads))
    found = protocol.answered(PLAN, protocol.run_message(run))
    for one in fields(EpisodeRun):
        if one.name != "trace":
            assert getattr(found, one.name) == getattr(run, one.name), one.name
    for one in fields(Trace):
        wanted, got = getattr(run.trace, one.name), getattr(found.trace, one.name)
        if one.name == "parts":
            assert {name: column.tolist() for name, column in got.items()} == {
                "time": [-1.0],
                "effort": [-0.5],
            }
        else:
            np.testing.assert_array_equal(got, wanted)


@pytest.mark.parametrize(
    "error",
    [RecordingError("no"), protocol.SkippedError("rain"), protocol.EndedError("enough"), TarlError("x")],
)
def test_worker_error_keeps_class_and_text(error: TarlError) -> None:
    message = protocol.error_message(error)
    for read in (protocol.refused, lambda one: protocol.answered(PLAN, one)):
        with pytest.raises(type(error)) as raised:
            read(message)
        assert (type(raised.value), str(raised.value)) == (type(error), str(error))


def test_an_error_of_unknown_class_becomes_a_general_error() -> None:
    class OtherError(TarlError):
        pass

    with pytest.raises(TarlError, match="odd") as raised:
        protocol.refused(protocol.error_message(OtherError("odd")))
    assert type(raised.value) is TarlError


@pytest.mark.parametrize("message", [b"", b"x", b"ab" * 1000])
def test_messages_are_read_whole_or_not_at_all(message: bytes) -> None:
    pipe = io.BytesIO()
    protocol.write(pipe, message)
    whole = pipe.getvalue()
    assert protocol.read(io.BytesIO(whole + b"next")) == message
    for cut in {0, 1, 7, len(whole) - 1} - {len(whole)}:
        assert protocol.read(io.BytesIO(whole[:cut])) is None
