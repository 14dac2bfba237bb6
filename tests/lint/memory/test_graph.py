"""Nodes and edges of the value-flow graph: data, decisions, liveness, and content passed on by carriers."""

from __future__ import annotations

import pytest

from tarl_lint.memory import value_flow_graph
from tarl_lint.memory.carry_nodes import settle
from tarl_lint.memory.value_flow_graph import MANY, MANY_CARRIERS, MERGED, WHICH, Place

AT = (0, 0, 0, 0)


@pytest.fixture
def node(graph, frame):
    """Return a function that makes a node under branches."""

    def made(key, *branches):
        return graph.node(key, Place(frame, None, "assign", AT), frozenset(branches))

    return made


def test_requesting_a_key_twice_gives_the_same_node(graph, node):
    assert node("a") == node("a") != node("b")
    assert graph.made == len(graph.places) == 2


def test_repeated_data_edges_are_stored_once(graph, node):
    a, b = node("a"), node("b")
    graph.flow([a, a], b)
    graph.flow([a], b)
    assert graph.data[b] == {a}
    assert graph.edges == 1
    assert graph.control[b] == set()


def test_self_dependent_value_keeps_its_conditions(graph, node):
    decision = node("loop")
    a = node("a", (decision, "body"))
    graph.flow([a], a)
    assert graph.data[a] == set()
    assert graph.control[a] == {decision}


def test_program_at_its_edge_limit_gets_few_further_edges(graph, node, monkeypatch):
    monkeypatch.setattr(value_flow_graph, "MAX_EDGES", 1)
    graph.flow([node("a"), node("b")], node("c"))
    assert len(graph.data[node("c")]) == 2
    many = [node(n) for n in range(value_flow_graph.FEW + 5)]
    graph.flow(many, node("d"))
    assert graph.data[node("d")] == set(many[: value_flow_graph.FEW])


def test_chosen_value_depends_on_the_branch_condition_through_a_gate(graph, node):
    decision = node("if")
    chosen, same, after = node("a", (decision, "then")), node("b", (decision, "then")), node("c")
    graph.flow([chosen], same)
    assert graph.control[same] == set()
    graph.flow([chosen], after)
    (gate,) = graph.control[after]
    assert graph.gates[gate] == (chosen, frozenset([(decision, "then")]))
    assert graph.control[gate] == {decision}
    only = node("d")
    graph.choice([chosen], only)
    assert graph.data[only] == set()
    assert only in graph.control or graph.control[only]
    graph.choice([chosen], same)
    assert graph.control[same] == set()


def test_node_copy_without_branches_keeps_data_and_drops_conditions(graph, node):
    decision = node("if")
    chosen, after = node("a", (decision, "then")), node("b")
    copy = graph.unchosen(chosen)
    assert graph.data[copy] == {chosen}
    assert graph.stands_for[copy] == chosen
    assert copy in graph.copies
    assert graph.unchosen(copy) == copy == graph.unchosen(chosen)
    graph.flow([copy], after)
    assert graph.control[after] == set()


def test_many_values_of_a_field_are_merged_into_one_node(graph, node, frame):
    deps = frozenset(node(n) for n in range(MANY + 1))
    assert graph.meets("field", deps, carriers=False)
    assert not graph.meets("field", frozenset(list(deps)[1:]), carriers=False)
    assert not graph.meets("field", deps, carriers=True)
    assert graph.meets("field", frozenset(range(MANY_CARRIERS + 1)), carriers=True)
    merged = graph.merged("field", deps, frame)
    (place,) = merged
    assert graph.data[place] == deps
    assert graph.places[place].role == MERGED
    assert graph.meets("field", merged, carriers=False)
    assert not graph.meets("other", merged, carriers=False)
    assert graph.merged("field", merged | {node("new")}, frame) == merged
    assert graph.data[place] == deps | {node("new")}


def test_node_becomes_live_with_its_dependency(graph, node):
    source, data, decided, late = (node(key) for key in ("source", "data", "decided", "late"))
    graph.flow([source], data)
    graph.depend(decided, [data])
    assert graph.live == set()
    assert graph.free(data)
    assert not graph.free(decided)
    graph.begin(source)
    assert graph.live == {source, data, decided}
    graph.flow([decided], late)
    assert late in graph.live


def test_a_copy_of_a_live_node_is_live(graph, node):
    graph.begin(a := node("a"))
    assert graph.unchosen(a) in graph.live


def test_carrier_counts_its_distinct_items(graph, node):
    carrier, item = node("carrier"), node("item")
    assert graph.passed_by(carrier) == 0
    graph.hold(carrier, frozenset())
    assert graph.held == {}
    graph.hold(carrier, frozenset([item]))
    graph.hold(carrier, frozenset([item]))
    assert graph.passed_by(carrier) == graph.grown == 1
    assert graph.as_passed({carrier: 1, item: 0})
    assert not graph.as_passed({carrier: 0})


