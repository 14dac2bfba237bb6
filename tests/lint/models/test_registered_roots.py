"""The conditions under which a program registers a callback, a timer or a thread decide whether it runs."""

from __future__ import annotations

import ast

import pytest

from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.shared import Root
from tarl_lint.memory.store import Store
from tarl_lint.memory.value_flow_graph import Place
from tarl_lint.models.ros import registered_roots
from tarl_lint.read.source import Module
from tarl_lint.settings.config import Config
from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import library, rospy, threading
from concurrent.futures import ThreadPoolExecutor
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
pool, client = ThreadPoolExecutor(), library.client()
kept = {}
def later(*given):
    out.publish(1.0)  # MARK
"""
# how a program registers `later` in a callback or at its start; the mark at its publish call
BODIES = """\
### scan:control: a timer
def scan(msg):
    if msg.data > 1.0:
        rospy.Timer(rospy.Duration(1.0), later, oneshot=True)
### scan:control: a thread
def scan(msg):
    if msg.data > 1.0:
        threading.Thread(target=later).start()
### scan:control: another topic
def scan(msg):
    if msg.data > 1.0:
        rospy.Subscriber("pose", Float64, later)
### scan:control: the answer to a request that is not always sent
def scan(msg):
    if msg.data < 1.0:
        return
    kept["future"] = client.call_async(3.0)
    kept["future"].add_done_callback(later)
### scan:control: work in another thread
def scan(msg):
    if msg.data > 1.0:
        pool.submit(len, []).add_done_callback(later)
### scan:control: in a called function
def start():
    threading.Thread(target=later).start()
def scan(msg):
    if msg.data > 1.0:
        start()
### scan:control: a timer in a callback that is registered itself
def begin(msg):
    rospy.Timer(rospy.Duration(1.0), later, oneshot=True)
def scan(msg):
    if msg.data > 1.0:
        rospy.Subscriber("pose", Float64, begin)
### scan:control other:control: at two places
def scan(msg):
    if msg.data > 1.0:
        threading.Thread(target=later).start()
def other(msg):
    if msg.data > 1.0:
        threading.Thread(target=later).start()
rospy.Subscriber("other", Float64, other)
### scan:control: a second timer, as with a second call of the function
def scan(msg):
    if msg.data > 1.0:
        kept["timer"] = rospy.Timer(rospy.Duration(1.0), later)
kept["timer"] = rospy.Timer(rospy.Duration(1.0), later)
### scan:control: a timer that starts itself again through another one
def again():
    threading.Timer(1.0, later).start()
    threading.Timer(1.0, again).start()
def scan(msg):
    if msg.data > 1.0:
        threading.Timer(1.0, again).start()
### clean: a timer that starts itself again, and is also started at the beginning
def again():
    threading.Timer(1.0, later).start()
    threading.Timer(1.0, again).start()
def start():
    threading.Timer(1.0, again).start()
def scan(msg):
    if msg.data > 1.0:
        start()
start()
### clean: with each message
def scan(msg):
    if "thread" not in kept:
        kept["thread"] = threading.Thread(target=later)
        kept["thread"].start()
### clean: by a parameter
def scan(msg):
    if rospy.get_param("~later", True):
        threading.Thread(target=later).start()
"""
CASES = sections(BODIES)


@pytest.mark.parametrize("title", CASES)
def test_a_root_runs_only_if_it_is_registered(title):
    text = HEAD.replace("MARK", title.partition(": ")[0]) + CASES[title]
    assert differing_topics(f'{text}rospy.Subscriber("scan", Float64, scan)\nrospy.spin()\n') == {}


def registering(orders):
    """Return the decisions of a root that one statement registers in two ways, for each order of the ways."""
    found = []
    for order in orders:
        text = "start(), later\n"
        ctx = Linker([Module("node.py", "node", text, ast.parse(text))], Config())
        ctx.store = Store(ctx.shared, Root("test", "test"))
        (program,) = ctx.programs.values()
        frame = Frame("frame", 1, program.function, program, ctx.module_objects[program.name])
        frame.statement = program.function.body[0]
        ctx.stack.append(frame)
        decisions = {
            name: ctx.graph.node(name, Place(frame, None, "condition", (0, 0, 0, 0)), frozenset())
            for name in ("live", "other", "unreached")
        }
        ctx.graph.begin(decisions["live"])
        ctx.graph.begin(decisions["other"])
        for names in order:
            ctx.guards = [(decisions[name], "rest") for name in names]
            registered_roots.note(ctx, "later")
        registered_roots.connect(ctx)
        ways = ctx.graph.control[ctx.registered["later"].node]
        found.append(
            {name for name, node in decisions.items() if any(node in ctx.graph.control[w] for w in ways)}
        )
    return found


@pytest.mark.parametrize(
    ("ways", "decides"),
    [
        ([(), ("live",)], set()),
        ([("unreached",), ("live",)], set()),
        ([("other",), ("live",)], {"live", "other"}),
        ([("unreached", "live"), ("live",)], {"live", "unreached"}),
        ([("live",)], {"live"}),
    ],
)
def test_the_order_in_which_registrations_are_seen_does_not_matter(ways, decides):
    assert registering([ways, ways[::-1], [*ways, *ways]]) == [decides] * 3


def test_registration_outside_the_code_is_certain():
    text = "pass\n"
    ctx = Linker([Module("node.py", "node", text, ast.parse(text))], Config())
    registered_roots.note(ctx, "later")
    registered_roots.connect(ctx)
    assert ctx.registered["later"].plain
    assert ctx.registered["later"].node is None
