"""Parts of the search for flows, on value-flow graphs of a few numbered nodes."""

from __future__ import annotations

import ast
from types import SimpleNamespace

import pytest

from tarl_lint.errors import ConfigError
from tarl_lint.evidence import Outline
from tarl_lint.flows.call_chains import calls
from tarl_lint.flows.choices import Choices, made_alongside
from tarl_lint.flows.node_statements import Keys, Statements
from tarl_lint.flows.reachability import Reach, Tracer, _reversed, closure, ending_in_publish_call
from tarl_lint.flows.statement_text import Text
from tarl_lint.flows.taint_list import new_step
from tarl_lint.flows.taint_list_parts import Part, Parts
from tarl_lint.model import Span
from tarl_lint.options import _sentence
from tarl_lint.settings.schema import Wrapper
from tarl_lint.settings.wrappers import facts

KNOWN = ["--select", "--exclude"]


def graph(count: int, **parts) -> SimpleNamespace:
    """Return a graph in which `data` and `control` map each node to the nodes on which it depends."""

    def table(name):
        given = parts.pop(name, {})
        return [set(given.get(node, ())) for node in range(count)]

    data, control = table("data"), table("control")
    chosen = parts.pop("branches", {})
    branches = [frozenset(chosen.get(node, ())) for node in range(count)]
    every = {"gates": {}, "counts": {}, "stands_for": {}, "places": []}
    return SimpleNamespace(data=data, control=control, branches=branches, **every | parts)


def tracer(of: SimpleNamespace) -> Tracer:
    """Return a tracer of a graph without its programs."""
    found = Tracer.__new__(Tracer)
    found.graph = of
    found.forward_data, found.forward_control = _reversed(of.data), _reversed(of.control)
    return found


def test_reversing_a_graph_lists_the_predecessors_of_each_node():
    assert _reversed([{1, 2}, set(), {1}]) == [[], [0, 2], [0]]


def test_reachability_stays_within_the_given_nodes():
    data, control = [[1], [2], [], [4], []], [[3], [], [], [], []]
    assert closure([0], [data]) == {0, 1, 2}
    assert closure([0], [data, control]) == {0, 1, 2, 3, 4}
    assert closure([0], [data, control], {1, 3, 4}) == {0, 1, 3, 4}
    assert closure([], [data]) == set()
    assert closure([0], [[[1], [0]]]) == {0, 1}


def test_a_source_reaches_nodes_through_data_and_through_conditions():
    of = graph(5, data={1: [0], 3: [2]}, control={2: [1]})
    found = tracer(of).reach(SimpleNamespace(nodes={0}))
    assert (found.data, found.any, found.counted) == ({0, 1}, {0, 1, 2, 3}, {})


def counted(condition: int) -> SimpleNamespace:
    """Return a graph in which node 1, an element from node 0, is added under the gate 3.

    Node 2 is the container's length. The gate depends on the condition.
    """
    return graph(
        6,
        data={1: [0], 4: [2]},
        control={2: [3], 3: [condition]},
        gates={3: (1, frozenset())},
        counts={2: {1, 5}},
    )


def test_length_is_data_if_elements_are_added_conditionally():
    found = tracer(counted(condition=0)).reach(SimpleNamespace(nodes={0}))
    assert (found.data, found.counted) == ({0, 1, 2, 4}, {2: {1}})
    other = tracer(counted(condition=5)).reach(SimpleNamespace(nodes={0}))
    assert (other.data, other.counted) == ({0, 1}, {})
    assert tracer(counted(condition=0)).counts({0, 1, 2}) == {}
    assert tracer(counted(condition=0)).counts({0}) == {}


def test_the_data_of_a_length_includes_the_counted_elements():
    one = tracer(counted(condition=0))
    reach = Reach({0, 1, 2, 4}, {0, 1, 2, 3, 4}, {2: {1}})
    assert one.made_from({2, 4}, reach) == {0, 1, 2, 4}
    assert one.made_from({0, 1}, reach) == {0, 1}
    assert one.made_from({2, 4}, Reach({2, 4}, set(), {})) == {2, 4}
    formers = one.data_formers(reach.counted)
    assert (formers(2), formers(4), formers(1)) == ([1], [2], [0])


