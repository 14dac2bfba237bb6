"""Simulators that serve several episodes, and the guardian that keeps them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from pytest_tarl.errors import SimulatorError, SimulatorLostError
from pytest_tarl.external import simulator as module
from pytest_tarl.external.arguments import Call, Setup
from pytest_tarl.external.simulator import Simulator
from pytest_tarl.ros import Ros, message_type
from tests.plugin.external.conftest import FLOAT, SETUP, STARTED, Guardian, begun, clock, graph, message

RESET = replace(SETUP, reset=Call("/reset"))


def test_a_simulator_with_a_reset_serves_further_episodes(guardian: Guardian, ros: Ros) -> None:
    made = begun(RESET, guardian, ros)
    guardian.events.put(clock(3.0))
    made.advance(1.0)
    made.end()
    assert module.KEPT.running == RESET
    assert guardian.commands("stop") == []

    def react(what: str, **arguments: Any) -> list[dict[str, Any]]:
        answer = {"kind": "answer", "id": arguments.get("id"), "asked": 5}
        after = [graph("/odom", "", "/odom"), message("/odom", 7.0), clock(0.5)]
        return [message("/odom", 6.0), clock(0.1), answer, *after] if what == "call" else []

    guardian.react = react
    again = Simulator(RESET, ros, ())
    again.begin()
    assert (len(guardian.commands("start")), again.clock, again.latest("/odom").data) == (1, 0.5, 7.0)
    assert guardian.commands("call")[-1]["service"] == "/reset"
    other = Simulator(replace(RESET, command=("other",)), ros, ())
    guardian.react = lambda what, **_: STARTED if what == "start" else []
    other.begin()
    assert len(guardian.commands("start")) == 2


def test_simulator_that_ignores_its_reset_is_restarted(guardian: Guardian, ros: Ros) -> None:
    quick = replace(RESET, patience=0.05)
    module.KEPT.running = quick
    made = begun(quick, guardian, ros)
    assert [what for what, _ in guardian.done if what != "subscribe"] == ["call", "stop", "start"]
    assert made.clock == 2.0


def test_a_simulator_that_ends_during_its_reset_is_started_again(guardian: Guardian, ros: Ros) -> None:
    module.KEPT.running = RESET
    events = {"call": [{"kind": "ended", "status": 3}], "start": STARTED}
    guardian.react = lambda what, **_: events.get(what, [])
    made = Simulator(RESET, ros, ())
    made.begin()
    assert (made.clock, len(guardian.commands("start"))) == (2.0, 1)
    assert "so a new one was started: it ended with status 3." in "".join(ros.notes)


def test_a_simulator_that_ends_after_it_answered_its_reset_is_lost(guardian: Guardian, ros: Ros) -> None:
    module.KEPT.running = RESET

    def react(what: str, **arguments: Any) -> list[dict[str, Any]]:
        answer = {"kind": "answer", "id": arguments.get("id"), "asked": 5}
        return [answer, {"kind": "ended", "status": 3}] if what == "call" else []

    guardian.react = react
    with pytest.raises(SimulatorLostError, match=r"ended with status 3 during its reset\."):
        Simulator(RESET, ros, ()).begin()


def test_a_simulator_that_replaces_one_without_an_answer_can_end_before_it_is_ready(
    guardian: Guardian, ros: Ros
) -> None:
    module.KEPT.running = quick = replace(RESET, patience=0.05)
    events = {"start": [{"kind": "stopped"}, {"kind": "ended", "status": 4}]}
    guardian.react = lambda what, **_: events.get(what, [])
    with pytest.raises(SimulatorError, match="ended with status 4 before it was ready") as caught:
        Simulator(quick, ros, ()).begin()
    assert not isinstance(caught.value, SimulatorLostError)


def test_old_messages_do_not_make_a_new_simulator_ready(guardian: Guardian, ros: Ros) -> None:
    quick = replace(RESET, patience=0.05, timeout=0.05)
    module.KEPT.running = quick
    events = {"call": [message("/odom", 9.0), clock(9.0)], "start": [{"kind": "stopped"}]}
    guardian.react = lambda what, **_: events.get(what, [])
    with pytest.raises(SimulatorError, match=r"was not ready after 0.05 s: no message on /odom"):
        Simulator(quick, ros, ()).begin()


def test_new_simulator_starts_after_the_old_one_ended(guardian: Guardian, ros: Ros) -> None:
    made = Simulator(SETUP, ros, ())
    assert made.clock == 0.0
    guardian.react = lambda what, **_: [clock(9.0), {"kind": "stopped"}] if what == "start" else []
    made._start()
    assert (made._current, made.clock) == (True, 0.0)


@pytest.mark.parametrize("setup", [SETUP, RESET])
def test_simulator_without_reset_stops_after_an_episode(
    guardian: Guardian, ros: Ros, setup: Setup, capsys: pytest.CaptureFixture[str]
) -> None:
    made = begun(setup, guardian, ros)
    guardian.said = " warned \n"
    made.end()  # RESET: no step ended without an error
    assert len(guardian.commands("stop")) == 1
    assert module.KEPT.running is None
    assert capsys.readouterr().out == "output of sim --world 'a b':\nwarned\n"


def test_each_ros1_simulator_gets_its_own_guardian(guardian: Guardian, ros: Ros) -> None:
    made = Simulator(replace(SETUP, ros="ros1", timeout=0.05), ros, ())
    with pytest.raises(SimulatorError, match="was not ready"):
        made.begin()
    assert guardian.closed
    assert made._client is not guardian
    package = made._theirs(message_type(FLOAT)(data=1.0))
    assert (hasattr(type(package), "_slot_types"), package.data) == (True, 1.0)


def test_a_guardian_that_has_ended_is_replaced(guardian: Guardian) -> None:
    kept = module.KEPT
    assert kept.opened() is guardian  # type: ignore[comparison-overlap]
    guardian.alive = False
    kept.running = SETUP
    assert kept.opened() is not guardian  # type: ignore[comparison-overlap]
    assert (guardian.closed, kept.running) == (True, None)
    kept.close()
    assert kept.client is None
