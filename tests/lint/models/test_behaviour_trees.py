"""Behaviours of py_trees share a blackboard, and the status of a behaviour decides whether others run."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing
from tests.lint.models.test_state_machines import program

HEAD = """\
import operator, py_trees, rospy
from py_trees.common import Access, Status
from std_msgs.msg import Float64

out = rospy.Publisher("out", Float64, queue_size=1)
last = 0.0

def on(msg):
    global last
    last = msg.data

rospy.Subscriber("in", Float64, on)

class Test(py_trees.behaviour.Behaviour):
    def update(self):
        return Status.SUCCESS if last > 1.0 else Status.FAILURE

class Same(py_trees.behaviour.Behaviour):
    def update(self):
        return py_trees.common.Status.SUCCESS

class First(py_trees.behaviour.Behaviour):
    def update(self):
        out.publish(1.0)  # FIRST
        return Status.SUCCESS

class Second(py_trees.behaviour.Behaviour):
    def update(self):
        out.publish(2.0)  # SECOND
        return Status.SUCCESS

"""
# Programs, each below its title and the marks of the first and the second behaviour.
PROGRAMS = """\
### later children of a Sequence: clean control
root = py_trees.composites.Sequence("root", False, children=[First(), Test(), Second()])
### children by add_child: clean control
root = py_trees.composites.Sequence("root", memory=True)
root.add_child(First("first"))
root.add_child(Test("test"))
root.add_child(Second("second"))
### children by add_children, of a Selector: clean control
root = py_trees.composites.Selector(name="root", memory=False)
root.add_children([First(), py_trees.decorators.Inverter("not", Same()), Test(), Second()])
### children by a loop over classes: clean control
root = py_trees.composites.Sequence("root", memory=True)
for make in (First, Test, Second):
    root.add_child(make("child"))
### children by a comprehension over classes: clean control
root = py_trees.composites.Sequence("root", memory=True, children=[make("child") for make in (First, Test, Second)])
### children by a loop over instances that always have the same status: clean clean
root = py_trees.composites.Sequence("root", memory=True)
for child in [First("first"), Same("test"), Second("second")]:
    root.add_child(child)
### a prepended child: control clean
root = py_trees.composites.Sequence("root", memory=False)
root.add_child(First())
root.prepend_child(Test())
Second()
### a status that is always the same: clean clean
root = py_trees.composites.Sequence("root", memory=False, children=[Same(), First(), Second()])
### a Selector ends with the first success: clean clean
root = py_trees.composites.Selector("root", memory=False, children=[Test(), Same()])
First(), Second()
### Parallel decides nothing among its children: clean clean
root = py_trees.composites.Parallel("root", py_trees.common.ParallelPolicy.SuccessOnAll())
root.add_children([Test(), First(), Second()])
### Parallel in a Sequence: clean control
both = py_trees.composites.Parallel("both", children=[Test(), First()])
root = py_trees.composites.Sequence("root", memory=False, children=[both, Second()])
### Parallel after a test: control control
both = py_trees.composites.Parallel("both", children=[First(), Second()])
root = py_trees.composites.Sequence("root", memory=False, children=[Test(), both])
### an inverted status: clean control
root = py_trees.composites.Sequence("root", memory=False)
root.add_children([First(), py_trees.decorators.Inverter(name="not", child=Test()), Second()])
### a status that a decorator makes a success: clean clean
root = py_trees.composites.Sequence("root", memory=False)
root.add_children([First(), py_trees.decorators.FailureIsSuccess("ever", Test()), Second()])
### a decorator around what the test decides: control control
root = py_trees.composites.Sequence("root", memory=False)
inner = py_trees.composites.Sequence("inner", memory=True, children=[First(), Second()])
root.add_children([Test(), py_trees.decorators.Timeout(name="t", child=inner, duration=1.0)])
### nested composites: control control
inner = py_trees.composites.Sequence("inner", memory=False, children=[Test(), First()])
root = py_trees.composites.Selector("root", memory=False, children=[inner, Second()])
### both ways of a nested Selector go on: control clean
inner = py_trees.composites.Sequence("inner", memory=False, children=[Test(), First()])
either = py_trees.composites.Selector("either", memory=False, children=[inner, Same()])
root = py_trees.composites.Sequence("root", memory=False, children=[either, Second()])
### a behaviour that is always running ends the Sequence: clean control
waiting = py_trees.composites.Sequence("waiting", memory=False, children=[py_trees.behaviours.Running("wait")])
calm = py_trees.composites.Selector("calm", memory=False, children=[Test(), waiting])
root = py_trees.composites.Sequence("root", memory=False, children=[First(), calm, Second()])
### another tree is not concerned: clean clean
root = py_trees.composites.Sequence("root", memory=False, children=[Test(), Same()])
other = py_trees.composites.Sequence("other", memory=False, children=[First(), Second()])
### a class of composites: clean control
class Ours(py_trees.composites.Sequence):
    def __init__(self):
        super().__init__("ours", False)
        self.add_children([First(), Test()])
        self.add_child(Second())
