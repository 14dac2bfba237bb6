"""What the states of smach_ros send, store and return, and when."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.ros import Ros, message_type
from tests.plugin.ros.conftest import Start, heard
from tests.plugin.ros.test_smach import HEAD

MOVE = """
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
def goal_to(frame):
    made = MoveBaseGoal()
    made.target_pose.header.frame_id = frame
    return made
userdata = smach.UserData()
def run(**options):
    state = smach_ros.SimpleActionState("move_base", MoveBaseAction, **options)
    rospy.Timer(rospy.Duration(2.0), lambda event: state.request_preempt(), oneshot=True) if preempt else None
    return state, state.execute(userdata)
preempt = False
"""


class Mover:
    """An action server in the world."""

    def __init__(self, ros: Ros) -> None:
        self.ros, self.goals = ros, heard(ros, "/move_base/goal")
        self.cancelled = heard(ros, "/move_base/cancel")
        self.result: Any = message_type("move_base_msgs/MoveBaseActionResult")
        for topic, kind in (
            ("status", message_type("actionlib_msgs/GoalStatusArray")),
            ("result", self.result),
        ):
            ros.bus.publish(f"/move_base/{topic}", kind())

    def end(self, status: int) -> None:
        """End the last goal."""
        done = self.result()
        done.status.goal_id, done.status.status = self.goals[-1].goal_id, status
        self.ros.bus.publish("/move_base/result", done)

    def frames(self) -> list[str]:
        """Return the frames of the goals."""
        return [goal.goal.target_pose.header.frame_id for goal in self.goals]


def acted(start: Start, code: str, status: int | None = 3, seconds: float = 1.0) -> tuple[Any, Mover]:
    """Run a node with an action state; the world ends the goal with `status` after `seconds`, or never for None."""
    ros = start("")
    mover = Mover(ros)
    start(HEAD + MOVE + code, ros=ros)
    ros.step(seconds)
    if status is not None:
        mover.end(status)
    ros.step(1.0)
    return ros.namespace, mover  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("code", "frame"),
    [
        ('_, outcome = run(goal=goal_to("map"))', "map"),
        ('userdata.place = goal_to("odom")\nstate, outcome = run(goal_key="place")', "odom"),
        ('_, outcome = run(goal=lambda userdata, goal: goal_to("base"))', "base"),
        (('_, outcome = run(goal=goal_to("map"), goal_cb=lambda userdata, goal, *a, **k: goal_to(a[0] + k["b"]),'
         ' goal_cb_args=["x"], goal_cb_kwargs={"b": "y"})'), "xy"),
        ('_, outcome = run(goal=goal_to("kept"), goal_cb=lambda userdata, goal: None)', "kept"),
        ('userdata.target_pose = goal_to("slot").target_pose\n_, outcome = run(goal_slots=["target_pose"])', "slot"),
        ('_, outcome = run()', ""),
    ],
)  # fmt: skip
def test_goal_comes_from_argument_userdata_or_function(start: Start, code: str, frame: str) -> None:
    names, mover = acted(start, code)
    assert (mover.frames(), names["outcome"]) == ([frame], "succeeded")


@pytest.mark.parametrize(
    ("status", "outcome"), [(3, "succeeded"), (4, "aborted"), (2, "aborted"), (5, "aborted")]
)
def test_goal_status_determines_the_outcome(start: Start, status: int, outcome: str) -> None:
    names, mover = acted(start, "_, outcome = run()", status)
    assert (names["outcome"], mover.cancelled) == (outcome, [])


@pytest.mark.parametrize(
    ("chosen", "outcome"), [('"far"', "far"), ("None", "succeeded"), ('"typo"', "succeeded")]
)
def test_a_result_callback_may_choose_an_outcome(start: Start, chosen: str, outcome: str) -> None:
    names, _ = acted(start, f"""
seen = []
def choose(userdata, status, result, *args, **kwargs):
    seen.append((status, type(result).__name__, args, kwargs))
    return {chosen}
_, outcome = run(outcomes=["far"], result_cb=choose, result_cb_args=[1], result_cb_kwargs={{"a": 2}})
""")  # fmt: skip
    assert (names["outcome"], names["seen"]) == (outcome, [(3, "MoveBaseResult", (1,), {"a": 2})])


def test_results_are_stored_in_userdata(start: Start) -> None:
    names, _ = acted(start, '_, outcome = run(result_key="arrival")')
    assert type(names["userdata"].arrival).__name__ == "MoveBaseResult"


def test_slot_keys_are_state_keys(start: Start) -> None:
    names = start(
        HEAD
        + MOVE
        + """
