"""Nodes with state machines of smach."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.ros import message_type
from tests.plugin.ros.conftest import Start, heard

HEAD = """
import rospy, smach, smach_ros
from std_msgs.msg import Int32, String
from std_srvs.srv import SetBool, SetBoolRequest, Trigger
rospy.init_node("task")
order = []
class Step(smach.State):
    def __init__(self, name, outcomes=("done",), seconds=0.0, **keys):
        smach.State.__init__(self, outcomes=list(outcomes), **keys)
        self.name, self.seconds = name, seconds
    def execute(self, userdata):
        order.append((self.name, rospy.get_time()))
        end = rospy.get_time() + self.seconds
        while rospy.get_time() < end:
            if self.preempt_requested():
                self.service_preempt()
                return "preempted"
            rospy.sleep(0.1)
        return "done"
"""


def run(start: Start, code: str, *, seconds: float = 5.0, ros: Any = None) -> dict[str, Any]:
    """Run a node, and return its names."""
    ros = start(HEAD + code, ros=ros)
    ros.step(seconds)
    names: dict[str, Any] = ros.namespace
    return names


def test_outcomes_select_the_next_state(start: Start) -> None:
    names = run(start, """
class Count(smach.State):
    def __init__(self):
        smach.State.__init__(self, outcomes=["again", "enough"], input_keys=["before"], output_keys=["after"])
    def execute(self, userdata):
        number = userdata.before + 1
        userdata.after = number
        return "enough" if number >= 3 else "again"
sm = smach.StateMachine(outcomes=["finished"], output_keys=["number"])
sm.userdata.number = 0
with sm:
    smach.StateMachine.add("COUNT", Count(), {"again": "WAIT", "enough": "finished"},
                           remapping={"before": "number", "after": "number"})
    smach.StateMachine.add("WAIT", Step("wait", seconds=1.0), {"done": "COUNT"})
result = smach.UserData()
outcome = sm.execute(result)
""")  # fmt: skip
    assert names["outcome"] == "finished"
    assert names["result"].number == 3
    assert [name for name, _ in names["order"]] == ["wait", "wait"]


def test_a_machine_can_contain_machines_sequences_and_iterators(start: Start) -> None:
    names = run(start, """
seen = []
@smach.cb_interface(outcomes=["ok"], input_keys=["place"])
def visit(userdata):
    seen.append(userdata.place)
    return "ok"
tour = smach.Iterator(outcomes=["broken"], input_keys=[], output_keys=[], it=["a", "b"], it_label="place",
                      exhausted_outcome="all")
with tour:
    smach.Iterator.set_contained_state("VISIT", smach.CBState(visit), loop_outcomes=["ok"])
inner = smach.StateMachine(outcomes=["done"])
with inner:
    smach.StateMachine.add("TOUR", tour, {"all": "done", "broken": "done"})
outer = smach.Sequence(outcomes=["done"], connector_outcome="done")
with outer:
    smach.Sequence.add("FIRST", Step("first"))
    smach.Sequence.add("INNER", inner)
    smach.Sequence.add("LAST", Step("last"))
outcome = outer.execute()
""")  # fmt: skip
    assert (names["outcome"], names["seen"]) == ("done", ["a", "b"])
    assert [name for name, _ in names["order"]] == ["first", "last"]


def test_concurrent_states_run_together_and_may_end_each_other(start: Start) -> None:
    names = run(start, """
both = smach.Concurrence(outcomes=["first", "other"], default_outcome="other",
                         outcome_map={"first": {"QUICK": "done", "SLOW": "preempted"}},
                         child_termination_cb=lambda outcomes: outcomes["QUICK"] == "done")
with both:
    smach.Concurrence.add("SLOW", Step("slow", ["done", "preempted"], 30.0))
    smach.Concurrence.add("QUICK", Step("quick", ["done", "preempted"], 1.0))
began = rospy.get_time()
outcome = both.execute()
took = rospy.get_time() - began
""")  # fmt: skip
    assert names["outcome"] == "first"
    assert names["took"] == pytest.approx(1.1, abs=0.11)
    assert {name for name, _ in names["order"]} == {"slow", "quick"}


def test_a_request_to_end_reaches_the_running_state(start: Start) -> None:
    names = run(start, """
sm = smach.StateMachine(outcomes=["done", "preempted"])
with sm:
    smach.StateMachine.add("LONG", Step("long", ["done", "preempted"], 30.0))