def test_content_depends_on_every_carrier_that_stored_it(graph, node):
    item, other, first, second = (node(key) for key in ("item", "other", "first", "second"))
    graph.hold(first, frozenset([item]))
    (arrived,) = graph.through(frozenset([item]), frozenset([first]))
    assert graph.carried[arrived] == (first, item)
    assert graph.through(frozenset([other]), frozenset([first])) == {other}
    assert graph.through(frozenset([item, other]), frozenset([first])) == {arrived, other}
    assert graph.through(frozenset([item]), frozenset([first, second])) == {arrived}
    graph.hold(second, frozenset([item]))
    assert len(graph.through(frozenset([item]), frozenset([first, second]))) == 2
    assert graph.through(frozenset([item]), frozenset()) == {item}


def test_cached_content_queries_give_the_same_result(graph, node, monkeypatch):
    item, other, carrier = (node(key) for key in ("item", "other", "carrier"))
    graph.hold(carrier, frozenset([item]))
    carry = carrier
    for _ in range(3):  # the last two carriers are carry nodes themselves
        for one in (item, other):
            assert graph.arriving_through(one, {carry}) == graph.through(frozenset([one]), frozenset([carry]))
        (carry,) = graph.through(frozenset([item]), frozenset([carry]))
    assert graph.arriving_through(item, {other, carrier}) == {graph.passed_on[carrier, item]}
    assert graph.arriving_through(item, set()) == {item}
    monkeypatch.setattr(value_flow_graph, "MAX_CARRIED", 0)
    assert graph.arriving_through(item, {carrier}) == {item}


def test_content_arrives_by_the_same_nodes_without_a_cache(graph, node):
    item, carrier = node("item"), node("carrier")
    graph.hold(carrier, frozenset([item]))
    (first,) = graph.through(frozenset([item]), frozenset([carrier]))
    second = graph.through(frozenset([first]), frozenset([carrier]))
    graph.forget_arrivals()
    assert not graph.ways_through
    assert graph.through(frozenset([item]), frozenset([carrier])) == {first}
    assert graph.through(frozenset([first]), frozenset([carrier])) == second


def test_large_programs_do_not_track_the_carriers_of_content(graph, node, monkeypatch):
    item, carrier = node("item"), node("carrier")
    graph.hold(carrier, frozenset([item]))
    assert not graph.large()
    monkeypatch.setattr(value_flow_graph, "MAX_CARRIED", 0)
    assert graph.through(frozenset([item]), frozenset([carrier])) == {item}
    monkeypatch.undo()
    monkeypatch.setattr(value_flow_graph, "MAX_NODES", 1)
    assert graph.large()
    assert graph.through(frozenset([item]), frozenset([carrier])) == {item}


def test_settled_graph_connects_carry_nodes_to_their_content(graph, node):
    item, carrier = node("item"), node("carrier")
    graph.hold(carrier, frozenset([item]))
    (arrived,) = graph.through(frozenset([item]), frozenset([carrier]))
    assert graph.data[arrived] == set()
    settle(graph)
    assert graph.data[arrived] == {item}
    assert graph.made == 0


def test_a_cycle_of_carry_nodes_depends_on_its_origin(graph, node):
    item, one, two = node("item"), node("one"), node("two")
    for carry, other in ((one, two), (two, one)):
        graph.carried[carry] = (carry, item)
        graph.data[carry].add(other)
    settle(graph)
    assert item in graph.data[one] | graph.data[two]


def test_node_copy_can_replace_a_branch_condition(graph, node):
    kept, decided = (7, True), (3, False)
    read = node("read", kept, decided)
    copy = graph.under(read, 3, frozenset([(5, True)]))
    assert graph.branches[copy] == frozenset([kept, (5, True)])
    assert graph.data[copy] == {read}
    assert graph.under(read, 3, frozenset([(5, True)])) == copy
    assert graph.under(read, 4, frozenset()) == read


def test_a_count_does_not_depend_on_which_element_was_removed(graph, node):
    compared, decision = node("compared"), node("if")
    removed = node("a", (compared, WHICH), (decision, "then"))
    count, elements = node("count"), node("elements")
    graph.choice([removed], count, counted=True)
    graph.choice([removed], elements)
    assert graph.gates[next(iter(graph.control[count]))] == (removed, {(decision, "then")})
    assert len(graph.gates[next(iter(graph.control[elements]))][1]) == 2
    assert graph.without_removals(frozenset([removed, decision])) == {decision}


def test_only_removals_are_left_out_of_a_count(graph, node):
    removed = node("a", (node("compared"), WHICH))
    graph.choice([removed], node("count"), counted=True)
    assert graph.control[node("count")] == set()


def test_one_of_several_constants_keeps_its_conditions_as_data(graph, node):
    decision = node("if")
    chosen = node("a", (decision, "then"))
    one = graph.one_of(chosen)
    assert graph.control[one] == set()
    (inner,) = graph.data[one]
    assert graph.gates[next(iter(graph.control[inner]))] == (chosen, {(decision, "then")})
    assert graph.one_of(chosen) == one
    assert {one, inner} <= graph.copies