@smach.cb_interface(input_keys=["speed"], output_keys=["time"], outcomes=["late"])
def choose(userdata, status, result): pass
both = smach_ros.SimpleActionState("move_base", MoveBaseAction, goal_key="goal", goal_slots=["target_pose"],
                                   result_key="arrival", result_slots=["x"], result_cb=choose, input_keys=["more"])
neither = smach_ros.SimpleActionState("move_base", MoveBaseAction)
keys = [sorted(one.get_registered_input_keys()) + sorted(one.get_registered_output_keys()) for one in (both, neither)]
outcomes = sorted(both.get_registered_outcomes())
service = smach_ros.ServiceState("light", SetBool, request_key="order", request_slots=["data"], response_key="answer",
                                 response_slots=["message"])
served = sorted(service.get_registered_input_keys()) + sorted(service.get_registered_output_keys())
plain = smach_ros.ServiceState("light", SetBool)
none = sorted(plain.get_registered_input_keys()) + sorted(plain.get_registered_output_keys())
"""
    ).namespace  # type: ignore[attr-defined]
    assert names["keys"] == [["goal", "more", "speed", "target_pose", "arrival", "time", "x"], []]
    assert names["outcomes"] == ["aborted", "late", "preempted", "succeeded"]
    assert (names["served"], names["none"]) == (["data", "order", "answer", "message"], [])


def test_a_request_to_end_cancels_the_goal(start: Start) -> None:
    names, mover = acted(start, "preempt = True\nstate, outcome = run()", status=2, seconds=3.0)
    assert (names["outcome"], [goal.id for goal in mover.cancelled]) == (
        "preempted", [mover.goals[0].goal_id.id]
    )  # fmt: skip
    assert not names["state"].preempt_requested()


def test_late_success_is_a_success(start: Start) -> None:
    names, _ = acted(start, "preempt = True\nstate, outcome = run()", status=3, seconds=3.0)
    assert names["outcome"] == "succeeded"


def test_preempted_state_sends_no_goal(start: Start) -> None:
    names, mover = acted(start, """
state = smach_ros.SimpleActionState("move_base", MoveBaseAction)
state.request_preempt()
outcomes = [state.execute(userdata)]
condition = smach_ros.ConditionState(lambda userdata: True)
condition.request_preempt()
outcomes.append(condition.execute(userdata))
monitor = smach_ros.MonitorState("level", Int32, lambda userdata, message: False)
monitor.request_preempt()
outcomes.append(monitor.execute(userdata))
service = smach_ros.ServiceState("nothing", Trigger)
service.request_preempt()
outcomes.append(service.execute(userdata))
left = [one.preempt_requested() for one in (state, condition, monitor, service)]
""", status=None)  # fmt: skip
    assert (names["outcomes"], mover.goals) == (["preempted"] * 4, [])
    assert names["left"] == [False] * 4


def test_unfinished_goal_is_cancelled_and_then_abandoned(start: Start) -> None:
    names, mover = acted(start, """
began = rospy.get_time()
_, outcome = run(exec_timeout=rospy.Duration(1.0), cancel_timeout=rospy.Duration(2.0))
took = rospy.get_time() - began
""", status=None, seconds=6.0)  # fmt: skip
    assert (names["outcome"], len(mover.cancelled)) == ("aborted", 1)
    assert 3.0 < names["took"] < 3.5


def test_action_without_a_server_is_aborted(start: Start) -> None:
    ros = start(HEAD + MOVE + """
_, outcome = run(server_wait_timeout=rospy.Duration(2.0))
ended = rospy.get_time()
""")  # fmt: skip
    ros.step(5.0)
    names = ros.namespace  # type: ignore[attr-defined]
    assert names["outcome"] == "aborted"
    assert 2.0 <= names["ended"] < 2.2


SERVED = """
def handle(request):
    if not request.data:
        raise ValueError("no light")
    return SetBoolResponse(success=True, message="on")