Ours()
### a class that passes its children to its base: clean control
class Ours(py_trees.composites.Sequence):
    def __init__(self, children):
        super().__init__("ours", memory=False, children=children)
Ours([First(), Test(), Second()])
### a function that makes a tree: clean control
def made(test):
    root = py_trees.composites.Sequence("root", memory=False)
    root.add_children([First(), test, Second()])
    return root
made(Test())
### initialise and terminate: control clean
class Third(py_trees.behaviour.Behaviour):
    def initialise(self):
        out.publish(3.0)  # control
    def update(self):
        return Status.SUCCESS if last > 2.0 else Status.RUNNING
    def terminate(self, new_status):
        out.publish(4.0)  # control
    def setup(self, **kwargs):
        out.publish(5.0)  # clean
root = py_trees.composites.Sequence("root", memory=False, children=[Test(), First(), Third()])
Second()
### terminate depends on the status: clean clean
class Third(py_trees.behaviour.Behaviour):
    def update(self):
        return Status.SUCCESS if last > 2.0 else Status.RUNNING
    def terminate(self, new_status):
        out.publish(4.0)  # control
root = py_trees.composites.Sequence("root", memory=False, children=[First(), Third()])
Second()
### two clients of the blackboard share a key: clean clean
class Write(py_trees.behaviour.Behaviour):
    def __init__(self):
        super().__init__("write")
        self.blackboard = self.attach_blackboard_client(name="write")
        self.blackboard.register_key(key="level", access=Access.WRITE)
    def update(self):
        self.blackboard.level = last
        self.blackboard.set("set", last)
        self.blackboard.zero = 0.0
        return Status.SUCCESS
class Read(py_trees.behaviour.Behaviour):
    def __init__(self):
        super().__init__("read")
        self.board = py_trees.blackboard.Client(name="read")
        self.board.register_key("level", py_trees.common.Access.READ)
    def update(self):
        out.publish(self.board.level)  # data
        out.publish(self.board.get("set"))  # data
        out.publish(self.board.zero)  # clean
        out.publish(py_trees.blackboard.Blackboard.get("level"))  # data
        out.publish(py_trees.blackboard.Blackboard.get("/zero"))  # clean
        return Status.SUCCESS
Write(), Read(), First(), Second()
### namespaces tell keys apart: clean clean
near = py_trees.blackboard.Client(name="near", namespace="near")
far = py_trees.blackboard.Client(name="far", namespace="/far/")
root = py_trees.blackboard.Client(name="root")
def store(event):
    near.level = last
    far.level = 0.0
