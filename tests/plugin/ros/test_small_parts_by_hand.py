"""Small parts of the in-process ROS with stand-ins around them: states, geometry, accounts, services, queries."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pytest_tarl.errors import NodeError
from pytest_tarl.ros import message_type, tf2_geometry_msgs, topic_tools
from pytest_tarl.ros.accounts import account, of_node
from pytest_tarl.ros.actionlib.protocol import GoalStatus
from pytest_tarl.ros.rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from pytest_tarl.ros.smach.concurrence import Concurrence
from pytest_tarl.ros.smach.errors import InvalidTransitionError
from pytest_tarl.ros.smach.state import State
from pytest_tarl.ros.smach_ros import actions
from pytest_tarl.ros.smach_ros.actions import SimpleActionState
from pytest_tarl.ros.smach_ros.serving import ActionServerWrapper
from tests.plugin.ros.conftest import Start

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


def test_a_goal_is_cancelled_after_its_limit_and_given_up_after_another(clock: list[float]) -> None:
    client = Client(None, GoalStatus.ACTIVE, clock)
    state = Acting(client, clock, _limit=1.0, _end=0.55)
    assert state.execute({}) == "aborted"
    assert client.log[2:] == [("cancel", 1.1)]
    assert clock[0] == pytest.approx(1.7)


def test_a_goal_without_a_limit_waits_until_its_end(clock: list[float]) -> None:
    client = Client(500.0, GoalStatus.SUCCEEDED, clock)
    assert Acting(client, clock).execute({}) == "succeeded"
    assert client.log[2:] == []


def test_a_state_that_must_end_at_once_sends_nothing_and_neither_does_one_without_a_server(
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
def test_a_callback_may_choose_one_of_the_outcomes_of_the_state(
    chosen: str | None, outcome: str, clock: list[float]
) -> None:
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


def test_slots_of_goal_result_and_feedback_are_mapped_to_userdata() -> None:
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


def test_only_the_mapped_slots_are_passed_by_default_and_no_feedback_without_a_goal() -> None:
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
def test_the_first_outcome_whose_states_ended_as_mapped_is_chosen(
    ended: dict[str, str], outcome: str
) -> None:
    made = concurrence(outcome_map={"good": {"a": "x", "b": "x"}, "bad": {"b": "y"}})
    made._ended = dict(ended)
    made.check_consistency()
    assert made._outcome() == outcome
    assert made.get_internal_edges() == [("x", "a", "good"), ("x", "b", "good"), ("y", "b", "bad")]
    assert made.get_initial_states() == ["a", "b"]


def test_a_callback_chooses_before_the_map_and_must_know_the_outcome() -> None:
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


# geometry

TURN = Rotation.from_euler("xyz", [0.3, -0.2, 1.1])
MOVE = np.array([1.0, -2.0, 0.5])


@pytest.fixture(params=["ros1", "ros2"])
def transform(request: pytest.FixtureRequest) -> Any:
    """Return a function that makes messages, and the transform to the frame `map`."""
    infix = "/" if request.param == "ros1" else "/msg/"

    def make(name: str) -> Any:
        return message_type(f"geometry_msgs{infix}{name}")()

    made = make("TransformStamped")
    made.header.frame_id = "map"
    made.transform.translation.x, made.transform.translation.y, made.transform.translation.z = MOVE.tolist()
    turn = made.transform.rotation
    turn.x, turn.y, turn.z, turn.w = TURN.as_quat().tolist()
    return make, made


def numbers(vector: Any) -> list[float]:
    return [vector.x, vector.y, vector.z]


def test_points_are_rotated_and_moved_and_vectors_only_rotated(transform: Any) -> None:
    make, to_map = transform
    for name, part, expected in (
        ("PointStamped", "point", TURN.apply([1, 2, 3]) + MOVE),
        ("Vector3Stamped", "vector", TURN.apply([1, 2, 3])),
    ):
        given = make(name)
        inner = getattr(given, part)
        inner.x, inner.y, inner.z = 1.0, 2.0, 3.0
        moved = tf2_geometry_msgs.TRANSFORMERS[name](given, to_map)
        assert numbers(getattr(moved, part)) == pytest.approx(expected.tolist())
        assert (moved.header.frame_id, given.header.frame_id) == ("map", "")
        assert numbers(inner) == [1.0, 2.0, 3.0]


def test_both_parts_of_a_wrench_are_rotated(transform: Any) -> None:
    make, to_map = transform
    given = make("WrenchStamped")
    given.wrench.force.x, given.wrench.torque.y = 1.0, 2.0
    moved = tf2_geometry_msgs.do_transform_wrench(given, to_map)
    assert numbers(moved.wrench.force) == pytest.approx(TURN.apply([1, 0, 0]).tolist())
    assert numbers(moved.wrench.torque) == pytest.approx(TURN.apply([0, 2, 0]).tolist())


def test_a_pose_is_moved_with_and_without_a_header(transform: Any) -> None:
    make, to_map = transform
    stamped = make("PoseStamped")
    own = Rotation.from_euler("z", 0.4)
    stamped.pose.position.x = 2.0
    turn = stamped.pose.orientation
    turn.x, turn.y, turn.z, turn.w = own.as_quat().tolist()
    for moved in (
        tf2_geometry_msgs.do_transform_pose(stamped, to_map).pose,
        tf2_geometry_msgs.do_transform_pose(stamped.pose, to_map),
    ):
        assert numbers(moved.position) == pytest.approx((TURN.apply([2, 0, 0]) + MOVE).tolist())
        found = Rotation.from_quat(
            [moved.orientation.x, moved.orientation.y, moved.orientation.z, moved.orientation.w]
        )
        assert found.as_matrix() == pytest.approx((TURN * own).as_matrix())
    assert stamped.pose.position.x == 2.0


def test_a_covariance_is_rotated_with_its_pose(transform: Any) -> None:
    make, to_map = transform
    given = make("PoseWithCovarianceStamped")
    given.pose.pose.orientation.w = 1.0
    covariance = np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    given.pose.covariance = covariance.ravel().tolist()
    moved = tf2_geometry_msgs.do_transform_pose_with_covariance_stamped(given, to_map)
    both = np.kron(np.eye(2), TURN.as_matrix())
    assert np.allclose(np.reshape(moved.pose.covariance, (6, 6)), both @ covariance @ both.T)
    assert numbers(moved.pose.pose.position) == pytest.approx(MOVE.tolist())


# accounts of errors


def raised(cause: BaseException | None) -> NodeError:
    try:
        if cause is not None:
            try:
                exec(compile("raise cause", "/robot/node.py", "exec"), {"cause": cause})
            except type(cause) as error:
                raise NodeError("Node failed.") from error
        raise NodeError("Node failed.")
    except NodeError as error:
        return error


def test_an_account_has_the_sentence_the_traceback_of_the_node_and_the_line_of_the_test() -> None:
    text = account(raised(ValueError("boom")), Path(__file__))
    sentence, trace, line = text.split("\n\n")
    assert sentence == "Node failed."
    assert trace.endswith('File "/robot/node.py", line 1, in <module>\nValueError: boom')
    assert line.startswith("The test was at test_small_parts_by_hand.py, line ")
    assert line.endswith('raise NodeError("Node failed.") from error')


def test_an_error_without_a_cause_or_of_the_test_is_only_its_message() -> None:
    assert account(raised(None), Path(__file__)) == "Node failed."
    assert account(ValueError("mine"), Path(__file__)) == "mine"
    other = account(raised(ValueError("boom")), Path("/elsewhere/test_x.py"))
    assert "The test was at" not in other


def test_the_frames_of_the_package_at_the_beginning_are_left_out() -> None:
    def of(*files: str) -> Any:
        frame: Any = None
        for file in reversed(files):
            frame = SimpleNamespace(
                tb_frame=SimpleNamespace(f_code=SimpleNamespace(co_filename=file)), tb_next=frame
            )
        return frame

    own = str(Path(sys.modules["pytest_tarl"].__file__ or "").parent / "ros" / "x.py")
    trace = of(own, own, "/robot/node.py", own)
    assert of_node(trace) is trace.tb_next.tb_next
    only = of(own, own)
    assert of_node(only) is only


# groups


def test_an_exclusive_group_runs_one_callback_and_a_reentrant_one_any_number() -> None:
    exclusive, free = MutuallyExclusiveCallbackGroup(), ReentrantCallbackGroup()
    assert (exclusive.can_execute("a"), exclusive.beginning_execution("a")) == (True, True)
    assert (exclusive.can_execute("b"), exclusive.beginning_execution("b")) == (False, False)
    exclusive.ending_execution("a")
    assert exclusive.beginning_execution("b")
    assert [free.beginning_execution(one) and free.can_execute(one) for one in "ab"] == [True, True]
    exclusive.add_entity("a")
    assert [exclusive.has_entity(one) for one in "ab"] == [True, False]


# lazy transports


class Lazy(topic_tools.LazyTransport):
    """A node that notes when it subscribes."""

    def __init__(self, *peers: int) -> None:
        super().__init__()
        self.trail: list[str] = []
        self._publishers = [SimpleNamespace(get_num_connections=lambda peer=peer: peer) for peer in peers]  # type: ignore[misc]

    def subscribe(self) -> None:
        self.trail.append("subscribe")

    def unsubscribe(self) -> None:
        self.trail.append("unsubscribe")


def test_a_lazy_node_subscribes_once_and_until_its_last_peer_has_gone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(topic_tools, "get_param", lambda name, default: default)
    idle, busy = Lazy(0, 0), Lazy(0, 1)
    for one in (idle, busy):
        one.peer_subscribe()
        one.peer_unsubscribe()
    assert idle.trail == ["subscribe", "unsubscribe"]
    assert busy.trail == ["subscribe"]
    idle.peer_unsubscribe()
    idle.peer_subscribe()
    assert idle.trail[2:] == ["subscribe"]
    assert Lazy().trail == []


def test_a_node_that_is_not_lazy_always_subscribes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(topic_tools, "get_param", lambda name, default: False)
    node = Lazy()
    node.peer_unsubscribe()
    assert node.trail == ["subscribe"]


# services and the graph of ROS 2

PAIR = """
    import rclpy
    from example_interfaces.srv import AddTwoInts
    from std_msgs.msg import String
    rclpy.init()
    node = rclpy.create_node("one", namespace="ns")
    found = []
