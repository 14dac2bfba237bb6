"""actionlib's ActionServer and ActionClient, which handle several goals at a time."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.errors import NodeError
from pytest_tarl.ros import message_type
from pytest_tarl.ros.actionlib import protocol
from pytest_tarl.ros.actionlib.goal_states import CommState, steps
from pytest_tarl.ros.rospy.timing import Time
from tests.plugin.ros.conftest import Start, heard

SERVER = """
    import actionlib, rospy
    from actionlib_tutorials.msg import FibonacciAction, FibonacciFeedback, FibonacciResult

    rospy.init_node("server")
    goals, cancelled, log = {}, [], []

    def take(handle):
        goals[handle.get_goal_id().id] = handle
        if handle.get_goal().order < 0:
            handle.set_rejected(text="negative")
        elif handle.get_goal().order > 0:
            handle.set_accepted("working")

    server = actionlib.ActionServer("sum", FibonacciAction, take, cancelled.append, auto_start=False)
    server.start()
    commands = []
    while not rospy.is_shutdown():
        while commands:
            exec(commands.pop(0), globals())
        rospy.sleep(0.01)
"""
CLIENT = """
    import actionlib, rospy
    from actionlib import CommState, TerminalState
    from actionlib_tutorials.msg import FibonacciAction, FibonacciGoal

    rospy.init_node("client")
    client = actionlib.ActionClient("sum", FibonacciAction)
    log, fed = [], []
    served = client.wait_for_server(rospy.Duration(2.0))
    handles = [
        client.send_goal(
            FibonacciGoal(order),
            lambda handle: log.append((handle.get_goal_status_text(), CommState.to_string(handle.get_comm_state()))),
            lambda handle, feedback: fed.append(list(feedback.sequence)),
        )
        for order in ORDERS
    ]
    commands = []
    while not rospy.is_shutdown():
        while commands:
            exec(commands.pop(0), globals())
        rospy.sleep(0.01)
