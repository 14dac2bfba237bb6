"""Outcomes of smach's states decide whether the states to which they lead run."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing

HEAD = """\
import rospy, smach, smach_ros
from std_msgs.msg import Float64

out = rospy.Publisher("out", Float64, queue_size=1)
last = 0.0

def on(msg):
    global last
    last = msg.data

rospy.Subscriber("in", Float64, on)

class Test(smach.State):
    def __init__(self):
        smach.State.__init__(self, outcomes=["yes", "no"])
    def execute(self, userdata):
        return "yes" if last > 1.0 else "no"

class Same(smach.State):
    def __init__(self):
        smach.State.__init__(self, outcomes=["yes", "no"])
    def execute(self, userdata):
        return "yes"

class First(smach.State):
    def execute(self, userdata):
        out.publish(1.0)  # FIRST
        return "done"

class Second(smach.State):
    def execute(self, userdata):
        out.publish(2.0)  # SECOND
        return "done"

"""
# Programs, each below its title and the marks of the first and the second state.
PROGRAMS = """\
### one outcome ends the machine: control clean
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", Test(), {"yes": "FIRST", "no": "end"})
    smach.StateMachine.add("FIRST", First(), {"done": "end"})
Second()
### the machine has a name, and transitions a keyword: control clean
machine = smach.StateMachine(["end"])
with machine:
    smach.StateMachine.add("TEST", Test(), transitions={"yes": "FIRST", "no": "end"})
    smach.StateMachine.add("FIRST", First(), transitions={"done": "end"})
Second()
### a table of states: control clean
TABLE = [("TEST", Test, {"yes": "FIRST", "no": "end"}), ("FIRST", First, {"done": "end"})]
with smach.StateMachine(outcomes=["end"]) as machine:
    for label, state, transitions in TABLE:
        smach.StateMachine.add(label, state(), transitions=transitions)
Second()
### a table of states whose outcomes lead to the same one: clean clean
TABLE = [("TEST", Test(), {"yes": "FIRST", "no": "FIRST"})]
TABLE += [("FIRST", First(), {"done": "SECOND"}), ("SECOND", Second(), {"done": "end"})]
with smach.StateMachine(outcomes=["end"]) as machine:
    for row in TABLE:
        smach.StateMachine.add(*row)
### a dictionary of states, added to the machine itself: control control
STATES = {"TEST": Test, "FIRST": First, "SECOND": Second}
WAYS = {"TEST": {"yes": "FIRST", "no": "SECOND"}, "FIRST": {"done": "end"}, "SECOND": {"done": "end"}}
machine = smach.StateMachine(outcomes=["end"])
machine.open()
for name, make in STATES.items():
    machine.add(name, make(), transitions=WAYS[name])
machine.close()
### a helper adds the states: control clean
def add(machine, label, state, **ways):
    with machine:
        smach.StateMachine.add(label, state, transitions=ways)
machine = smach.StateMachine(outcomes=["end"])
for label, state, after in (("TEST", Test(), "FIRST"), ("FIRST", First(), "end")):
    add(machine, label, state, yes=after, done=after, no="end")
Second()
### states of a list, joined by add_auto: control clean
with smach.StateMachine(outcomes=["end"]) as machine:
    for label, state, ways in [("TEST", Test(), ["yes"]), ("FIRST", First(), ["done"])]:
        smach.StateMachine.add_auto(label, state, ways, transitions={"no": "end"})
