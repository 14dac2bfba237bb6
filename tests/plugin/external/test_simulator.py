"""The simulator of an episode: its start, its time and messages, its steps, and its errors."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.errors import SimulatorError, SimulatorLostError, UnsupportedApiError
from pytest_tarl.external import simulator as module
from pytest_tarl.external.arguments import Setup
from pytest_tarl.external.simulator import Simulator
from pytest_tarl.ros import Ros, message_type
from tests.plugin.external.conftest import (
    FLOAT,
    SECOND,
    SETUP,
    STARTED,
    STEPPED,
    Guardian,
    begun,
    clock,
    graph,
    message,
)  # fmt: skip


def test_guardian_starts_the_command_with_simulator_time(guardian: Guardian, ros: Ros) -> None:
    made = begun(SETUP, guardian, ros, ("/imu", "/odom"))
    ((start,)) = guardian.commands("start")
    assert (start["command"], start["folder"], start["clock"], start["ros"]) == (
        ["sim", "--world", "a b"], "/project", "/clock", "ros2"
    )  # fmt: skip
    assert (start["topics"], start["environment"]["LEVEL"]) == (["/odom", "/imu"], "3")
    assert "PATH" in start["environment"]
    assert (ros.scheduler.time, made.clock, module.KEPT.running) == (2 * SECOND, 2.0, SETUP)
    assert made.latest("/odom").data == 0.5


def test_events_of_the_previous_simulator_are_ignored(guardian: Guardian, ros: Ros) -> None:
    for event in (clock(9.0), message("/odom", 9.0), graph("/other")):
        guardian.events.put(event)
    made = begun(SETUP, guardian, ros)
    assert (made.clock, made.latest("/odom").data) == (2.0, 0.5)


@pytest.mark.parametrize(
    ("events", "words"),
    [
        ([], r"no message on /odom; it publishes nothing\. Check"),
        ([graph("/scan /odom"), clock(1.0)], "no message on /odom; it publishes /odom, /scan"),
        ([graph("/odom", "/odom")], "no time on /clock; it publishes /odom"),
        ([graph("", "/odom"), clock(0.0)], "no time on /clock"),
    ],
)
def test_error_says_why_the_simulator_is_not_ready(
    guardian: Guardian, ros: Ros, events: list[dict[str, Any]], words: str
) -> None:
    guardian.react = lambda what, **_: [{"kind": "stopped"}, *events] if what == "start" else []
    guardian.said = "loading world"
    with pytest.raises(
        SimulatorError, match=rf"sim --world 'a b' was not ready after 0.05 s: {words}"
    ) as caught:
        Simulator(replace(SETUP, timeout=0.05), ros, ()).begin()
    assert str(caught.value).endswith("; its last output: loading world.")
    assert module.KEPT.running is None


@pytest.mark.parametrize(
    ("event", "error", "words"),
    [
        ({"kind": "failed", "reason": "no such file"}, SimulatorError, r"cannot be started \(no such file\)"),
        ({"kind": "ended", "status": 3}, SimulatorError, "ended with status 3 before it was ready"),
        ({"kind": "gone"}, SimulatorLostError, "process that keeps the simulator has ended"),
    ],
)
def test_a_simulator_that_ends_early_is_reported(
    guardian: Guardian, ros: Ros, event: dict[str, Any], error: type[Exception], words: str
) -> None:
    guardian.react = lambda *_, **__: [{"kind": "stopped"}, event]
    with pytest.raises(error, match=words):
        Simulator(SETUP, ros, ()).begin()


def test_error_for_an_ended_simulator_states_its_time(guardian: Guardian, ros: Ros) -> None:
    made = begun(SETUP, guardian, ros)
    guardian.events.put({"kind": "ended", "status": -9})
    with pytest.raises(SimulatorLostError, match="was killed by SIGKILL at 2 s of its time"):
        made.advance(1.0)
    made.end()
    assert [what for what, _ in guardian.done][-1] == "stop"


@pytest.mark.parametrize("setup", [SETUP, STEPPED])
def test_a_simulator_that_leaves_the_graph_before_its_end_still_counts_as_ready(
    guardian: Guardian, ros: Ros, setup: Setup
) -> None:
    made = begun(replace(setup, ready=("/cmd",)), guardian, ros)
    guardian.events.put(graph())  # no connection to /cmd is left, as before the simulator was ready
    guardian.events.put({"kind": "ended", "status": 3})
    with pytest.raises(SimulatorLostError, match="ended with status 3 at 2 s of its time"):
        made.advance(1.0)


def test_running_simulator_drives_clock_and_topics(guardian: Guardian, ros: Ros) -> None:
    heard: list[tuple[float, float]] = []
    ros.bus.observe(lambda _, one: heard.append((ros.now, one.data)))
    made = begun(SETUP, guardian, ros)
    for event in (clock(2.5), message("/odom", 1.0), clock(3.0), message("/odom", 2.0)):
        guardian.events.put(event)
    made.advance(1.0)
    assert (ros.now, made.clock) == (3.0, 3.0)
    assert heard == [(2.0, 0.5), (2.5, 1.0)]  # first the output of the start, then output as it arrives
    guardian.events.put(clock(5.5))
    made.advance(1.0)  # the last message of the first step comes at once, and the clock may run ahead
    assert heard[2:] == [(3.0, 2.0)]
    guardian.events.put(clock(6.5))
    made.advance(0.5)
    assert made.clock == 6.5


def test_test_waits_for_the_step_after_a_simulator_ran_ahead(guardian: Guardian, ros: Ros) -> None:
    made = begun(SETUP, guardian, ros)
    guardian.events.put(clock(9.0))
    made.advance(1.0)
    for seconds in (9.5, 10.0, 11.0):
        guardian.events.put(clock(seconds))
    made.advance(1.0)
    assert made.clock == 10.0


def test_a_simulator_without_progress_counts_as_hung(guardian: Guardian, ros: Ros) -> None:
    made = begun(replace(SETUP, patience=0.05), guardian, ros)
    guardian.events.put(clock(2.5))
    with pytest.raises(
        SimulatorLostError, match=r"hung at 2.5 s of simulated time: nothing new came within 0.05 s\."
    ):
        made.advance(1.0)


def test_clock_that_goes_back_is_an_error(guardian: Guardian, ros: Ros) -> None:
    made = begun(SETUP, guardian, ros)
    guardian.events.put(clock(1.5))
    with pytest.raises(SimulatorLostError, match=r"/clock went back from 2 s to 1\.5 s"):
        made.advance(1.0)


def test_the_nodes_commands_go_to_the_simulator(guardian: Guardian, ros: Ros) -> None:
    made = begun(SETUP, guardian, ros)
    guardian.events.put(clock(3.0))
    made.advance(1.0)

    def command(topic: str, kind: str, data: float) -> None:
        node: Any = SimpleNamespace()
        ros.bus.publish_from(node, ros.bus.topic(topic), message_type(kind)(data=data))

    command("/cmd", "std_msgs/Float64", 1.5)
    command("/other", "std_msgs/Float64", 9.0)
    guardian.events.put(clock(4.0))
    made.advance(1.0)
    command("/cmd", FLOAT, 2.5)
    assert guardian.commands("send") == [
        {"topic": "/cmd", "data": {"data": 1.5}}, {"topic": "/cmd", "data": {"data": 2.5}}
    ]  # fmt: skip


def test_topics_of_nodes_and_requested_topics_are_received(guardian: Guardian, ros: Ros) -> None:
    made = begun(SETUP, guardian, ros)
    ros.bus.subscribed |= {"/scan", "/clock", "/odom", "/gps"}  # as nodes that subscribe do
    guardian.react = lambda what, **_: (
        [graph("/odom /scan", "", "/odom /scan")] if what == "subscribe" else []
    )
    guardian.events.put(clock(3.0))
    made.advance(1.0)
    assert made.latest("/map") is None
    assert made.latest("/map") is None
    assert guardian.commands("subscribe") == [{"topics": ["/gps", "/scan"]}, {"topics": ["/map"]}]


def test_simulator_topic_must_be_connected_in_time(guardian: Guardian, ros: Ros) -> None:
    made = begun(replace(SETUP, patience=0.05), guardian, ros)
    made._graph["published"] = {"/map", "/odom"}
    with pytest.raises(SimulatorLostError, match="hung"):
        made.latest("/map")


def test_messages_of_unknown_types_are_refused(guardian: Guardian, ros: Ros) -> None:
    made = begun(SETUP, guardian, ros)
    guardian.events.put({**message("/odom", 1.0), "type": "no_msgs/msg/Such"})
    with pytest.raises(UnsupportedApiError, match="no_msgs"):
        made.advance(1.0)


def stepping(guardian: Guardian, *, silent: bool = False, stale: bool = False) -> None:
    state = {"time": 2.0, "asked": 100}

    def react(what: str, **arguments: Any) -> list[dict[str, Any]]:
        if what == "start":
            return STARTED
        if what != "call":
            return []
        state["time"] += 0.5
        state["asked"] += 100
        sent = state["asked"] - 1 if stale else state["asked"]
        position = [] if silent else [message("/odom", state["time"], sent)]
        return [
            {"kind": "answer", "id": arguments["id"], "asked": state["asked"]},
            clock(state["time"]),
            message("/scan", 1.0, sent),
            message("/aux", 1.0, sent),
            *position,
        ]

    guardian.react = react


def test_nodes_run_before_each_simulator_step(guardian: Guardian, ros: Ros) -> None:
    heard: list[tuple[str, float, float]] = []
    ros.bus.observe(lambda topic, one: heard.append((topic, ros.now, one.data)))
    stepping(guardian)
    made = Simulator(STEPPED, ros, ("/aux",))
    made.begin()
    made.advance(1.0)
    first = len(heard)
    made.advance(1.0)
    assert heard[0] == ("/odom", 2.0, 0.5)
    assert heard[first:] == [  # by topic, at the end of each step
        ("/aux", 3.5, 1.0), ("/odom", 3.5, 3.5), ("/scan", 3.5, 1.0),
        ("/aux", 4.0, 1.0), ("/odom", 4.0, 4.0), ("/scan", 4.0, 1.0),
    ]  # fmt: skip
    assert [(one["service"], one["request"], one["id"]) for one in guardian.commands("call")] == [
        ("/step", {"n": 1}, number) for number in (1, 2, 3, 4)
    ]
    assert ros.now == made.clock == 4.0


@pytest.mark.parametrize("how", ["silent", "stale"])
def test_step_needs_a_new_message_on_each_topic(guardian: Guardian, ros: Ros, how: str) -> None:
    stepping(guardian, **{how: True})
    made = Simulator(replace(STEPPED, patience=0.05), ros, ())
    made.begin()
    with pytest.raises(SimulatorLostError, match=r"hung at 2\.5 s"):
        made.advance(1.0)


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        ([], r"did not answer on /step within 0.05 s"),
        ([{"kind": "answer", "id": 1, "error": "no"}], "/step failed: no"),
    ],
)
def test_simulator_is_lost_if_a_service_fails(
    guardian: Guardian, ros: Ros, answer: list[dict[str, Any]], words: str
) -> None:
    guardian.react = lambda what, **_: STARTED if what == "start" else answer if what == "call" else []
    made = Simulator(replace(STEPPED, patience=0.05), ros, ())
    made.begin()
    with pytest.raises(SimulatorLostError, match=words):
        made.advance(1.0)
