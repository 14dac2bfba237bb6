"""Results for a set of nodes are the same, whether computed at once or extended from the results for a subset."""

from __future__ import annotations

from types import SimpleNamespace

from hypothesis import given
from hypothesis import strategies as st

from tarl_lint.flows.choices import Choices, Made
from tarl_lint.flows.node_statements import Statements
from tarl_lint.flows.reachability import _reversed
from tarl_lint.flows.taint_list_parts import Part, Parts
from tarl_lint.memory.value_flow_graph import MERGED

COUNT = 9
NODES = st.integers(0, COUNT - 1)
SETS = st.sets(NODES)


class Frame(SimpleNamespace):
    """A frame that is compared by identity, as real ones are."""

    __hash__ = object.__hash__
    __eq__ = object.__eq__


PROGRAM = SimpleNamespace(path="n.py")
CALL = SimpleNamespace(pos=(5, 0, 5, 6))
OUTER = Frame(program=PROGRAM, function="run", caller=None, call=None)
FRAMES = {
    "run": [OUTER],
    "help": [Frame(program=PROGRAM, function="help", caller=OUTER, call=CALL) for _ in range(2)],
}
WRITTEN = {line: SimpleNamespace(start=(line, 0), line=line) for line in range(1, 6)}
TEXT = SimpleNamespace(statement=lambda pos: WRITTEN.get(pos[0]), function=lambda pos: None)


@st.composite
def graphs(draw):
    """Return a graph in three frames of two functions, with choices, copies without conditions, and merged nodes."""
    data = [draw(SETS) for _ in range(COUNT)]
    control = [draw(SETS) for _ in range(COUNT)]
    branch = st.frozensets(st.tuples(NODES, st.sampled_from(["then", "else"])), max_size=3)
    places = []
    for _ in range(COUNT):
        line = draw(st.integers(0, 4))
        where = draw(st.sampled_from(FRAMES["run" if line < 3 else "help"]))
        statement = SimpleNamespace(pos=(line, 0, line, 6)) if line else None
        role = MERGED if draw(st.integers(0, 3)) == 0 else "assign"
        places.append(SimpleNamespace(frame=where, statement=statement, role=role, pos=(line, 0, line, 6)))
    return SimpleNamespace(
        data=data,
        control=control,
        branches=[draw(branch) for _ in range(COUNT)],
        gates=draw(st.dictionaries(NODES, st.tuples(NODES, branch), max_size=4)),
        stands_for=draw(st.dictionaries(NODES, NODES, max_size=3)),
        places=places,
    )


@given(graphs(), SETS, SETS)
def test_subset_result_gives_the_same_constants(graph, subset, more):
    choices = Choices(graph)
    known = Made(subset, choices.made_there(subset))
    assert choices.made_there(subset | more, known) == choices.made_there(subset | more)


@given(graphs(), SETS, SETS)
def test_subset_result_gives_the_same_statements(graph, subset, more):
    texts = {"n.py": TEXT}
    statements = Statements(graph, texts, (_reversed(graph.data), _reversed(graph.control)))
    parts = Parts(statements, Choices(graph))
    known = parts.of(subset, Part())
    before = shown(known)
    extended, whole = parts.of(subset | more, known), parts.of(subset | more, Part())
    assert shown(extended) == shown(whole)
    assert shown(known) == before  # what is known is not changed


def shown(part: Part) -> tuple:
    """Return all that a part has, in a form that does not depend on the order of its computation."""
    order = {key: part.precedence.formers(key) for key in part.precedence.before}
    open_turns = {(a, b) for a, b in part.turns if a not in order.get(b, ())}
    return (
        part.nodes,
        part.written.keys(),
        part.placed.keys(),
        {key: found for key, found in order.items() if found},
        open_turns,
        set(part.entrances),
        part.passed.keys(),
    )
