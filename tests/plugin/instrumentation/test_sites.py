from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from pytest_tarl.instrumentation.sites import Plan, plan, relocate
from tarl_lint.model import Dependence, Flow, Role, Sink, SiteId, Source, Span, Step
from tests.lint.analysing import analysed


@dataclass(frozen=True)
class Found:
    flows: tuple[Flow, ...]


def step(
    line: int, text: str, dependence: Dependence = "data", role: Role = "assign", path: str = "node.py"
) -> Step:
    span = Span(path, line, 5, line, 5 + len(text))
    return Step(SiteId(path.removesuffix(".py"), "callback", text), span, text, role, dependence)


def flow(*steps: Step, source: tuple[str, ...] = ("/odom",), sink: tuple[str, ...] = ("/cmd_vel",)) -> Flow:
    at = Span("node.py", 1, 1, 1, 9)
    return Flow(
        "explicit",
        Source("s", at, source, "Odometry", "callback", "rospy.Subscriber"),
        Sink("p", Span("node.py", 90, 1, 90, 9), sink, "Twist", "rospy.Publisher.publish"),
        steps,
    )


def planned(*flows: Flow) -> Plan:
    return plan(Found(flows))


def codes(result: Plan, index: int = 0) -> list[str]:
    return [place.code for place in result.lists[index].sites]


def test_context_steps_are_not_sites():
    result = planned(flow(step(3, "register", "context"), step(10, "a"), step(12, "while b", "control")))
    assert codes(result) == ["a", "while b"]


def test_taint_list_keeps_the_order_of_its_flow():
    assert codes(planned(flow(step(30, "first"), step(10, "second"), step(20, "third")))) == [
        "first",
        "second",
        "third",
    ]


def test_flows_of_the_same_topics_share_one_list():
    left = flow(step(10, "a"), step(20, "left"), step(40, "d"))
    right = flow(step(10, "a"), step(15, "right"), step(30, "c"), step(40, "d"))
    result = planned(left, right)
    assert len(result.lists) == 1
    assert codes(result) == ["a", "right", "left", "c", "d"]


def test_flows_that_order_steps_differently_contribute_each_step_once():
    result = planned(flow(step(10, "a"), step(20, "b")), flow(step(20, "b"), step(10, "a")))
    assert codes(result) == ["a", "b"]


def test_each_topic_pair_has_one_taint_list():
    result = planned(
        flow(step(10, "a"), step(20, "b")),
        flow(step(10, "a"), step(30, "c"), sink=("/lights",)),
        flow(step(40, "d"), source=("/scan", "/sonar")),
    )
    assert [one.name for one in result.lists] == [
        "/odom → /cmd_vel",
        "/odom → /lights",
        "/scan → /cmd_vel",
        "/sonar → /cmd_vel",
    ]


def test_taint_lists_refer_to_sites_by_common_numbers():
    result = planned(
        flow(step(20, "b"), step(10, "a")), flow(step(10, "a"), step(30, "c"), sink=("/lights",))
    )
    assert [place.code for place in result.places] == ["a", "b", "c"]
    assert result.members == ((1, 0), (0, 2))
    for taint_list, members in zip(result.lists, result.members, strict=True):
        assert taint_list.sites == tuple(result.places[n] for n in members)


def test_sites_are_found_by_file_and_position():
    result = planned(flow(step(10, "a", path="helper.py"), step(10, "b"), step(12, "c")))
    assert result.positions == {"helper.py": {(10, 5): 0}, "node.py": {(10, 5): 1, (12, 5): 2}}


def test_site_that_carries_data_is_a_data_site():
    result = planned(flow(step(10, "a", "control")), flow(step(10, "a", "data")))
    assert [place.dependence for place in result.places] == ["data"]


def test_publishing_sites_are_marked():
    result = planned(flow(step(10, "a"), step(20, "pub.publish(a)", role="publish")))
    assert result.publishes == {1}


def test_source_without_a_topic_is_named_by_position():
    assert planned(flow(step(10, "a"), source=())).lists[0].source == "(rospy.Subscriber at node.py:1)"


def test_no_flow_gives_an_empty_plan():
    assert planned() == Plan((), (), (), {})


BEFORE = "a = 1\nb = 2\nc = 3\n"


@pytest.mark.parametrize(
    ("after", "expected"),
    [
        (BEFORE, {(1, 1): 0, (2, 1): 1, (3, 1): 2}),
        ("import x\n" + BEFORE, {(2, 1): 0, (3, 1): 1, (4, 1): 2}),
        ("a = 1\nb = (4 if x else 2)\nc = 3\n", {(1, 1): 0, (2, 1): 1, (3, 1): 2}),
        ("a = 1\nc = 3\n", {(1, 1): 0, (2, 1): 2}),
    ],
)
def test_sites_are_relocated_in_an_edited_text(after, expected):
    assert relocate({(1, 1): 0, (2, 1): 1, (3, 1): 2}, BEFORE, after) == expected


@pytest.mark.parametrize(
    ("callback", "forwarded"),
    [
        ("out.publish", True),
        ("functools.partial(out.publish)", True),
        ("functools.partial(functools.partial(out.publish))", True),
        ("lambda heard: out.publish(heard)", False),
        ("on_in", False),
        ("functools.partial(on_in)", False),
    ],
)
def test_publish_call_as_callback_runs_no_statement(tmp_path: Path, callback: str, forwarded: bool) -> None:
    found = analysed(
        tmp_path,
        node=f"""
        import functools
        import rospy
        from std_msgs.msg import Float64
        def on_in(heard):
            out.publish(heard)
        rospy.init_node("relay")
        out = rospy.Publisher("out", Float64, queue_size=1)
        held = rospy.Subscriber("in", Float64, {callback})
        """,
    )
    (only,) = found.flows
    assert only.sink.span.line == (9 if "on_in" not in callback else 6)
    assert plan(found).forwarded == (frozenset({0}) if forwarded else frozenset())