def test_constants_chosen_by_conditions_are_found_with_their_nodes():
    """Node 5 is chosen by the branch (9, 1); it is made from 4, and 4 from 3, all under that branch."""
    under = frozenset({(9, 1)})
    of = graph(
        10,
        data={5: [4], 4: [3], 3: [2]},
        branches={3: under, 4: under, 2: (), 5: under},
        gates={6: (5, under)},
    )
    assert Choices(of).made_there({6, 9}) == {3, 4}
    assert Choices(of).made_there({6}) == set()  # the condition is not among the nodes
    assert Choices(of).made_there({9}) == set()
    of.gates = {}
    assert Choices(of).made_there({6, 9}) == set()


def test_node_copy_without_conditions_leads_to_the_original():
    under = frozenset({(9, 1)})
    of = graph(10, data={7: [8]}, branches={5: under, 7: ()}, stands_for={8: 5})
    assert made_alongside(of) == {7: [5]}
    assert Choices(of).made_there({7, 9}) == {5}
    assert Choices(of).made_there({7}) == set()
    both = graph(10, data={7: [8, 6]}, stands_for={8: 5, 6: 4})
    assert made_alongside(both) == {7: [4, 5]}


def test_graph_nodes_without_a_statement_are_skipped():
    of = graph(6, data={0: [1, 4], 1: [2, 3], 2: [1]}, control={0: [5]})
    forward = _reversed(of.data), _reversed(of.control)
    of.places = [SimpleNamespace(role="assign")] * 6
    one = Statements(of, {}, forward)
    assert one.nodes_before(0) == [1, 4, 5]
    assert sorted(one.nodes_after([3])) == [1]
    of.places = [SimpleNamespace(role="merged" if node in (1, 2) else "assign") for node in range(6)]
    one = Statements(of, {}, forward)
    assert one.nodes_before(0) == [3, 4, 5]
    assert sorted(one.nodes_after([3])) == [0, 1, 2]
    assert one.formers(0) == [1, 4, 5]


class Call(SimpleNamespace):
    """A frame: the calls that lead to it, and its function."""

    __hash__, __eq__ = object.__hash__, object.__eq__


def frame(caller=None, call=None):
    return Call(caller=caller, call=call and SimpleNamespace(pos=(call, 0, call, 9)), function=None)


def test_the_calls_between_two_frames_are_listed_outermost_first():
    outer = frame()
    middle = frame(outer, 3)
    inner = frame(middle, 5)
    found = calls(inner, outer)
    assert [(place.frame, place.pos[0], place.role) for place in found] == [
        (outer, 3, "call"),
        (middle, 5, "call"),
    ]
    assert [place.pos[0] for place in calls(inner, middle)] == [5]
    assert calls(inner, inner) == []
    assert calls(outer, inner) == []
    assert calls(frame(outer, None), outer) == []


def test_conditions_have_the_frame_of_the_chosen_value():
    frames = [frame() for _ in range(4)]
    places = [SimpleNamespace(frame=one) for one in frames]
    under = frozenset({(3, 1), (3, 0)})
    of = graph(4, gates={0: (1, under)}, places=places)
    assert [*Choices(of).entrances(0)] == [(3, frames[1], frames[3], 0)]
    assert [*Choices(of).entrances(3)] == []
    copied = graph(4, data={0: [2]}, stands_for={2: 1}, branches={1: under, 0: {(3, 0)}}, places=places)
    assert [*Choices(copied).entrances(0)] == [(3, frames[1], frames[3], 1)]


def written(source: str, name: str = "f"):
    """Return the first statement of a function as it is written."""
    tree = ast.parse(source)
    text = SimpleNamespace(site=lambda one: "site", code=lambda span: "code")
    return SimpleNamespace(node=tree.body[0], qualname=name, text=text)


@pytest.mark.parametrize(
    ("source", "name", "dependence", "known", "role"),
    [
        ("x = 1", "f", "data", None, "assign"),
        ("x = 1", "f", "data", "publish", "publish"),
        ("x = 1", "f.<lambda>", "data", None, "return"),
        ("if x: pass", "f.<lambda>", "data", None, "condition"),
        ("for a in b: pass", "f", "control", None, "condition"),
        ("for a in b: pass", "f", "data", None, "assign"),
        ("return", "f", "data", None, "return"),
        ("f()", "f", "data", None, "call"),
    ],
)
def test_role_of_a_step_follows_from_its_syntax(source, name, dependence, known, role):
    body = f"def f():\n    {source}" if source == "return" else source
    one = written(body, name)
    if source == "return":
        one.node = one.node.body[0]
    span = Span("n.py", 1, 1, 1, 2)
    step = new_step(one, span, dependence, known)
    assert (step.role, step.dependence, step.code, step.span) == (role, dependence, "code", span)


