"""The work of the analysis on programs, counted in statements instead of seconds."""

import ast
import gc
from collections.abc import Callable
from pathlib import Path

import pytest

from tarl_lint import engine
from tarl_lint.cli import main
from tarl_lint.flows.reachability import Tracer
from tarl_lint.interpret import fixpoint
from tarl_lint.interpret.budget import IRRELEVANT_CALL_LIMIT, MAX_GENERATIONS, PROGRAM_LIMIT
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.memory.value_flow_graph import MAX_EDGES
from tarl_lint.memory.values import Obj
from tarl_lint.read.source import Module
from tarl_lint.run.deep_stack import with_deep_stack
from tarl_lint.settings.config import Config

MOST = 2.5 * PROGRAM_LIMIT  # maximum number of statements of any program


def work(text: str, *others: str, thorough: bool = False) -> Linker:
    modules = [Module(f"tool{n}.py", f"tool{n}", t, ast.parse(t)) for n, t in enumerate(others)]
    machine = Linker(
        [*modules, Module("node.py", "node", text, ast.parse(text))], Config(), thorough=thorough
    )
    with_deep_stack(machine.link)
    return machine


def node(methods: str, subscriptions: int = 1) -> str:
    names = range(subscriptions)
    subscribed = "\n".join(
        f"        self.sub{n} = self.create_subscription(Float64, 'in{n}', self.on_{n}, 10)" for n in names
    )
    callbacks = "\n".join(f"    def on_{n}(self, msg):\n        self.step_0(msg.data)\n" for n in names)
    return f"""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

class Big(Node):
    def __init__(self):
        super().__init__("big")
        self.state = {{}}
        self.pub = self.create_publisher(Float64, "out", 10)
{subscribed}

{callbacks}
{methods}
    def send(self, x):
        self.pub.publish(Float64(data=x))

def main():
    rclpy.init()
    rclpy.spin(Big())
"""


def chain(length: int, calls: int) -> str:
    """Return methods that each call the next one several times: the number of paths grows exponentially."""
    bodies = []
    for n in range(length):
        called = "\n".join(f"        x += self.step_{n + 1}(x + {c})" for c in range(calls))
        bodies.append(f"    def step_{n}(self, x):\n{called}\n        self.f{n} = x\n        return x\n")
    return "".join(bodies) + f"    def step_{length}(self, x):\n        self.send(x)\n        return x\n"


def branches(number: int) -> str:
    """Return methods with many conditions, nested loops and handlers."""
    arms = "\n".join(
        f"        if x > {n}:\n            self.f{n} = x\n            self.state[{n}] = self.f{n - 1 if n else 0}"
        for n in range(number)
    )
    loops = "        for a in range(9):\n            for b in range(9):\n                while x > b:\n"
    loops += f"                    x -= self.f{number - 1}\n"
    return f"    def step_0(self, x):\n{arms}\n{loops}        self.send(x)\n"


