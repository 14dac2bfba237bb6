"""Parameters of a launched node for names in its code, and flows of nodes by launched topics."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tarl_lint.model import Span
from tarl_lint.parameter_names import ARGUMENTS, DEFAULT, ELSEWHERE, LAUNCHED, Launched
from tarl_lint.system.binding import (
    command_line,
    fixed,
    parameter_values,
    undetermined,
    whole,
    with_names_in_code,
    with_prints,
)
from tarl_lint.system.compose import hops
from tarl_lint.system.model import Endpoint, Instance, Interface, Seen, full_name
from tarl_lint.workspace.launch_model import Launch, LaunchedNode, Setting
from tarl_lint.workspace.launch_parameters import ON_ROBOT

FILE = Path("a.launch")
AT = Span("node.py", 3, 1, 3, 9)


def launched(name: str = "k", **given: Any) -> LaunchedNode:
    return LaunchedNode("arm", "k.py", name, given.pop("namespace", "/n"), FILE, 3, **given)


def test_node_has_parameters_of_enclosing_namespaces():
    node = launched(
        settings=(
            Setting("~a", FILE, 1),
            Setting("~", FILE, yaml="b: {c: 2, d: []}"),
            Setting("~bad", FILE, yaml="["),
        )
    )
    launch = Launch(
        FILE,
        (node,),
        (Setting("/n/k/a", FILE, 5), Setting("/top", FILE, "x"), Setting("~/e", FILE, unknown=True)),
    )
    assert parameter_values(launch, node, "/n/k") == {
        "/n/k/a": 1,
        "/top": "x",
        "/n/k/e": ON_ROBOT,
        "/n/k/b/c": 2,
        "/n/k/b/d": [],
    }


VALUES = {
    "/n/k/a": 1,
    "/n/k/l": ["x", 2],
    "/n/k/t/u": 3,
    "/n/k/r": ON_ROBOT,
    "/n/k/m": [[1]],
    "/n/b": "y",
    "/c": True,
}


@pytest.mark.parametrize(
    ("name", "value"),
    [("~a", 1), ("~l", ("x", 2)), ("~none", DEFAULT), ("~t", None), ("~r", None), ("~m", None), ("b", "y"),
     ("/c", True), ("~t/u", 3), (ARGUMENTS, None)],
)  # fmt: skip
def test_only_scalars_and_their_lists_are_known_parameters(name, value):
    assert fixed([name], VALUES, "/n/k") == ({} if value is None else {name: value})


def test_command_line_ends_with_the_arguments_of_ros():
    node = launched(arguments="--fast 'a b' scan:=/s", remaps=(("odom", "o"), ("scan", "/s")))
    assert command_line(node, Launch(FILE), "/n/k") == {
        ARGUMENTS: ("k.py", "--fast", "a b", "scan:=/s", "odom:=o", "__name:=k", "__log:=node.log")
    }
    assert command_line(node, Launch(FILE, ros2=True), "/n/k") == {
        ARGUMENTS: ("k.py", "--fast", "a b", "scan:=/s", "--ros-args", "-r", "__node:=k")
    }
    assert command_line(launched(arguments="'open"), Launch(FILE), "/k") == {}
    assert command_line(launched(arguments="--x $(arg y)"), Launch(FILE), "/k") == {}


def test_node_parameters_are_passed_if_they_are_known():
    values = {
        "b": {"c": [1, None]},
        "a": 1,
        "r": ON_ROBOT,
        "s": [ON_ROBOT],
        "t": {1: 2},
        "u": {"v": ON_ROBOT},
    }
    found = whole(values, "/n/k")[LAUNCHED]
    assert isinstance(found, Launched)
    assert (found.name, found.namespace) == ("/n/k", "/n")
    assert found.parameters == (
        ("a", 1), ("b", {"c": [1, None]}), ("r", ELSEWHERE), ("s", ELSEWHERE), ("t", ELSEWHERE), ("u", ELSEWHERE),
    )  # fmt: skip


def end(role: str, *names: str, **given: Any) -> Endpoint:
    return Endpoint(role, names, "T", given.pop("span", AT), **given)  # type: ignore[arg-type]


def test_launched_node_sees_nested_parameters_as_a_table():
    node = Launched("/n/k", (("/n/k/a/b", 1), ("/n/k/a/c/d", 2), ("/n/k/e", 3), ("/n/f", 4), ("/n/k/g", 5)))
    assert node.value("~a") == {"b": 1, "c": {"d": 2}}
    assert (node.value("~e"), node.value("f"), node.value("g"), node.value("/n/f")) == (3, 4, 5, 4)
    assert node.value("~none") is DEFAULT


def test_endpoint_without_exactly_one_name_is_undetermined(example):
    assert not undetermined(Interface("n.py", endpoints=(end("calls", "a"),), flows=(example.finding(),)))
    assert undetermined(Interface("n.py", endpoints=(end("calls", "a"), end("calls"))))
    assert undetermined(Interface("n.py", endpoints=(end("calls", "a", "b"),)))
    unnamed = replace(
        example.finding(), flow=replace(example.flow(), source=replace(example.source(), topics=()))
    )
    assert undetermined(Interface("n.py", flows=(unnamed,)))
    assert not undetermined(Interface("n.py", flows=(replace(unnamed, flow=None),)))


def test_launch_file_does_not_change_fingerprints(example):
    every = Interface("n.py", flows=(replace(example.finding(), fingerprint="old"),))
    other = example.finding("implicit")
    decided = Interface("n.py", flows=(replace(example.finding(), fingerprint="new"), other))
    assert [one.fingerprint for one in with_prints(decided, every).flows] == ["old", "odom-implicit"]
    named = Interface("n.py", endpoints=(end("calls", "a", written=("~p",)), end("serves", "b")))
    known = Interface(
        "n.py", endpoints=(end("calls", "x"), end("serves", "y"), end("publishes", "z", written=("w",)))
    )
    assert [one.in_code for one in with_names_in_code(known, named).endpoints] == [("~p",), ("y",), ("w",)]


def flow(
    example: Any, source: tuple[str, ...], sink: tuple[str, ...], kind: str = "explicit", **given: str
) -> Any:
    made = example.flow(kind)
    source_ = replace(made.source, topics=source, api=given.get("heard", made.source.api))
    sink_ = replace(made.sink, topics=sink, api=given.get("said", made.sink.api))
    return replace(example.finding(kind), flow=replace(made, source=source_, sink=sink_))


def instance(name: str, *flows: Any, ends: tuple[Endpoint, ...] = (), **given: Any) -> Instance:
    namespace, _, last = name.rpartition("/")
    return Instance(
        launched(last, namespace=namespace or "/", **given),
        name,
        Interface("n.py", flows=flows, endpoints=ends),
    )


def made(*instances: Instance) -> list[tuple[str, str, str, str]]:
    return [(one.node, one.source, one.sink, one.kind) for one in hops(instances)]


def test_launch_file_renames_topics_in_flows(example):
    both = instance(
        "/n/k",
        flow(example, ("a",), ("b", "/c")),
        flow(example, ("a",), ("b",), "implicit"),
        remaps=(("a", "/x"),),
    )
    assert made(both) == [("/n/k", "/x", "/c", "explicit"), ("/n/k", "/x", "/n/b", "explicit")]
    assert [len(one.findings) for one in hops([both])] == [1, 2]
    assert hops([both])[1].findings[0].flow.kind == "explicit"
    unknown = instance("/k", flow(example, (), ("b",), "implicit"))
    ((node, source, sink, kind),) = made(unknown)
    assert (node, sink, kind) == ("/k", "/b", "implicit")
    assert not source.startswith("/")
    assert made(instance("/k", replace(example.finding(), flow=None))) == []


def test_service_flow_runs_from_request_to_response(example):
    server = instance("/s", flow(example, ("add",), ("add",), heard="rospy.Service", said="rospy.Service"))
    assert made(server) == [("/s", "/add (request)", "/add (response)", "explicit")]


def test_unread_server_may_return_request_data_to_its_client(example):
    call, answer = "rospy.ServiceProxy.__call__", "rospy.ServiceProxy"
    asks, uses = flow(example, ("a",), ("add",), said=call), flow(example, ("add",), ("b",), heard=answer)
    through = [hop for hop in made(instance("/c", asks, uses)) if hop[3] == "not read"]
    assert [(source, sink) for _, source, sink, _ in through] == [("/add (request)", "/add (response)")]
    served = instance("/s", ends=(end("serves", "add"),))
    assert [hop for hop in made(instance("/c", asks, uses), served) if hop[3] == "not read"] == []
    assert [hop for hop in made(instance("/c", asks)) if hop[3] == "not read"] == []


def test_unread_node_may_connect_its_remapped_topics(example):
    unread = Instance(
        launched("u", namespace="/", remaps=(("in", "/a"), ("out", "/b"), ("x", "/c"))),
        "/u",
        None,
        "no Python",
    )
    talker = instance("/t", ends=(end("publishes", "/a"),))
    listener = instance("/l", ends=(end("subscribes", "/b"), end("subscribes", "/a")))
    assert made(unread, talker, listener) == [("/u", "/a", "/b", "not read")]
    seen = Instance(
        launched("c", namespace="/"),
        "/c",
        None,
        "",
        Seen((end("subscribes", "i"), end("publishes", "o"), end("publishes", "p"))),
    )
    assert made(seen) == [("/c", "/i", "/o", "not read"), ("/c", "/i", "/p", "not read")]
    assert made(replace(seen, known=replace(seen.known, through=False))) == []


def test_unnamed_node_gets_the_name_in_its_code_or_program():
    assert full_name(launched("a"), "b") == "/n/a"
    assert full_name(launched(""), "b") == "/n/b"
    assert full_name(launched(""), "") == "/n/k.py"
    assert full_name(replace(launched(""), executable="arm::Driver"), "") == "/n/Driver"