Second()
### all outcomes lead to the state, at once or later: clean clean
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", Test(), {"yes": "FIRST", "no": "FIRST"})
    smach.StateMachine.add("FIRST", First(), {"done": "SECOND"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### the paths meet again: control clean
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", Test(), {"yes": "FIRST", "no": "SECOND"})
    smach.StateMachine.add("FIRST", First(), {"done": "SECOND"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### each outcome has its state: control control
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", Test(), {"yes": "FIRST", "no": "SECOND"})
    smach.StateMachine.add("FIRST", First(), {"done": "end"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### the state always has the same outcome: clean clean
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", Same(), {"yes": "FIRST", "no": "end"})
    smach.StateMachine.add("FIRST", First(), {"done": "SECOND"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### a loop until the other outcome: control clean
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", Test(), {"yes": "FIRST", "no": "SECOND"})
    smach.StateMachine.add("FIRST", First(), {"done": "TEST"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### the state before the test is not decided by it: clean control
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("FIRST", First(), {"done": "TEST"})
    smach.StateMachine.add("TEST", Test(), {"yes": "SECOND", "no": "end"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### a loop back makes the first state depend on the test as well: control control
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("FIRST", First(), {"done": "TEST"})
    smach.StateMachine.add("TEST", Test(), {"yes": "SECOND", "no": "end"})
    smach.StateMachine.add("SECOND", Second(), {"done": "FIRST"})
### a later state depends on the test through others: control control
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", Test(), {"yes": "FIRST", "no": "end"})
    smach.StateMachine.add("FIRST", First(), {"done": "SAME"})
    smach.StateMachine.add("SAME", Same(), {"yes": "SECOND", "no": "end"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### an outcome without a transition ends the machine: control clean
with smach.StateMachine(outcomes=["no"]) as machine:
    smach.StateMachine.add("TEST", Test(), {"yes": "FIRST"})
    smach.StateMachine.add("FIRST", First(), {"done": "no"})
Second()
### the initial state is set: clean control
machine = smach.StateMachine(outcomes=["end"])
machine.set_initial_state(["FIRST"])
with machine:
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
    smach.StateMachine.add("TEST", Test(), {"yes": "SECOND", "no": "end"})
    smach.StateMachine.add("FIRST", First(), {"done": "TEST"})
### add is a method of the machine: control clean
machine = smach.StateMachine(outcomes=["end"])
machine.add("TEST", Test(), {"yes": "FIRST", "no": "end"})
machine.add("FIRST", First(), {"done": "end"})
Second()
### a class of machines: control clean
class Ours(smach.StateMachine):
    def __init__(self):
        smach.StateMachine.__init__(self, outcomes=["end"])
        with self:
            smach.StateMachine.add("TEST", Test(), {"yes": "FIRST", "no": "end"})
            smach.StateMachine.add("FIRST", First(), {"done": "end"})
Ours().execute()
Second()
### a nested machine runs after the test: control control
inner = smach.StateMachine(outcomes=["inner_end"])
with inner:
    smach.StateMachine.add("FIRST", First(), {"done": "SECOND"})
    smach.StateMachine.add("SECOND", Second(), {"done": "inner_end"})
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", Test(), {"yes": "INNER", "no": "end"})
    smach.StateMachine.add("INNER", inner, {"inner_end": "end"})
### the outcome of a nested machine decides: control clean
inner = smach.StateMachine(outcomes=["good", "bad"])
with inner:
    smach.StateMachine.add("TEST", Test(), {"yes": "good", "no": "bad"})
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("INNER", inner, {"good": "FIRST", "bad": "SECOND"})
    smach.StateMachine.add("FIRST", First(), {"done": "SECOND"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### both outcomes of a nested machine lead to one state: clean clean
inner = smach.StateMachine(outcomes=["good", "bad"])
with inner:
    smach.StateMachine.add("TEST", Test(), {"yes": "good", "no": "bad"})
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("INNER", inner, {"good": "FIRST", "bad": "FIRST"})
    smach.StateMachine.add("FIRST", First(), {"done": "SECOND"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### a nested machine in the with of the outer one: control control
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", Test(), {"yes": "INNER", "no": "end"})
    inner = smach.StateMachine(outcomes=["inner_end"])
    with inner:
        smach.StateMachine.add("FIRST", First(), {"done": "inner_end"})
    smach.StateMachine.add("INNER", inner, {"inner_end": "SECOND"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### states of a Concurrence run together: clean clean
together = smach.Concurrence(outcomes=["good", "bad"], default_outcome="bad")
with together:
    smach.Concurrence.add("TEST", Test())
    smach.Concurrence.add("FIRST", First())
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TOGETHER", together, {"good": "SECOND", "bad": "SECOND"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### the outcome of a Concurrence decides: clean control
together = smach.Concurrence(["good", "bad"], "bad", outcome_map={"good": {"TEST": "yes"}})
with together:
    smach.Concurrence.add("TEST", Test())
    smach.Concurrence.add("FIRST", First())
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TOGETHER", together, {"good": "SECOND", "bad": "end"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### a Concurrence whose states have one outcome: clean clean
together = smach.Concurrence(["good", "bad"], "bad", outcome_map={"good": {"SAME": "yes"}})
with together:
    smach.Concurrence.add("SAME", Same())
    smach.Concurrence.add("FIRST", First())
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TOGETHER", together, {"good": "SECOND", "bad": "end"})
    smach.StateMachine.add("SECOND", Second(), {"done": "end"})
### a Concurrence after the test: control control
together = smach.Concurrence(["good"], "good")
with together:
    smach.Concurrence.add("FIRST", First())
    smach.Concurrence.add("SECOND", Second())
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", Test(), {"yes": "TOGETHER", "no": "end"})
    smach.StateMachine.add("TOGETHER", together, {"good": "end"})
### a Sequence goes on with one outcome: control clean
with smach.Sequence(outcomes=["yes", "no"], connector_outcome="yes") as machine:
    smach.Sequence.add("TEST", Test())
    smach.Sequence.add("FIRST", First())
Second()
### add_auto: control clean
with smach.StateMachine(outcomes=["no", "done"]) as machine:
    smach.StateMachine.add_auto("TEST", Test(), ["yes"])
    smach.StateMachine.add("FIRST", First())
Second()
### an Iterator whose state runs again after one outcome: control control
with smach.Iterator(outcomes=["end"], it=range(9), it_label="i") as machine:
    inner = smach.StateMachine(outcomes=["more", "enough"])
    with inner:
        smach.StateMachine.add("TEST", Test(), {"yes": "FIRST", "no": "enough"})
        smach.StateMachine.add("FIRST", First(), {"done": "SECOND"})
        smach.StateMachine.add("SECOND", Second(), {"done": "more"})
    smach.Iterator.set_contained_state("INNER", inner, loop_outcomes=["more"])
### a state made of a function: control clean
def test(userdata):
    return "yes" if last > 1.0 else "no"
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", smach.CBState(test, outcomes=["yes", "no"]), {"yes": "FIRST", "no": "end"})
    smach.StateMachine.add("FIRST", First(), {"done": "end"})
Second()
### a function that publishes: control clean
def first(userdata):
    out.publish(3.0)  # control
    return "done"
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", Test(), {"yes": "FIRST", "no": "end"})
    smach.StateMachine.add("FIRST", smach.CBState(first, outcomes=["done"]), {"done": "AGAIN"})
    smach.StateMachine.add("AGAIN", First(), {"done": "end"})
Second()
### a state that monitors a topic: control clean
def low(userdata, msg):
    userdata.seen = msg.data
    return msg.data > 1.0
with smach.StateMachine(outcomes=["end"]) as machine:
    low_state = smach_ros.MonitorState("level", Float64, low)
    smach.StateMachine.add("LOW", low_state, {"valid": "FIRST", "invalid": "end", "preempted": "end"})
    smach.StateMachine.add("FIRST", First(), {"done": "end"})
    smach.StateMachine.add("LATER", smach.CBState(lambda userdata: out.publish(userdata.seen)))  # data
Second()
### a state that monitors a topic and always ends in the same way: clean clean
with smach.StateMachine(outcomes=["end"]) as machine:
    state = smach_ros.MonitorState("level", Float64, lambda userdata, msg: msg.data > 1.0)
    smach.StateMachine.add("LOW", state, {"valid": "FIRST", "invalid": "FIRST", "preempted": "FIRST"})
    smach.StateMachine.add("FIRST", First(), {"done": "end"})
Second()
### a state that tests a condition: control clean
with smach.StateMachine(outcomes=["end"]) as machine:
    state = smach_ros.ConditionState(cond_cb=lambda userdata: last > 1.0)
    smach.StateMachine.add("LOW", state, {"true": "FIRST", "false": "end", "preempted": "end"})
    smach.StateMachine.add("FIRST", First(), {"done": "end"})
Second()
### states of other machines are not concerned: clean clean
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("TEST", Test(), {"yes": "SAME", "no": "end"})
    smach.StateMachine.add("SAME", Same(), {"yes": "end", "no": "end"})
with smach.StateMachine(outcomes=["end"]) as other:
    smach.StateMachine.add("TEST", First(), {"done": "SAME"})
    smach.StateMachine.add("SAME", Second(), {"done": "end"})
### an outcome chosen by userdata: control clean
class Fill(smach.State):
    def execute(self, userdata):
        userdata.level = last
        return "filled"
class Look(smach.State):
    def execute(self, userdata):
        if userdata.seen > 1.0:
            return "high"
        return "low"
with smach.StateMachine(outcomes=["end"]) as machine:
    smach.StateMachine.add("FILL", Fill(), {"filled": "LOOK"})
    smach.StateMachine.add("LOOK", Look(), {"high": "FIRST", "low": "end"}, remapping={"seen": "level"})
    smach.StateMachine.add("FIRST", First(), {"done": "end"})
Second()
"""


def program(head: str, part: str) -> tuple[str, str]:
    """Return the title and the text of a program with its marks."""
    title, _, body = part.partition("\n")
    title, _, marks = title.partition(": ")
    first, second = marks.split()
    return title, head.replace("FIRST\n", f"{first}\n").replace("SECOND\n", f"{second}\n") + body


CASES = dict(program(HEAD, part) for part in PROGRAMS.split("### ")[1:])


@pytest.mark.parametrize("title", CASES)
def test_outcomes_decide_whether_states_run(title: str) -> None:
    assert differing(CASES[title]) == {}
