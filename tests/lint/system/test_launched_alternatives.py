"""Nodes that exclude each other, tests, and remappings of groups around nodes that were not read."""

from __future__ import annotations

import pytest

from tests.lint.test_system import flows, launched, relay, run, workspace

__all__ = ["workspace"]

RELAY = '<node pkg="arm" type="relay.py" name="{}" {}><remap from="in" to="{}"/><remap from="out" to="{}"/></node>'


def test_no_flow_passes_through_nodes_that_exclude_each_other(workspace, capsys):
    real = RELAY.format("real", 'unless="$(arg sim)"', "/scan", "/points")
    simulated = RELAY.format("simulated", 'if="$(arg sim)"', "/points", "/cmd_vel")
    planner = RELAY.format("planner", "", "/points", "/goal")
    file = launched(workspace, f'<arg name="sim"/>{real}{simulated}{planner}')
    _, out, _ = run(capsys, "--launch", file)
    assert flows(out) == [
        "/scan → /real → /points → /planner → /goal  explicit",
    ]
    assert "/real (unless $(arg sim))" in out


def test_flows_pass_through_both_alternative_nodes(workspace, capsys):
    real = RELAY.format("driver", 'unless="$(arg sim)"', "/scan", "/points")
    simulated = RELAY.format("driver", 'if="$(arg sim)"', "/fake", "/points")
    file = launched(workspace, f'<arg name="sim"/>{real}{simulated}{relay("planner", "/points", "/goal")}')
    _, out, _ = run(capsys, "--launch", file)
    assert flows(out) == [
        "/fake → /driver → /points → /planner → /goal  explicit",
        "/scan → /driver → /points → /planner → /goal  explicit",
    ]


def unread(name: str, remaps: str = "") -> str:
    return f'<node pkg="other" type="{name}" name="{name}">{remaps}</node>'


SCAN, OUT = '<remap from="scan" to="/front/scan"/>', '<remap from="out" to="/b"/>'
ENDS = relay("talker", "/a", "/front/scan") + relay("listener", "/b", "/c")
READER = '<node pkg="arm" type="relay.py" name="reader"/>'


@pytest.mark.parametrize(
    ("body", "reached"),
    [
        (unread("filter", SCAN + OUT), True),
        (f"<group>{SCAN}{OUT}{unread('filter')}</group>", True),
        (f"<group>{SCAN}{READER}{unread('filter', OUT)}</group>", True),
        (f"<group>{SCAN}{OUT}{unread('filter')}{unread('other')}</group>", False),
        (f"<group>{SCAN}{unread('filter', OUT)}{unread('other')}</group>", False),
        (f"<group>{SCAN.replace('scan', 'in', 1)}{READER}{unread('filter', OUT)}</group>", False),
    ],
)
def test_group_remapping_belongs_to_the_only_possible_node(workspace, capsys, body, reached):
    file = launched(workspace, ENDS + body)
    _, out, _ = run(capsys, "--launch", file)
    chain = "/a → /talker → /front/scan → [/filter, not read] → /b → /listener → /c  not read"
    assert (chain in flows(out)) is reached


def test_nodes_of_tests_are_excluded_from_flows_and_hazards(workspace, capsys):
    check = (
        '<test test-name="check" pkg="arm" type="check.py"><remap from="in" to="/scan"/>' + OUT + "</test>"
    )
    file = launched(workspace, f"{relay('one', '/scan', '/go')}{check}", "arm.test")
    code, out, _ = run(capsys, "--launch", file)
    assert code == 0
    assert ": 1 node, 1 test\n" in out
    assert "/check  arm/check.py" in " ".join(out.split(" "))
    assert flows(out) == ["/scan → /one → /go  explicit"]
    assert "arm.test" in run(capsys, "--launch", "all")[1]
