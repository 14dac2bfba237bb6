"""Conditions known only on the robot: which nodes exclude each other, and what depends on a condition."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tarl_lint.workspace.conditions import exclusive
from tarl_lint.workspace.launch_model import LaunchedNode
from tests.lint.workspace.launching import described, launched, names, reasons, settings


def node(condition: str, file: str = "a.launch") -> LaunchedNode:
    return LaunchedNode("arm", "drive", "drive", "/", Path(file), 1, condition=condition)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("if $(arg sim)", "unless $(arg sim)"),
        ("$(var sim)", "not $(var sim)"),
        ("$(not $(var sim))", "$(var sim)"),
        ("if $(arg a) and unless $(arg b)", "if $(arg b)"),
        ("mode == 'a'", "mode == 'b'"),
        ("mode == 'a'", "mode != 'a'"),
        ("not (mode == 'a')", "mode == 'a'"),
        ("$(eval '$(var mode)' == 'a')", "$(eval '$(var mode)' == 'b')"),
        ("$(eval 'a' == '$(var mode)')", "$(eval '$(var mode)' == 'b')"),
        ("$(equals $(var mode) a)", "$(not-equals $(var mode) a)"),
        ("$(var mode) == a", "$(equals $(var mode) b)"),
        ("if $(eval arg('mode') == 'a')", "unless $(eval arg('mode') == 'a')"),
    ],
)
def test_conditions_that_cannot_hold_together_exclude_each_other(one: str, other: str) -> None:
    assert exclusive(node(one), node(other))
    assert exclusive(node(other), node(one))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("if $(arg sim)", "if $(arg sim)"),
        ("if $(arg sim)", "unless $(arg real)"),
        ("if $(arg sim)", ""),
        ("mode != 'a'", "mode != 'b'"),
        ("mode == 'a'", "mode == first"),
        ("mode == 'a'", "other == 'b'"),
        ("(a and b)", "not a"),
        ("$(eval '$(var mode)' == '$(var one)')", "$(eval '$(var mode)' == '$(var two)')"),
    ],
)
def test_conditions_that_may_hold_together_are_not_exclusive(one: str, other: str) -> None:
    assert not exclusive(node(one), node(other))


def test_a_variable_of_another_file_may_have_another_value() -> None:
    assert not exclusive(node("real", "a.launch.py"), node("not real", "b.launch.py"))
    assert exclusive(node("$(var real)", "a.launch.py"), node("not $(var real)", "b.launch.py"))


ATOMS = [
    ("$(var a)", "a", True),
    ("not $(var a)", "a", False),
    ("$(var b)", "b", True),
    ("not $(var b)", "b", False),
]


@given(*[st.lists(st.sampled_from(ATOMS), min_size=1, max_size=3)] * 2)
def test_unsatisfiable_conjunctions_exclude_each_other(one, other):  # type: ignore[no-untyped-def]
    texts = [" and ".join(text for text, _, _ in atoms) for atoms in (one, other)]
    values = [{"a": a, "b": b} for a in (False, True) for b in (False, True)]
    holds = [
        [all(value[name] is wanted for _, name, wanted in atoms) for value in values]
        for atoms in (one, other)
    ]
    both = any(first and second for first, second in zip(*holds, strict=True))
    if all(map(any, holds)):  # each can hold alone
        assert exclusive(node(texts[0]), node(texts[1])) is not both


def test_conditions_of_enclosing_elements_are_combined(package):
    found = launched(
        package,
        """<launch><arg name="a"/><arg name="b"/>
        <group if="$(arg a)"><node pkg="arm" type="d" name="one" unless="$(arg b)"/></group>
        <group unless="$(arg a)"><include file="$(find arm)/part.launch"/></group></launch>""",
    )
    assert [one.condition for one in found.nodes] == ["if $(arg a) and unless $(arg b)", "unless $(arg a)"]
    assert exclusive(*found.nodes)


def test_included_condition_names_the_outer_argument(package):
    (package / "inner.launch").write_text(
        '<launch><arg name="sim"/><node pkg="arm" type="d" name="n" if="$(arg sim)"/></launch>'
    )
    inner = '<include file="$(dirname)/inner.launch" ns="{0}"><arg name="sim" value="{1}"/></include>'
    left, right = inner.format("left", "$(arg left_sim)"), inner.format("right", "$(env RIGHT_SIM)")
    found = launched(package, f'<launch><arg name="left_sim"/>{left}{right}</launch>')
    assert [one.condition for one in found.nodes] == ["if $(arg left_sim)", "if $(env RIGHT_SIM)"]


def test_a_value_set_under_an_unknown_condition_is_symbolic(package):
    found = launched(
        package,
        """<launch><arg name="front"/>
        <arg name="side" value="front" if="$(arg front)"/><arg name="side" value="rear" unless="$(arg front)"/>
        <arg name="same" value="x"/><arg name="same" value="x" if="$(arg front)"/>
        <remap from="scan" to="/front" if="$(arg front)"/>
        <node pkg="arm" type="d" name="n"><param name="turn" value="2" unless="$(arg front)"/>
        <param name="k" value="1"/>
        <remap from="in" to="$(arg side)/scan"/><rosparam if="$(arg front)">{a: 1}</rosparam></node>
        <node pkg="arm" type="d" name="$(arg same)"/></launch>""",
    )
    assert names(found) == ["/n", "/x"]
    drive = found.nodes[0]
    assert drive.remaps == (("scan", "$(/front if $(arg front))"), ("in", "$(rear unless $(arg front))/scan"))
    assert settings(drive) == {"~turn": "unknown", "~k": 1, "~": "unknown"}
    assert drive.condition == ""


def test_a_condition_decided_by_an_argument_leaves_nothing_symbolic(package):
    text = """<launch><arg name="front"/><remap from="scan" to="/front" if="$(arg front)"/>
        <remap from="scan" to="/rear" unless="$(arg front)"/><node pkg="arm" type="d" name="n"/></launch>"""
    assert launched(package, text, front="true").nodes[0].remaps == (("scan", "/front"),)
    assert launched(package, text, front="false").nodes[0].remaps == (("scan", "/rear"),)


def test_opposite_conditions_of_ros2_differ(package):
    found = described(
        package,
        """
        DeclareLaunchArgument("sim"),
        node("a", condition=IfCondition(LaunchConfiguration("sim"))),
        node("b", condition=UnlessCondition(LaunchConfiguration("sim"))),
        node("c", condition=LaunchConfigurationEquals("sim", "x")),
        node("d", condition=LaunchConfigurationNotEquals("sim", "x")),
        """,
    )
    assert [one.condition for one in found.nodes] == [
        "$(var sim)", "not $(var sim)", "$(var sim) == x", "$(var sim) != x",
    ]  # fmt: skip
    assert exclusive(*found.nodes[:2])
    assert exclusive(*found.nodes[2:])


def test_programs_of_test_elements_are_no_robot_nodes(package):
    found = launched(
        package,
        """<launch><node pkg="arm" type="drive" name="drive"/>
        <test test-name="checks" pkg="arm" type="check.py"><param name="rate" value="5"/></test>
        <test test-name="hz" pkg="rostest" type="hztest" name="hz_of_scan" time-limit="5"/></launch>""",
        "arm.test",
    )
    assert [(one.name, one.kind) for one in found.nodes] == [
        ("drive", "node"),
        ("checks", "test"),
        ("hz_of_scan", "test"),
    ]
    assert settings(found.nodes[1]) == {"~rate": 5}
    assert not reasons(found)


def test_default_of_an_always_set_variable_is_ignored(package):
    found = launched(
        package,
        """<launch><node pkg="arm" type="d" name="a"><param name="x" value="$(optenv HOME /root)/log"/>
        <param name="y" value="$(optenv KIND plain)"/><param name="z" value="$(eval optenv('HOME', '/root'))"/>
        </node></launch>""",
    )
    assert settings(found.nodes[0]) == {"~x": "unknown", "~y": "plain", "~z": "unknown"}
    modern = described(
        package,
        """node("a", parameters=[{"x": EnvironmentVariable("HOME", default_value="/root"),
        "y": EnvironmentVariable("KIND", default_value="plain")}])""",
    )
    assert settings(modern.nodes[0]) == {"~x": "unknown", "~y": "plain"}
