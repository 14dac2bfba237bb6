"""Every kind of callable, passed to a library in every way: its data reaches the result, other data does not."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.lint.analysing import analysed

NODE = """
import functools
import rospy
import lib
from std_msgs.msg import Float64


class Functor:
    def __init__(self, node):
        self.node = node

    def __call__(self, u):
        return u - self.node.seen


class Node:
    def __init__(self):
        self.seen = self.other = 0.0
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("seen", Float64, self.on_seen)
        rospy.Subscriber("other", Float64, self.on_other)
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_seen(self, msg):
        self.seen = msg.data

    def on_other(self, msg):
        self.other = msg.data

    def cost(self, u):
        return u - self.seen

    def scaled(self, scale, u):
        return scale * (u - self.seen)

    def steps(self, u):
        yield self.seen
        yield u

    def idle(self, u):
        return u

    def note(self, u):
        self.last = self.seen

    def tick(self, event):
        def inner(u):
            return u - self.seen

        given = {callable}
        {handed}
        self.out.publish(found)


Node()
rospy.spin()
"""
CARRYING = [
    "self.cost",
    "inner",
    "lambda u: u - self.seen",
    "functools.partial(self.scaled, 2.0)",
    "functools.partial(self.scaled, scale=2.0)",
    "Functor(self)",
    "self.steps",
    "self.cost if event else self.cost",
]
SILENT = ["self.idle", "lambda u: u", "self.note", "print", "None"]
WAYS = [
    "found = lib.solve(given, 0.0)",
    "found = lib.solve(start=0.0, function=given)",
    "found = lib.solve(0.0, [given, given])",
    "found = lib.solve(0.0, bounds=({'fun': given},))",
    "found = lib.Solver(given).run(0.0)",
    "solver = lib.Solver()\n        solver.set_function(given)\n        found = solver.run(0.0)",
    "solver = lib.Solver(function=given)\n        solver.solve()\n        found = solver.best",
    "found = list(lib.pool().map(given, [1.0, 2.0]))[0]",
    "found = lib.compiled(given)(1.0)",
    "found = lib.start(given, 0.0).result()",
]


@settings(max_examples=40)
@given(function=st.sampled_from(CARRYING + SILENT), handed=st.sampled_from(WAYS))
def test_library_result_includes_the_result_of_a_callable_argument(tmp_path_factory, function, handed):
    directory = tmp_path_factory.mktemp("node")
    text = NODE.replace("{callable}", function).replace("{handed}", handed)
    found = {(f.source.topics, f.kind) for f in analysed(directory, node=text).flows}
    assert found == ({(("seen",), "explicit")} if function in CARRYING else set())


@pytest.mark.parametrize("handed", [way for way in WAYS if "0.0" in way])
def test_library_may_pass_arguments_to_a_callable_argument(tmp_path, handed):
    text = NODE.replace("{callable}", "self.idle").replace("{handed}", handed.replace("0.0", "self.other"))
    assert {f.source.topics for f in analysed(tmp_path, node=text).flows} == {("other",)}
