"""ROS 1 actions goal by goal: which are accepted, replaced, cancelled and ended, and what their topics show."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.ros import Ros, message_type
from pytest_tarl.ros.messages.times import Time
from tests.plugin.ros.conftest import Start, heard

PENDING, ACTIVE, PREEMPTED, SUCCEEDED, ABORTED, _, PREEMPTING, _, RECALLED = range(9)


NODE = """
import actionlib, rospy
from actionlib_tutorials.msg import FibonacciAction, FibonacciFeedback, FibonacciResult
rospy.init_node("server")
log = []
server = actionlib.SimpleActionServer("sum", FibonacciAction, auto_start=False)
def goal():
    log.append(("goal", server.is_new_goal_available(), server.is_active()))
    if accepting:
        log.append(server.accept_new_goal().order)
def preempt():
    log.append(("preempt", server.is_preempt_requested()))
server.register_goal_callback(goal)
server.register_preempt_callback(preempt)
accepting = True
server.start()
def do(event):
    for code in commands:
        exec(code, globals())
    commands.clear()
commands = []
rospy.Timer(rospy.Duration(0.1), do)
rospy.spin()
"""


class Scene:
    """A server in a node that runs commands, and a world that sends goals and keeps what the server publishes."""

    def __init__(self, start: Start) -> None:
        self.ros: Ros = start(NODE)
        self.names: dict[str, Any] = self.ros.namespace  # type: ignore[attr-defined]
        self.log = self.names["log"]
        self.results, self.feedback = heard(self.ros, "/sum/result"), heard(self.ros, "/sum/feedback")
        self.states = heard(self.ros, "/sum/status")
        self.ros.step(0.05)

    def do(self, *commands: str) -> None:
        """Run commands in the node."""
        self.names["commands"] += commands
        self.ros.step(0.1)

    def goal(self, name: str, order: int = 1, stamp: float = 0.0) -> None:
        """Send a goal."""
        message: Any = message_type("actionlib_tutorials/FibonacciActionGoal")()
        message.goal_id.id, message.goal_id.stamp, message.goal.order = name, Time(stamp), order
        self.ros.bus.publish("/sum/goal", message)

    def cancel(self, name: str = "", stamp: float = 0.0) -> None:
        """Send a cancel request."""
        self.ros.bus.publish("/sum/cancel", message_type("actionlib_msgs/GoalID")(Time(stamp), name))

    def ended(self) -> list[tuple[str, int]]:
        """Return the goals and states of the results."""
        return [(one.status.goal_id.id, one.status.status) for one in self.results]

    def shown(self) -> list[tuple[str, int]]:
        """Return the goals and states of the status messages."""
        return [(one.status_list[0].goal_id.id, one.status_list[0].status) for one in self.states]


@pytest.fixture
def scene(start: Start) -> Scene:
    return Scene(start)


@pytest.mark.parametrize(
    ("command", "status", "text"),
    [
        ("server.set_succeeded(FibonacciResult([1, 2]), 'well')", SUCCEEDED, "well"),
        ("server.set_aborted(FibonacciResult([1, 2]), 'badly')", ABORTED, "badly"),
        ("server.set_preempted(FibonacciResult([1, 2]))", PREEMPTED, ""),
    ],
)
def test_a_goal_is_shown_as_pending_active_and_ended(
    scene: Scene, command: str, status: int, text: str
) -> None:
    scene.goal("a", order=7)
    scene.do("log.append(server.is_active())", "server.publish_feedback(FibonacciFeedback([1]))", command,
             "log.append(server.is_active())")  # fmt: skip
    assert scene.log == [("goal", True, False), 7, True, False]
    assert scene.shown() == [("a", PENDING), ("a", ACTIVE), ("a", status)]
    (result,) = scene.results
    assert (result.status.goal_id.id, result.status.status, result.status.text) == ("a", status, text)
    assert (tuple(result.result.sequence), scene.states[-1].status_list[0].text) == ((1, 2), text)
    (feedback,) = scene.feedback
    assert (feedback.status.goal_id.id, feedback.status.status, tuple(feedback.feedback.sequence)) == (
        "a",
        ACTIVE,
        (1,),
    )
    assert result.header.stamp.to_sec() > 0


@pytest.mark.parametrize("given", ["", "None", "0", "''"])
def test_ended_goal_has_an_empty_result(scene: Scene, given: str) -> None:
    scene.goal("a")
    scene.do(f"server.set_succeeded({given})", "log.append(len(server.get_default_result().sequence))")
    assert (len(scene.results[0].result.sequence), scene.log[-1]) == (0, 0)
    assert scene.ended() == [("a", SUCCEEDED)]


def test_newer_goal_ends_the_active_one(scene: Scene) -> None:
    scene.goal("a", 1)
    scene.do("accepting = False")
    scene.goal("b", 2)
    scene.do("log.append(server.is_preempt_requested())", "log.append(server.accept_new_goal().order)",
             "log.append(server.is_preempt_requested())")  # fmt: skip
    assert scene.log[2:] == [("preempt", True), ("goal", True, True), True, 2, False]
    assert scene.ended() == [("a", PREEMPTED)]
    assert "another goal was received" in scene.results[0].status.text
    assert scene.shown()[-3:] == [("a", PREEMPTING), ("a", PREEMPTED), ("b", ACTIVE)]


def test_a_waiting_goal_is_recalled_by_a_newer_goal(scene: Scene) -> None:
    scene.do("accepting = False")
    for name in "abc":
        scene.goal(name)
    scene.do("log.append(server.is_new_goal_available())", "server.accept_new_goal()",
             "log.append(server.is_new_goal_available())", "log.append(server.accept_new_goal())")  # fmt: skip
    assert scene.ended() == [("a", RECALLED), ("b", RECALLED)]
    assert scene.log[-3:] == [True, False, None]
    assert scene.shown()[-1] == ("c", ACTIVE)


@pytest.mark.parametrize(
    ("request_", "active", "waiting"),
    [
        (("", 0.0), True, True),
        (("a", 0.0), True, False),
        (("b", 0.0), False, True),
        (("c", 0.0), False, False),
        (("", 1.0), False, False),
        (("", 2.0), True, False),
        (("", 3.5), True, True),
        (("b", 2.0), True, True),
    ],
)
def test_cancel_request_selects_goals_by_id_or_stamp(
    scene: Scene, request_: tuple[str, float], active: bool, waiting: bool
) -> None:
    scene.goal("a", stamp=2.0)
    scene.do("accepting = False", "server.register_preempt_callback(lambda: log.append('cancel'))")
    scene.goal("b", stamp=3.0)
    scene.do("log.clear()", "server._preempt_requested = False")
    scene.cancel(*request_)
    scene.do("log.append((server.is_preempt_requested(), server.is_new_goal_available()))")
    assert scene.log == [*(["cancel"] if active else []), (active, not waiting)]
    assert scene.ended() == ([("b", RECALLED)] if waiting else [])


def test_goals_sent_before_a_cancel_request_are_recalled(scene: Scene) -> None:
    scene.cancel(stamp=2.0)
    scene.cancel(stamp=1.0)
    scene.goal("early", stamp=2.0)
    assert (scene.ended(), scene.log) == ([("early", RECALLED)], [])
    scene.goal("late", stamp=2.5)
    assert scene.shown()[-1] == ("late", ACTIVE)
    scene.goal("unstamped")
    assert scene.shown()[-1] == ("unstamped", ACTIVE)
    assert scene.ended() == [("early", RECALLED), ("late", PREEMPTED)]


def test_a_cancel_request_after_the_end_changes_nothing(scene: Scene) -> None:
    scene.goal("a")
    scene.do("server.set_succeeded()", "log.clear()")
    scene.cancel()
    scene.do("log.append(server.is_preempt_requested())")
    assert (scene.log, scene.ended()) == ([False], [("a", SUCCEEDED)])


def test_a_server_without_a_goal_ignores_set_succeeded(scene: Scene) -> None:
    scene.do("server.set_succeeded()", "log.append(server.is_active())")
    assert (scene.log, scene.results) == ([False], [])


CLIENT = """
import actionlib, rospy
from actionlib_tutorials.msg import FibonacciAction, FibonacciGoal
rospy.init_node("client")
log = []
client = actionlib.SimpleActionClient("sum", FibonacciAction)
client.send_goal(FibonacciGoal(order=3), lambda state, result: log.append(("done", state, tuple(result.sequence))),
                 lambda: log.append("active"), lambda feedback: log.append(tuple(feedback.sequence)))