def step(event):
    out.publish(near.level)  # data
    out.publish(far.level)  # clean
    out.publish(root.get("near/level"))  # data
    out.publish(root.get("/far/level"))  # clean
    out.publish(far.get("/near/level"))  # data
    out.publish(py_trees.blackboard.Blackboard.get("/near/level"))  # data
rospy.Timer(1, store), rospy.Timer(1, step), First(), Second()
### a key under another name: clean clean
one = py_trees.blackboard.Client(name="one")
one.register_key(key="mine", access=Access.READ, remap_to="/shared/level")
def store(event):
    py_trees.blackboard.Blackboard.set("shared/level", last)
    py_trees.blackboard.Blackboard.set("mine", 0.0)
def step(event):
    out.publish(one.mine)  # data
    out.publish(py_trees.blackboard.Blackboard.get("mine"))  # clean
rospy.Timer(1, store), rospy.Timer(1, step), First(), Second()
### a part of a value: clean clean
one, two = py_trees.blackboard.Client(name="one"), py_trees.blackboard.Client(name="two")
class Pose:
    x = y = 0.0
def store(event):
    one.pose = Pose()
    one.set("pose.x", last)
def step(event):
    out.publish(two.get("pose.x"))  # data
    out.publish(two.get("pose.y"))  # clean
    out.publish(two.pose.x)  # data
rospy.Timer(1, store), rospy.Timer(1, step), First(), Second()
### the blackboard of older versions: clean clean
board = py_trees.blackboard.Blackboard()
def store(event):
    board.level = last
    board.set("other", 0.0)
def step(event):
    other = py_trees.blackboard.Blackboard()
    out.publish(other.get("level"))  # data
    out.publish(other.other)  # clean
rospy.Timer(1, store), rospy.Timer(1, step), First(), Second()
### a check of the blackboard: clean control
def store(event):
    py_trees.blackboard.Blackboard.set("level", last)
rospy.Timer(1, store)
check = py_trees.behaviours.CheckBlackboardVariableValue(
    name="check", check=py_trees.common.ComparisonExpression(variable="level", value=1.0, operator=operator.gt))
root = py_trees.composites.Sequence("root", memory=False, children=[First(), check, Second()])
### more behaviours of a class than run one by one: clean control
root = py_trees.composites.Sequence("root", memory=False)
root.add_children([Same(), Same(), Same(), Same(), Same(), Same(), Same(), Same(), First()])
tests = py_trees.composites.Sequence("tests", memory=False)
tests.add_children([Test(), Test(), Test(), Test(), Test(), Test(), Test()])
last_test = Test()
other = py_trees.composites.Sequence("other", memory=False, children=[last_test, Second()])
### a check of another key: clean clean
def store(event):
    py_trees.blackboard.Blackboard.set("level", last)
    py_trees.blackboard.Blackboard.set("other", 1.0)
rospy.Timer(1, store)
check = py_trees.behaviours.CheckBlackboardVariableValue(
    "check", py_trees.common.ComparisonExpression("other", 1.0, operator.gt))
root = py_trees.composites.Sequence("root", memory=False, children=[First(), check, Second()])
### a behaviour that reads the blackboard decides: clean control
class Check(py_trees.behaviour.Behaviour):
    def __init__(self, key):
        super().__init__("check")
        self.key, self.board = key, self.attach_blackboard_client()
    def update(self):
        if self.board.get(self.key) < 1.0:
            return Status.FAILURE
        return Status.SUCCESS
def store(event):
    py_trees.blackboard.Blackboard.set("level", last)
    py_trees.blackboard.Blackboard.set("other", 1.0)
rospy.Timer(1, store)
root = py_trees.composites.Sequence("root", memory=False)
root.add_children([Check("other"), First(), Check("level"), Second()])
"""
CASES = dict(program(HEAD, part) for part in PROGRAMS.split("### ")[1:])


@pytest.mark.parametrize("title", CASES)
def test_behaviour_status_decides_what_runs_next(
    title: str,
) -> None:
    assert differing(CASES[title]) == {}