rospy.Timer(rospy.Duration(2.0), lambda event: sm.request_preempt(), oneshot=True)
outcome = sm.execute()
ended, left = rospy.get_time(), sm.preempt_requested()
""")  # fmt: skip
    assert (names["outcome"], names["left"]) == ("preempted", False)
    assert names["ended"] == pytest.approx(2.1, abs=0.11)


@pytest.mark.parametrize(
    ("code", "error"),
    [
        ('sm.execute()', "'STEP':'done' leads to no state or outcome"),
        ('smach.StateMachine.add("MORE", Step("more"))', "no container is currently open"),
        ('with sm:\n    smach.StateMachine.add("STEP", Step("more"))', "'STEP', which is in use already"),
        ('with sm:\n    smach.StateMachine.add("M", Step("m"), {"typo": "end"})', "outcomes that it does not have"),
        ('Step("a").execute(smach.Remapper(smach.UserData())["x"])', "key 'x' but the only keys"),
    ],
)  # fmt: skip
def test_mistakes_in_a_state_machine_are_reported(code: str, error: str, start: Start) -> None:
    with pytest.raises(Exception, match=error):
        run(start, f'sm = smach.StateMachine(outcomes=["end"])\nwith sm:\n'
                   f'    smach.StateMachine.add("STEP", Step("step"))\n{code}')  # fmt: skip


def test_states_use_services_topics_and_actions_of_the_world(start: Start) -> None:
    ros = start("")
    light: Any = message_type("std_srvs/SetBool")
    ros.bus.serve("light", light, lambda request: light._response_class(request.data, "on"))
    states = heard(ros, "/task/smach/container_status")
    result: Any = message_type("move_base_msgs/MoveBaseActionResult")
    status: Any = message_type("actionlib_msgs/GoalStatusArray")

    def move(message: Any) -> None:
        assert message.goal.target_pose.header.frame_id == "map"
        done = result()
        done.status.goal_id, done.status.status = message.goal_id, 3
        ros.bus.publish("/move_base/result", done)

    ros.bus.subscribe("/move_base/goal", move)
    for topic, kind in (("status", status), ("result", result)):
        ros.bus.publish(f"/move_base/{topic}", kind())
    start(HEAD + """
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
target = MoveBaseGoal()
target.target_pose.header.frame_id = "map"
sm = smach.StateMachine(outcomes=["end", "trouble"])
with sm:
    smach.StateMachine.add("LIGHT", smach_ros.ServiceState("light", SetBool, SetBoolRequest(data=True),
                           response_slots=["message"]),
                           {"succeeded": "MOVE", "aborted": "trouble", "preempted": "trouble"})
    smach.StateMachine.add("MOVE", smach_ros.SimpleActionState("move_base", MoveBaseAction, goal=target),
                           {"succeeded": "WATCH", "aborted": "trouble", "preempted": "trouble"})
    smach.StateMachine.add("WATCH", smach_ros.MonitorState("level", Int32, lambda userdata, message: message.data < 5),
                           {"valid": "trouble", "invalid": "end", "preempted": "trouble"})
server = smach_ros.IntrospectionServer("task", sm, "/ROOT")
server.start()
outcome = sm.execute()
""", ros=ros)  # fmt: skip
    for level in range(8):
        ros.step(1.0)
        ros.bus.publish("/level", message_type("std_msgs/Int32")(data=level))
    ros.step(1.0)
    names: dict[str, Any] = ros.namespace  # type: ignore[attr-defined]
    assert names["outcome"] == "end"
    assert names["sm"].userdata.message == "on"
    active = [one.active_states[0] for one in states]
    assert [label for place, label in enumerate(active) if label not in active[:place]][-3:] == [
        "LIGHT",
        "MOVE",
        "WATCH",
    ]


def test_a_container_serves_an_action(start: Start) -> None:
    ros = start("")
    results = heard(ros, "/visit/result")
    start(HEAD + """
from move_base_msgs.msg import MoveBaseAction
sm = smach.StateMachine(outcomes=["done"], input_keys=["goal"])
with sm:
    smach.StateMachine.add("STEP", Step("step", seconds=1.0))
smach_ros.ActionServerWrapper("visit", MoveBaseAction, sm, succeeded_outcomes=["done"], goal_key="goal").run_server()
rospy.spin()
""", ros=ros)  # fmt: skip
    ros.step(0.5)
    ros.bus.publish("/visit/goal", message_type("move_base_msgs/MoveBaseActionGoal")())
    ros.step(3.0)
    assert [message.status.status for message in results] == [3]