"""


class Server:
    """A server in a node that runs commands, and a world that sends goals and keeps what the server publishes."""

    def __init__(self, start: Start) -> None:
        self.ros: Any = start(SERVER)
        self.names: dict[str, Any] = self.ros.namespace
        self.results, self.states = heard(self.ros, "/sum/result"), heard(self.ros, "/sum/status")
        self.ros.step(0.05)

    def do(self, command: str) -> None:
        """Run a command in the node."""
        self.names["commands"].append(command)
        self.ros.step(0.1)

    def goal(self, name: str, order: int = 1, stamp: float = 0.0) -> None:
        """Send a goal."""
        message: Any = message_type("actionlib_tutorials/FibonacciActionGoal")()
        message.goal_id.id, message.goal_id.stamp, message.goal.order = name, Time(stamp), order
        self.ros.bus.publish("/sum/goal", message)
        self.ros.step(0.05)

    def cancel(self, name: str = "", stamp: float = 0.0) -> None:
        """Send a cancel request."""
        self.ros.bus.publish("/sum/cancel", message_type("actionlib_msgs/GoalID")(Time(stamp), name))
        self.ros.step(0.05)

    def shown(self) -> dict[str, int]:
        """Return the states of the last status message, by goal."""
        return {one.goal_id.id: one.status for one in self.states[-1].status_list}


def test_a_server_handles_several_goals_at_a_time(start: Start) -> None:
    server = Server(start)
    server.goal("a")
    server.goal("b", order=0)
    server.goal("c", order=-1)
    assert server.shown() == {"a": protocol.ACTIVE, "b": protocol.PENDING, "c": protocol.REJECTED}
    server.do(
        "goals['a'].publish_feedback(FibonacciFeedback([1, 2])); goals['a'].set_succeeded(FibonacciResult([3]))"
    )
    server.do("goals['b'].set_aborted()")  # only accepted goals can be aborted
    server.do("goals['b'].set_accepted(); goals['b'].set_aborted(text='stuck')")
    ended = [(one.status.goal_id.id, one.status.status, one.status.text) for one in server.results]
    assert ended == [("c", protocol.REJECTED, "negative"), ("a", protocol.SUCCEEDED, ""),
                     ("b", protocol.ABORTED, "stuck")]  # fmt: skip
    assert list(server.results[1].result.sequence) == [3]
    server.ros.step(6.0)
    assert server.shown() == {}


def test_cancel_request_selects_one_or_earlier_or_all_goals(start: Start) -> None:
    server = Server(start)
    server.goal("a", stamp=1.0)
    server.goal("b", order=0, stamp=2.0)
    server.goal("c", stamp=3.0)
    server.cancel("c")
    assert server.shown() == {"a": protocol.ACTIVE, "b": protocol.PENDING, "c": protocol.PREEMPTING}
    server.cancel(stamp=2.0)
    assert server.shown() == {"a": protocol.PREEMPTING, "b": protocol.RECALLING, "c": protocol.PREEMPTING}
    server.do("log += [one.get_goal_id().id for one in cancelled]\nfor one in cancelled: one.set_canceled()")
    assert server.names["log"] == ["c", "a", "b"]
    assert server.shown() == {"a": protocol.PREEMPTED, "b": protocol.RECALLED, "c": protocol.PREEMPTED}
    server.goal("late", stamp=1.5)  # sent before the last cancel request
    assert server.shown()["late"] == protocol.RECALLED
    server.goal("d", stamp=9.0)
    server.cancel()
    assert server.shown()["d"] == protocol.PREEMPTING


def test_a_client_follows_several_goals_of_a_server(start: Start) -> None:
    server = Server(start)
    client: Any = start(
        "ORDERS = (1, 0)\n" + CLIENT.replace("\n    ", "\n"), ros=server.ros, name="client.py"
    )
    names = client.namespace
    server.ros.step(0.3)
    first, second = names["handles"]
    assert names["served"]
    assert first != second
    assert (first.get_comm_state(), second.get_comm_state()) == (CommState.ACTIVE, CommState.PENDING)
    names["commands"].append("handles[1].cancel()")
    server.ros.step(0.1)
    assert second.get_comm_state() == CommState.RECALLING
    server.do("for one in goals.values(): one.publish_feedback(FibonacciFeedback([one.get_goal().order]))")
    server.do("cancelled[0].set_canceled(text='gone')\n[one for one in goals.values() if one not in cancelled][0]"
              ".set_succeeded(FibonacciResult([5]))")  # fmt: skip
    assert names["fed"] == [[1], [0]]
    assert (list(first.get_result().sequence), first.get_terminal_state()) == ([5], protocol.SUCCEEDED)
    assert second.get_terminal_state() == protocol.RECALLED
    assert names["log"] == [
        ("working", "ACTIVE"), ("", "PENDING"), ("", "WAITING_FOR_CANCEL_ACK"), ("", "RECALLING"),
        ("gone", "WAITING_FOR_RESULT"), ("gone", "DONE"), ("", "WAITING_FOR_RESULT"), ("", "DONE"),
    ]  # fmt: skip


def test_a_client_waits_no_longer_than_its_timeout(start: Start) -> None:
    ros: Any = start("ORDERS = ()\n" + CLIENT.replace("\n    ", "\n"))
    ros.step(3.0)
    assert ros.namespace["served"] is False


@pytest.mark.parametrize(
    ("state", "status", "expected"),
    [
        ("WAITING_FOR_GOAL_ACK", protocol.SUCCEEDED, ["ACTIVE", "WAITING_FOR_RESULT"]),
        ("WAITING_FOR_GOAL_ACK", protocol.RECALLED, ["PENDING", "WAITING_FOR_RESULT"]),
        ("PENDING", protocol.PREEMPTED, ["ACTIVE", "PREEMPTING", "WAITING_FOR_RESULT"]),
        ("ACTIVE", protocol.REJECTED, []),
        ("WAITING_FOR_CANCEL_ACK", protocol.ACTIVE, []),
        ("WAITING_FOR_CANCEL_ACK", protocol.ABORTED, ["PREEMPTING", "WAITING_FOR_RESULT"]),
        ("PREEMPTING", protocol.PREEMPTED, ["WAITING_FOR_RESULT"]),
        ("DONE", protocol.PREEMPTED, []),
    ],
)
def test_status_moves_the_client_through_actionlib_states(
    state: str, status: int, expected: list[str]
) -> None:
    found = steps(getattr(CommState, state), status)
    assert [CommState.to_string(one) for one in found] == expected


def test_a_class_that_is_not_an_action_is_refused(start: Start) -> None:
    with pytest.raises(NodeError, match="Type is not an action spec"):
        start("""
            import actionlib, rospy
            from std_msgs.msg import String
            rospy.init_node("n")
            actionlib.ActionClient("sum", String)
        """).step(0.1)