def test_a_path_ends_at_its_last_publish_call():
    steps = [SimpleNamespace(role=role) for role in ("receive", "publish", "assign", "publish")]
    assert ending_in_publish_call([0, 1, 2], steps) == (0, 2, 1)
    assert ending_in_publish_call([0, 1, 2, 3], steps) == (0, 2, 3)
    assert ending_in_publish_call([0, 2], steps) == (0, 2)
    assert ending_in_publish_call([], steps) == ()


SOURCE = """\
import threading
LOCK = threading.Lock()
class Node:
    count: int = 0
    empty: int
    def __init__(self):
        global TOTAL
        self.lock = threading.RLock()
        self.changed = threading.Condition(self.lock)
        self.own = threading.Condition()
        self.other = threading.Condition(elsewhere)
        self.value = self.value2 = make(1)
    def go(self):
        return [lambda: 1]
"""


def test_module_outline_lists_locks_and_names():
    found = Outline(ast.parse(SOURCE))
    assert found.locks == {
        "LOCK": "LOCK",
        "lock": "lock",
        "changed": "lock",
        "own": "own",
        "other": "elsewhere",
    }
    assert found.declared == {"TOTAL"}
    assert {"LOCK", "count", "lock", "value", "value2"} <= found.assigned.keys()
    assert "empty" not in found.assigned
    assert [one.name for one in found.definitions] == ["Node", "__init__", "go"]
    assert [found.qualname(line) for line in (1, 4, 8, 14, 15)] == [
        "",
        "Node",
        "Node.__init__",
        "Node.go",
        "",
    ]


def test_call_is_found_by_its_position():
    found = Outline(ast.parse("f(1)(2)\ng()\n"))
    outer, inner = found.call((1, 0, 1, 7)), found.call((1, 0, 1, 4))
    assert outer is not None
    assert inner is not None
    assert outer.func is inner
    assert found.call((1, 0, 1, 5)) is None
    assert found.call((3, 0, 3, 1)) is None
    assert next(found.around(inner)) is outer
    assert found.scope(inner, (ast.FunctionDef,)) is None
    assert isinstance(found.scope(inner, (ast.Module,)), ast.Module)


def test_wrapper_takes_the_arguments_of_the_wrapped_function():
    usual = facts((Wrapper("a.b", "rospy.Subscriber"),))["a.b"]
    other = facts((Wrapper("a.b", "rospy.Subscriber", topic=4, callback="on", type=0),))["a.b"]
    assert usual.api == other.api == "a.b"
    assert (other.topic, other.callback, other.type) == ((4, ""), (-1, "on"), (0, ""))
    assert usual.topic != other.topic
    assert usual.extra == other.extra
    assert usual.kind == other.kind == "subscribe"
    with pytest.raises(
        ConfigError,
        match=r"'a\.b' has like = 'rospy\.Subscribe', which is not a function that can be wrapped",
    ):
        facts((Wrapper("a.b", "rospy.Subscribe"),))


@pytest.mark.parametrize(
    ("message", "sentence"),
    [
        ("unrecognized arguments: --selct=A b", "There is no option --selct: did you mean '--select'?"),
        ("argument --format: invalid choice: 'jsn' (choose from 'json', 'text')",
         "--format cannot be 'jsn': did you mean 'json'? It can be json, text."),
        ("argument --select: expected one argument", "--select needs a value."),
        ("argument --exclude: 'a[' is no pattern.", "--exclude: 'a[' is no pattern."),
        ("argument --exclude: 'a[' has no end", "--exclude: 'a[' has no end."),
        ("something else", "Something else."),
    ],
)  # fmt: skip
def test_command_line_mistakes_are_reported_in_one_sentence(message, sentence):
    assert _sentence(message, KNOWN) == sentence


METHOD = """\
class A:
    def f(self):
        x = [y for y in z]
        if x:
            g(lambda: x)
"""