first = client.get_state()
rospy.spin()
"""


def test_a_client_tracks_only_its_own_goal(start: Start) -> None:
    ros = start("")
    goals, cancels = heard(ros, "/sum/goal"), heard(ros, "/sum/cancel")
    start(CLIENT, ros=ros)
    ros.step(0.1)
    names: dict[str, Any] = ros.namespace  # type: ignore[attr-defined]
    client, (goal,) = names["client"], goals
    status: Any = message_type("actionlib_msgs/GoalStatus")
    array: Any = message_type("actionlib_msgs/GoalStatusArray")

    def tell(name: str, number: int) -> None:
        made = array()
        other = message_type("actionlib_msgs/GoalID")(Time(), "other")
        made.status_list = [
            status(other, 3, ""),
            status(goal.goal_id if name == "mine" else other, number, ""),
        ]
        ros.bus.publish("/sum/status", made)
        ros.step(0.1)

    def send(kind: str, name: str, number: int, text: str = "") -> None:
        made: Any = message_type(f"actionlib_tutorials/FibonacciAction{kind}")()
        made.status.goal_id.id = goal.goal_id.id if name == "mine" else name
        made.status.status, made.status.text = number, text
        getattr(made, kind.lower()).sequence = [number]
        ros.bus.publish(f"/sum/{kind.lower()}", made)
        ros.step(0.1)

    assert (names["first"], goal.goal.order, goal.goal_id.stamp) == (PENDING, 3, goal.header.stamp)
    tell("other", ACTIVE)
    send("Feedback", "other", 1)
    send("Result", "other", SUCCEEDED)
    assert (names["log"], client._state, client.get_result()) == ([], PENDING, None)
    tell("mine", ACTIVE)
    tell("mine", ACTIVE)
    send("Feedback", "mine", 1)
    assert (names["log"], client._state) == (["active", (1,)], ACTIVE)
    tell("mine", PREEMPTING)
    assert client._state == PREEMPTING
    tell("mine", PREEMPTED)  # the end comes with the result
    assert client._state == PREEMPTING
    send("Result", "mine", PREEMPTED, "gave way")
    send("Result", "mine", SUCCEEDED)
    assert names["log"][2:] == [("done", PREEMPTED, (PREEMPTED,))]
    assert (client.get_goal_status_text(), client._state) == ("gave way", PREEMPTED)
    tell("mine", ACTIVE)
    assert (client._state, cancels) == (PREEMPTED, [])


def test_client_cancels_one_goal_or_all_or_the_older_ones(start: Start) -> None:
    ros = start("")
    goals, cancels = heard(ros, "/sum/goal"), heard(ros, "/sum/cancel")
    start("""
