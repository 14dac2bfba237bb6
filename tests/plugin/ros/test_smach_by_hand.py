"""States and containers of smach, with scripted clients, servers and children."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.ros.actionlib.protocol import GoalStatus
from pytest_tarl.ros.smach.concurrence import Concurrence
from pytest_tarl.ros.smach.errors import InvalidTransitionError
from pytest_tarl.ros.smach.state import State
from pytest_tarl.ros.smach_ros import actions
from pytest_tarl.ros.smach_ros.actions import SimpleActionState
from pytest_tarl.ros.smach_ros.serving import ActionServerWrapper

# an action state


class Client:
    """An action client whose goal ends at an instant; `log` lists what it was asked."""

    def __init__(self, ends: float | None, status: int, clock: list[float]) -> None:
        self.ends, self.status, self.clock = ends, status, clock
        self.log: list[Any] = []
        self.present = True
        self.result: Any = None

    def wait_for_server(self, limit: Any) -> bool:
        self.log.append(("wait", limit.to_sec()))
        return self.present

    def send_goal(self, goal: Any) -> None:
        self.log.append(("goal", goal))

    def cancel_goal(self) -> None:
        self.log.append(("cancel", round(self.clock[0], 6)))

    def wait_for_result(self, limit: Any) -> bool:
        self.clock[0] += limit.to_sec()
        return self.ends is not None and self.clock[0] >= self.ends - 1e-9

    def get_state(self) -> int:
        return self.status

    def get_result(self) -> Any:
        return self.result


class Acting(SimpleActionState):
    """An action state with a scripted client; the end is requested at an instant."""

    def __init__(
        self, client: Client, clock: list[float], asked_at: float | None = None, **given: Any
    ) -> None:
        State.__init__(self, ["succeeded", "aborted", "preempted", "odd"])
        self._name, self._client, self._clock, self._asked_at = "act", client, clock, asked_at  # type: ignore[assignment]
        self._goal, self._goal_key, self._goal_slots = "goal", None, []
        self._goal_cb = self._result_cb = (None, (), {})
        self._result_key, self._result_slots = None, []
        self._limit, self._wait, self._end = None, 60.0, 60.0
        self.served = 0
        self.__dict__ |= given

    def preempt_requested(self) -> bool:
        return self._asked_at is not None and self._clock[0] >= self._asked_at - 1e-9

    def service_preempt(self) -> None:
        self.served += 1


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [0.0]
    monkeypatch.setattr(actions, "get_time", lambda: now[0])
    monkeypatch.setattr(actions, "is_shutdown", lambda: False)
    for name in ("logerr", "logwarn"):
        monkeypatch.setattr(actions, name, lambda text: None)
    return now


@pytest.mark.parametrize(
    ("status", "asked_at", "outcome"),
    [
        (GoalStatus.SUCCEEDED, None, "succeeded"),
        (GoalStatus.ABORTED, None, "aborted"),
        (GoalStatus.PREEMPTED, None, "aborted"),
        (GoalStatus.PREEMPTED, 0.5, "preempted"),
        (GoalStatus.SUCCEEDED, 0.5, "succeeded"),
    ],
)
def test_an_action_state_has_the_outcome_of_its_goal(
    status: int, asked_at: float | None, outcome: str, clock: list[float]
) -> None:
    client = Client(2.0, status, clock)
    state = Acting(client, clock, asked_at)
    assert state.execute({}) == outcome
    assert client.log[:2] == [("wait", 60.0), ("goal", "goal")]
    assert client.log[2:] == ([("cancel", 0.5)] if asked_at is not None else [])
    assert state.served == (outcome == "preempted")


def test_goal_is_cancelled_at_one_limit_and_abandoned_at_another(
    clock: list[float],
) -> None:
    client = Client(None, GoalStatus.ACTIVE, clock)
    state = Acting(client, clock, _limit=1.0, _end=0.55)
    assert state.execute({}) == "aborted"
    assert client.log[2:] == [("cancel", 1.1)]
    assert clock[0] == pytest.approx(1.7)


def test_a_goal_without_a_limit_waits_until_its_end(clock: list[float]) -> None:
    client = Client(500.0, GoalStatus.SUCCEEDED, clock)
    assert Acting(client, clock).execute({}) == "succeeded"
    assert client.log[2:] == []


def test_state_without_a_server_sends_no_goal(
    clock: list[float],
) -> None:
    client = Client(1.0, GoalStatus.SUCCEEDED, clock)
    state = Acting(client, clock, 0.0)
    assert (state.execute({}), client.log, state.served) == ("preempted", [], 1)
    client.present = False
    assert Acting(client, clock, _wait=2.5).execute({}) == "aborted"
    assert client.log == [("wait", 2.5)]


@pytest.mark.parametrize(
    ("chosen", "outcome"), [("odd", "odd"), ("unknown", "succeeded"), (None, "succeeded")]
)
def test_callback_may_choose_the_outcome(chosen: str | None, outcome: str, clock: list[float]) -> None:
    heard: list[Any] = []

    def callback(userdata: Any, status: int, result: Any, *given: Any, **named: Any) -> str | None:
        heard.append((status, result, given, named))
        return chosen

    client = Client(0.1, GoalStatus.SUCCEEDED, clock)
    assert Acting(client, clock, _result_cb=(callback, (1,), {"key": 2})).execute({}) == outcome
    assert heard == [(GoalStatus.SUCCEEDED, None, (1,), {"key": 2})]


# a container that serves an action


class Container:
    """A container whose outcome is given; it stores a value in its userdata."""

    def __init__(self, outcome: str, **stored: Any) -> None:
        self.outcome, self.stored = outcome, stored
        self.userdata: dict[str, Any] = {}
        self.running, self.asked = True, 0
        self.callbacks: list[Any] = []

    def execute(self) -> str:
        self.before = dict(self.userdata)
        self.userdata.update(self.stored)
        for callback in self.callbacks:
            callback()
        return self.outcome

    def register_start_cb(self, callback: Any) -> None:
        self.callbacks.append(callback)

    def register_transition_cb(self, callback: Any) -> None:
        self.callbacks.append(callback)

    def is_running(self) -> bool:
        return self.running

    def request_preempt(self) -> None:
        self.asked += 1


class Server:
    """A server that notes how its goal ends, and its feedback."""

    def __init__(self, active: bool = True) -> None:
        self.ended: list[Any] = []
        self.feedback: list[Any] = []
        self.active = active

    def is_active(self) -> bool:
        return self.active

    def set_succeeded(self, result: Any, text: str = "") -> None:
        self.ended.append(("succeeded", result, text))

    def set_preempted(self, result: Any, text: str = "") -> None:
        self.ended.append(("preempted", result, text))

    def set_aborted(self, result: Any, text: str = "") -> None:
        self.ended.append(("aborted", result, text))

    def publish_feedback(self, feedback: Any) -> None:
        self.feedback.append(contents(feedback))


def slots(**given: Any) -> Any:
    """Return an object with slots, as a message has."""
    made = type("Slots", (), {"__slots__": list(given)})()
    for name, value in given.items():
        setattr(made, name, value)
    return made


def contents(one: Any) -> dict[str, Any]:
    return {name: getattr(one, name) for name in one.__slots__}


def spec() -> Any:
    return SimpleNamespace(
        action_result=SimpleNamespace(result=slots(total=0, rest=0)),
        action_feedback=SimpleNamespace(feedback=slots(step=0)),
    )


def served(container: Container, server: Server, **given: Any) -> ActionServerWrapper:
    made = ActionServerWrapper(
        "act",
        spec,
        container,
        succeeded_outcomes=["ok"],
        aborted_outcomes=["bad"],
        preempted_outcomes=["cut"],
        **given,
    )
    made._server = server  # type: ignore[assignment]
    return made


@pytest.mark.parametrize(
    ("outcome", "ended", "text"),
    [
        ("ok", "succeeded", ""),
        ("cut", "preempted", ""),
        ("bad", "aborted", ""),
        ("other", "aborted", "Outcome other has no meaning."),
    ],
)
def test_the_outcome_of_a_container_ends_the_goal(outcome: str, ended: str, text: str) -> None:
    server = Server()
    served(Container(outcome), server).execute_cb(slots(order=5))
    assert [(one, words) for one, _, words in server.ended] == [(ended, text)]


def test_goal_slots_are_mapped_to_userdata() -> None:
    server, container = Server(), Container("ok", sum=7, rest=3, at=4)
    made = served(
        container,
        server,
        goal_slots_map={"order": "wanted"},
        result_slots_map={"total": "sum"},
        feedback_slots_map={"step": "at"},
        expand_goal_slots=True,
        pack_result_slots=True,
    )
    made.execute_cb(slots(order=5, extra=6))
    assert (container.before["wanted"], container.before["extra"]) == (5, 6)
    assert contents(server.ended[0][1]) == {"total": 7, "rest": 3}
    assert server.feedback == [{"step": 4}] * 2


def test_only_mapped_slots_are_passed_by_default() -> None:
    server, container = Server(active=False), Container("ok", sum=7, rest=3)
    made = served(container, server, goal_slots_map={"order": "wanted"}, result_slots_map={"total": "sum"})
    made.execute_cb(slots(order=5, extra=6))
    assert "extra" not in container.before
    assert contents(server.ended[0][1]) == {"total": 7, "rest": 0}
    assert server.feedback == []


def test_a_running_container_is_asked_to_end() -> None:
    container = Container("ok")
    made = served(container, Server())
    made.preempt_cb()
    container.running = False
    made.preempt_cb()
    assert container.asked == 1


# a concurrence


def concurrence(**given: Any) -> Concurrence:
    made = Concurrence(["good", "bad", "default"], "default", **given)
    made._states = {"a": State(["x", "y"]), "b": State(["x", "y"])}
    return made


@pytest.mark.parametrize(
    ("ended", "outcome"),
    [({"a": "x", "b": "x"}, "good"), ({"a": "x", "b": "y"}, "bad"), ({"a": "y", "b": "x"}, "default")],
)
def test_first_matching_outcome_is_chosen(ended: dict[str, str], outcome: str) -> None:
    made = concurrence(outcome_map={"good": {"a": "x", "b": "x"}, "bad": {"b": "y"}})
    made._ended = dict(ended)
    made.check_consistency()
    assert made._outcome() == outcome
    assert made.get_internal_edges() == [("x", "a", "good"), ("x", "b", "good"), ("y", "b", "bad")]
    assert made.get_initial_states() == ["a", "b"]


def test_outcome_callback_overrides_the_map() -> None:
    for chosen, outcome in (("bad", "bad"), (None, "good")):
        made = concurrence(outcome_map={"good": {}}, outcome_cb=lambda ended, chosen=chosen: chosen)
        assert made._outcome() == outcome
    wrong = concurrence(outcome_cb=lambda ended: "nothing")
    with pytest.raises(InvalidTransitionError, match="outcome_cb returned 'nothing'"):
        wrong._outcome()


def test_unknown_outcomes_and_states_of_a_map_are_refused() -> None:
    with pytest.raises(InvalidTransitionError, match="no outcome 'other'"):
        concurrence(outcome_map={"other": {}}).check_consistency()
    with pytest.raises(InvalidTransitionError, match="a state 'c' that was not added"):
        concurrence(outcome_map={"good": {"c": "x"}}).check_consistency()
    with pytest.raises(InvalidTransitionError, match="no outcome 'missing'"):
        Concurrence(["good"], "missing").check_consistency()