from std_srvs.srv import SetBoolResponse
"""


@pytest.mark.parametrize(
    ("code", "outcome"),
    [
        ("request=SetBoolRequest(data=True)", "succeeded"),
        ("", "aborted"),  # an empty request has data=False
        ("request=lambda userdata, request: SetBoolRequest(data=True)", "succeeded"),
        ("request_key='order'", "succeeded"),
        ("request_slots=['data']", "succeeded"),
        (("request_cb=lambda userdata, request, a, b: SetBoolRequest(data=a and b), request_cb_args=[True],"
         " request_cb_kwargs={'b': True}"), "succeeded"),
        (("request_key='order', response_cb=lambda userdata, response, a, b: a + b, response_cb_args=['bri'],"
         " response_cb_kwargs={'b': 'ght'}, outcomes=['bright']"), "bright"),
        ("request_key='order', response_cb=lambda userdata, response: 'typo'", "succeeded"),
        ("request_key='order', response_cb=lambda userdata, response: None", "succeeded"),
    ],
)  # fmt: skip
def test_service_callback_may_choose_the_outcome(start: Start, code: str, outcome: str) -> None:
    ros = start("")
    start("import rospy\nfrom std_srvs.srv import SetBool\n" + SERVED + """
rospy.init_node("lamp")
rospy.Service("light", SetBool, handle)
rospy.spin()
""", ros=ros)  # fmt: skip
    start(HEAD + f"""
userdata = smach.UserData()
userdata.order, userdata.data = SetBoolRequest(data=True), True
state = smach_ros.ServiceState("light", SetBool, {code})
outcome = state.execute(userdata)
""", ros=ros)  # fmt: skip
    ros.step(3.0)
    assert ros.namespace["outcome"] == outcome  # type: ignore[attr-defined]


def test_responses_are_stored_in_userdata(start: Start) -> None:
    ros = start("")
    light: Any = message_type("std_srvs/SetBool")
    ros.bus.serve("light", light, lambda request: light._response_class(True, "on"))
    start(HEAD + """
userdata = smach.UserData()
smach_ros.ServiceState("light", SetBool, response_key="whole", response_slots=["message", "success"]).execute(userdata)
""", ros=ros)  # fmt: skip
    ros.step(1.0)
    userdata = ros.namespace["userdata"]  # type: ignore[attr-defined]
    assert (userdata.whole.message, userdata.message, userdata.success) == ("on", "on", True)


@pytest.mark.parametrize(
    ("options", "outcome", "calls"),
    [
        ("", "false", 2),  # smach_ros checks once more than max_checks
        ("max_checks=3", "false", 4),
        ("max_checks=-1, timeout=rospy.Duration(1.0), poll_rate=rospy.Duration(0.3)", "false", 4),
        ("max_checks=-1, timeout=rospy.Duration(0)", "true", 7),
        ("max_checks=6", "true", 7),
    ],
)
def test_condition_is_checked_up_to_a_limit(start: Start, options: str, outcome: str, calls: int) -> None:
    ros = start(HEAD + f"""
calls = []
def check(userdata):
    calls.append(rospy.get_time())
    return len(calls) == 7
outcome = smach_ros.ConditionState(check, {options}).execute(smach.UserData())
""")  # fmt: skip
    ros.step(3.0)
    names = ros.namespace  # type: ignore[attr-defined]
    assert (names["outcome"], len(names["calls"])) == (outcome, calls)
    pause = 0.3 if "poll_rate" in options else 0.05
    assert names["calls"][1] - names["calls"][0] == pytest.approx(pause, abs=1e-6)


@pytest.mark.parametrize(
    ("most", "levels", "outcome", "checked"),
    [
        (-1, [1, 2, 9, 3], "invalid", [1, 2, 9]),
        (2, [1, 2, 3], "valid", [1]),  # the last message ends the state unchecked
        (3, [1, 9, 3], "invalid", [1, 9]),
        (-1, [1, 2], "preempted", [1, 2]),
    ],
)
def test_topic_is_watched_until_a_message_is_invalid(
    start: Start, most: int, levels: list[int], outcome: str, checked: list[int]
) -> None:
    ros = start(HEAD + f"""
checked = []
def check(userdata, message):
    checked.append(message.data)
    return message.data < 5
state = smach_ros.MonitorState("level", Int32, check, max_checks={most})
rospy.Timer(rospy.Duration(4.5), lambda event: state.request_preempt(), oneshot=True)
outcome = state.execute(smach.UserData())
ended = rospy.get_time()
""")  # fmt: skip
    for level in levels:
        ros.step(1.0)
        ros.bus.publish("/level", message_type("std_msgs/Int32")(data=level))
    ros.step(5.0 - len(levels))
    names = ros.namespace  # type: ignore[attr-defined]
    assert (names["outcome"], names["checked"]) == (outcome, checked)