PROGRAMS: dict[str, Callable[[], str]] = {
    "deep chains of helpers": lambda: node(chain(40, 2)),
    "wide chains of helpers": lambda: node(chain(8, 6)),
    "many callbacks into the same chain": lambda: node(chain(180, 1), subscriptions=10),
    "many branches": lambda: node(branches(150), subscriptions=10),
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_analysis_takes_a_bounded_number_of_statements(name):
    assert work(PROGRAMS[name]()).total < MOST


def test_work_grows_linearly_with_the_number_of_methods():
    one, two = (work(node(chain(length, 1))).total for length in (10, 20))
    assert two < 2.6 * one


def test_large_program_is_analysed_within_its_budget():
    text = node(chain(8, 6))
    (flow,) = engine.analyse([Module("node.py", "node", text, ast.parse(text))], Config())
    assert (flow.kind, flow.source.topics, flow.sink.topics) == ("explicit", ("in0",), ("out",))


def test_ignoring_sourceless_values_changes_no_flow():
    text = node(chain(4, 2), subscriptions=2)
    module = Module("node.py", "node", text, ast.parse(text))
    assert engine.trace([module], Config())[1] == engine.analyse([module], Config()) != ()


def test_incomplete_programs_are_counted(in_directory, capsys, monkeypatch):
    monkeypatch.setattr(fixpoint, "PROGRAM_LIMIT", 20_000)
    monkeypatch.setattr(fixpoint, "MAX_STATEMENTS", 5_000)
    in_directory({"node.py": node(chain(24, 6), subscriptions=30)})
    main(["--no-cache"])
    assert "Not analysed: parts of 1 large program (node.py as big)" in capsys.readouterr().out


TOOL = """
def step_60(x):
    return x
""" + "".join(
    f"""
def step_{n}(x):
    a = step_{n + 1}(x)
    return step_{n + 1}(a)
"""
    for n in range(59, -1, -1)
)
USER = """
import rospy
from tool0 import step_{start}
def on(msg):
    pub.publish(step_{start}({given}))
pub = rospy.Publisher("b", Float64)
rospy.Subscriber("a", Float64, on)
"""


def test_irrelevant_modules_without_data_have_a_small_budget():
    given, idle = (work(USER.format(start=50, given=g), TOOL).total for g in ("msg.data", "1"))
    assert idle < IRRELEVANT_CALL_LIMIT + 100 < given


def test_calls_with_data_are_followed_everywhere():
    machine = work(USER.format(start=56, given="msg.data"), TOOL)
    assert [f.kind for f in Tracer(machine).flows()] == ["explicit"]


def test_the_analysis_leaves_no_reference_cycles():
    text = (Path(__file__).parents[1] / "cases" / "containers.py").read_text()
    module = Module("node.py", "node", text, ast.parse(text))
    gc.collect()
    gc.set_debug(gc.DEBUG_SAVEALL)
    try:
        assert engine.examine([module], Config())[0]
        gc.collect()
        ours = {type(o).__name__ for o in gc.garbage if type(o).__module__.startswith("tarl_lint")}
    finally:
        gc.set_debug(0)
        gc.garbage.clear()
    assert ours == set()


RESTARTS = """
import threading
import rospy
from std_msgs.msg import Float64

class Watchdog:
    def __init__(self, topic):
        self.topic, self.last = topic, 0.0
        self.pub = rospy.Publisher(topic, Float64, queue_size=1)
        rospy.Subscriber("in", Float64, self.heard)

    def heard(self, msg):
        self.last = msg.data

    def start(self):
        threading.Thread(target=self.watch).start()

    def watch(self):
        while not rospy.is_shutdown():
            self.pub.publish(Float64(self.last))
            rospy.sleep(1.0)
            again = Watchdog(self.topic)
            again.start()

Watchdog("out").start()
"""


def test_a_thread_that_restarts_itself_terminates():
    machine = work(RESTARTS)
    flows = Tracer(machine).flows()
    assert [(f.kind, f.source.topics, f.sink.topics) for f in flows] == [("explicit", ("in",), ("out",))]
    threads = [root for root, _ in machine.roots.values() if root.kind == "thread"]
    assert 1 < len(threads) <= 1 + MAX_GENERATIONS
    assert machine.total < 1_000


def test_conditions_that_no_source_reaches_are_not_dependencies():
    text = """
import rospy, os
state = {}
def on(msg):
    pub.publish(msg.data)
def other():
    if os.environ.get("HOME") is None or len(state) > 3:
        state["a"] = 1
        x = [1, 2]
    for y in state:
        state["b"] = y
other()
pub = rospy.Publisher("b", Float64)
rospy.Subscriber("a", Float64, on)
"""
    machine = work(text)
    lines = {machine.graph.places[n].pos[0] for n in machine.graph.live}
    assert lines == {4, 5}


def test_own_stores_do_not_rerun_an_entry_point():
    text = "import rospy\nx = []\nfor i in range(3):\n    x.append([i])\nprint(x, rospy.Publisher('a', F))\n"
    assert work(text).total < 20


def callback(body: str) -> str:
    return (
        "import rospy\nfrom std_msgs.msg import Float64\n"
        "pub = rospy.Publisher('/out', Float64, queue_size=1)\n"
        f"def on_value(msg):\n    x = msg.data\n{body}    pub.publish(x)\n"
        "rospy.Subscriber('/in', Float64, on_value)\n"
    )


@pytest.mark.parametrize(
    "again", ["    if x > 1:\n        x = x + 1\n", "    for i in range(9):\n        x = x + i\n"]
)
def test_often_changed_value_has_a_bounded_number_of_edges(again):
    machine = work(callback(again * 1_500))
    assert machine.graph.edges < 1.2 * MAX_EDGES
    assert list(machine.cut) == ["node.py"]
    assert len(Tracer(machine).flows()) == 1


def test_nested_loops_take_a_bounded_number_of_passes():
    nested = "".join(f"{'    ' + ' ' * depth}for x in range(int(x)):\n" for depth in range(12))
    machine = work(callback(f"{nested}{' ' * 17}x = x + 1\n"))
    assert machine.total < MOST
    assert len(Tracer(machine).flows()) == 1


def test_an_unknown_object_has_few_nested_elements():
    deep = "".join(f"        part = (part[{n % 2}], part[i], part)[n]\n" for n in range(12))
    machine = work(callback(f"    part = load(x)\n    for i in x:\n{deep}        part.shift(i)\n"))
    widest = max(
        (len(v.pts) for v in machine.shared.ends for v in machine.shared.ends[v].values()), default=0
    )
    parts = sum(_parts(obj) for obj in machine.objects.values() if obj.kind == "lib")
    assert widest + parts < 400


def _parts(obj: Obj) -> int:
    return 1 + sum(_parts(sub) for sub in obj.subs.values() if sub is not obj)


NET = """
import lib
import layers
from std_msgs.msg import Float64
import rospy

class Net(lib.Chain):
    def __init__(self):
        super().__init__(LAYERS)

    def __call__(self, x, t=None):
BODY
        return x

def on(msg):
    pub.publish(net(msg.data))

net = Net()
lib.load("weights", net)
pub = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("in", Float64, on)
rospy.spin()
"""


def test_library_does_not_pass_an_instance_to_its_own_call():
    layers = ", ".join(f"conv{n}=lib.Conv({n})" for n in range(8))
    body = "\n".join(f"        x = self.conv{n}(x)" for n in range(8))
    machine = work(NET.replace("LAYERS", layers).replace("BODY", body))
    called = [frame for frame in machine.frames.values() if frame.function.name == "__call__"]
    assert len(called) == 2  # called by `on` and by the library


def test_exceptions_that_leave_nested_calls_do_not_multiply() -> None:
    levels = "\n".join(
        f"    def step_{n}(self, x):\n        if x > {n}:\n            self.step_{n + 1}(x)\n"
        f"        self.step_{n + 1}(x)\n"
        for n in range(5)
    )
    last = (
        "    def step_5(self, x):\n        if x > 1:\n            raise ValueError(x)\n"
        "        if x > 2:\n            raise KeyError(x)\n        self.send(x)\n"
    )
    machine = work(node(levels + last))
    escapes = {
        frame.function.name: len(frame.escapes)
        for frame in machine.frames.values()
        if frame.function.name.startswith("step_")
    }
    assert escapes == {f"step_{n}": 4 for n in range(5)} | {"step_5": 2}