def test_statements_are_found_by_their_first_character():
    module = SimpleNamespace(
        tree=ast.parse(
            "class A:\n    def f(self):\n        x = [y for y in z]\n        if x:\n            g(lambda: x)\n"
        ),
        text="class A:\n    def f(self):\n        x = [y for y in z]\n        if x:\n            g(lambda: x)\n",
        path="a.py",
        name="a",
    )
    text = Text(module)
    assign, condition = text.statement((3, 8)), text.statement((4, 8))
    assert assign is not None
    assert condition is not None
    assert (assign.qualname, isinstance(condition.node, ast.If)) == ("A.f", True)
    call = text.statement((5, 12))
    assert call is not None
    assert call.around is condition
    assert "A.f.<lambda>" in text.by_name
    assert text.statement((3, 9)) is None


HEADERS = """\
@decorated
def f(a, b=(1,
            2)) -> int :  # a colon: here
    if (a and
            b):  # first
        pass
    x = "é" + a; y = 2
    x = "é" + a; y = 2
    for i in a: pass
    with open(a) as b, c: pass
    while a[
        1:2]: pass
    match a:
        case [1, 2] if b: pass
    try:
        y = (
          1)
    finally: pass
"""


def test_compound_statement_spans_its_header():
    text = Text(SimpleNamespace(tree=ast.parse(HEADERS), text=HEADERS, path="a.py", name="a"))
    found = {}
    for written in text.by_start.values():
        span = text.span(written)
        found[span.line, span.column] = text.code(span)
    assert found == {
        (4, 5): "if (a and\n            b):",
        (6, 9): "pass",
        (7, 5): 'x = "é" + a',
        (7, 18): "y = 2",
        (8, 5): 'x = "é" + a',
        (8, 18): "y = 2",
        (9, 5): "for i in a:",
        (9, 17): "pass",
        (10, 5): "with open(a) as b, c:",
        (10, 27): "pass",
        (11, 5): "while a[\n        1:2]:",
        (12, 15): "pass",
        (13, 5): "match a:",
        (14, 14): "[1, 2] if b:",
        (14, 27): "pass",
        (15, 5): "try:",
        (16, 9): "y = (\n          1)",
        (18, 14): "pass",
    }
    header = text.function((3, 0)) or text.function((2, 0))
    assert header is not None
    span = text.span(header)
    assert (span.end_line, text.code(span)) == (3, "def f(a, b=(1,\n            2)) -> int :")


def test_columns_of_the_first_line_count_characters():
    source = 'x = "é" + a; y = 2\n'
    text = Text(SimpleNamespace(tree=ast.parse(source), text=source, path="a.py", name="a"))
    found = [text.span(written) for written in text.by_start.values()]
    assert sorted((one.column, text.code(one)) for one in found) == [(1, 'x = "é" + a'), (14, "y = 2")]


def test_equal_statements_of_a_function_are_numbered():
    text = Text(SimpleNamespace(tree=ast.parse(HEADERS), text=HEADERS, path="a.py", name="a"))
    first, second = text.statement((7, 4)), text.statement((8, 4))
    assert first is not None
    assert second is not None
    assert [text.site(one).ordinal for one in (first, second)] == [0, 1]
    assert text.site(first).text == "x = 'é' + a"
    assert (text.site(first).module, text.site(first).qualname) == ("a", "f")
    branch = text.statement((4, 4))
    assert branch is not None
    assert text.site(branch).text == "if a and b:"


def test_calls_between_condition_and_value_are_ordered_steps():
    """A helper, called through two calls, returns one of two values under a condition of the caller."""
    outer = frame()
    inner = frame(frame(outer, 3), 5)
    aside = frame()
    places = [SimpleNamespace(frame=one, role="") for one in (inner, outer, aside)]
    of = graph(3, gates={0: (0, frozenset({(1, "then"), (2, "then")}))}, places=places)
    known: dict[int, str | None] = {0: "value", 1: "condition", 2: "elsewhere"}
    statements = SimpleNamespace(
        graph=of,
        of=known.get,
        key_of=Keys(known),
        nodes_before=lambda node: (),
        nodes_after=lambda nodes: (),
        calls=lambda one, other: ["far", "near"] if (one, other) == (inner, outer) else None,
    )
    parts = Parts(statements, Choices(of))
    found = parts.of({0, 1, 2}, Part())
    assert set(found.entrances) == {
        (id("condition"), id("far")),
        (id("far"), id("near")),
        (id("near"), id("value")),
    }
    assert [*found.passed.values()] == ["far", "near"]
    known[1] = None
    statements.key_of.clear()
    assert [*parts.of({0, 1}, Part()).entrances] == [(id("far"), id("near")), (id("near"), id("value"))]
    assert not parts.of({0, 2}, Part()).entrances  # no calls lead to the other condition