import actionlib, rospy
from actionlib_tutorials.msg import FibonacciAction, FibonacciGoal
rospy.init_node("client")
client = actionlib.SimpleActionClient("sum", FibonacciAction)
states = [client.get_state(), client.wait_for_result(rospy.Duration(0.1))]
client.cancel_goal()
client.send_goal(FibonacciGoal())
client.cancel_goal()
client.cancel_all_goals()
client.cancel_goals_at_and_before_time(rospy.Time(5))
client.send_goal(FibonacciGoal())
client.stop_tracking_goal()
client.cancel_goal()
states.append(client.get_state())
""", ros=ros)  # fmt: skip
    ros.step(1.0)
    assert [(one.id, one.stamp.to_sec()) for one in cancels] == [(goals[0].goal_id.id, 0), ("", 0), ("", 5)]
    assert goals[0].goal_id.id != goals[1].goal_id.id
    assert ros.namespace["states"] == [9, False, 9]  # type: ignore[attr-defined]


def test_client_waits_for_server_and_result(start: Start) -> None:
    ros = start("""
import actionlib, rospy
from actionlib_tutorials.msg import FibonacciAction, FibonacciGoal
rospy.init_node("client")
client = actionlib.SimpleActionClient("sum", FibonacciAction)
times = [(client.wait_for_server(rospy.Duration(1.5)), rospy.get_time())]
times.append((client.wait_for_server(), rospy.get_time()))
client.send_goal(FibonacciGoal())
times.append((client.wait_for_result(rospy.Duration(1.0)), rospy.get_time()))
times.append((client.send_goal_and_wait(FibonacciGoal(), rospy.Duration(0.5), rospy.Duration(0.25)), rospy.get_time()))
""")
    ros.step(2.05)
    goals = heard(ros, "/sum/goal")
    ros.step(3.0)
    times = ros.namespace["times"]  # type: ignore[attr-defined]
    assert [found for found, _ in times] == [False, True, False, PENDING]
    assert [time for _, time in times] == pytest.approx([1.5, 2.1, 3.1, 3.85], abs=1e-6)
    assert len(goals) == 2


@pytest.mark.parametrize(
    ("body", "text"),
    [
        ("pass", "No terminal state was set."),
        ("raise ValueError('bad order')", "Exception in execute callback: bad order"),
    ],
)
def test_goal_without_a_final_state_is_aborted(start: Start, body: str, text: str) -> None:
    ros = start(f"""
        import actionlib, rospy
        from actionlib_tutorials.msg import FibonacciAction
        rospy.init_node("server")
        def execute(goal):
            {body}
        server = actionlib.SimpleActionServer("sum", FibonacciAction, execute, auto_start=False)
        server.start()
        rospy.spin()
    """)
    results = heard(ros, "/sum/result")
    message: Any = message_type("actionlib_tutorials/FibonacciActionGoal")()
    message.goal_id.id = "one"
    ros.bus.publish("/sum/goal", message)
    ros.step(0.1)
    assert [(one.status.goal_id.id, one.status.status, one.status.text) for one in results] == [
        ("one", ABORTED, text)
    ]