"""


def found(ros: Any) -> list[Any]:
    return ros.namespace["found"]  # type: ignore[no-any-return]


def test_a_client_waits_for_a_service_and_calls_it_with_a_limit(start: Start) -> None:
    ros = start(
        PAIR
        + """
    client = node.create_client(AddTwoInts, "add")
    found += [client.service_is_ready(), client.wait_for_service(0.5), node.get_clock().now().nanoseconds]
    found.append(client.call(AddTwoInts.Request(a=1, b=2), timeout_sec=0.25))
    found.append(node.get_clock().now().nanoseconds)
    pending = client.call_async(AddTwoInts.Request())
    client.remove_pending_request(pending)
    kept = client.call_async(AddTwoInts.Request())
    client.destroy()
    found += [pending.cancelled(), kept.cancelled()]
    try:
        client.call_async("text")
    except TypeError as error:
        found.append(str(error).startswith("Expected"))
    """
    )
    ros.step(2.0)
    assert found(ros) == [False, False, 500_000_000, None, 750_000_000, False, True, True]


def test_a_service_may_answer_from_a_coroutine_and_be_destroyed(start: Start) -> None:
    ros = start(
        PAIR
        + """
    async def add(request, response):
        response.sum = request.a + request.b
        return response
    service = node.create_service(AddTwoInts, "add", add)
    client = node.create_client(AddTwoInts, "add")
    future = client.call_async(AddTwoInts.Request(a=1, b=2))
    rclpy.spin_until_future_complete(node, future)
    found += [future.result().sum, client.service_is_ready(), node.count_services("add"), node.count_clients("add")]
    node.destroy_service(service)
    found += [client.service_is_ready(), node.count_services("add")]
    """
    )
    ros.step(1.0)
    assert found(ros) == [3, True, 1, 1, False, 0]


def test_a_node_describes_the_ends_of_topics_and_services(start: Start) -> None:
    ros = start(
        PAIR
        + """
    node.create_publisher(String, "text", 3)
    node.create_subscription(String, "heard", lambda _: None, 4)
    node.create_service(AddTwoInts, "add", lambda request, response: response)
    node.create_client(AddTwoInts, "other")
    of = "one", "/ns"
    found += [node.get_service_names_and_types_by_node(*of)[-1], node.get_client_names_and_types_by_node(*of)]
    found += [("/ns/text", ["std_msgs/msg/String"]) in node.get_publisher_names_and_types_by_node(*of)]
    found += [("/ns/heard", ["std_msgs/msg/String"]) in node.get_subscriber_names_and_types_by_node(*of)]
    (end,) = node.get_publishers_info_by_topic("text")
    found += [(end.node_name, end.node_namespace, end.topic_type, int(end.endpoint_type), end.qos_profile.depth)]
    (end,) = node.get_subscriptions_info_by_topic("heard")
    found += [(int(end.endpoint_type), end.qos_profile.depth), node.get_subscriptions_info_by_topic("text")]
    found += [node.count_publishers("text"), node.count_publishers("heard"), node.count_subscribers("heard")]
    found += [node.wait_for_node("ns/one", 1.0), node.wait_for_node("ns/two", 0.25)]
    found += [node.get_clock().now().nanoseconds, node.get_node_names_and_namespaces()]
    try:
        node.get_publisher_names_and_types_by_node("two", "/ns")
    except RuntimeError as error:
        found.append("does not exist" in str(error))
    """
    )
    ros.step(1.0)
    assert found(ros) == [
        ("/ns/add", ["example_interfaces/srv/AddTwoInts"]),
        [("/ns/other", ["example_interfaces/srv/AddTwoInts"])],
        True,
        True,
        ("one", "/ns", "std_msgs/msg/String", 1, 3),
        (2, 4),
        [],
        2,
        1,
        2,
        True,
        False,
        250_000_000,
        [("one", "/ns")],
        True,
    ]
