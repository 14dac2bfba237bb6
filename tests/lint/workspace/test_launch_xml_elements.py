"""Each element of a ROS 1 launch file has its effect, or a problem says why it has none."""

from __future__ import annotations

import pytest

from tarl_lint.system.binding import parameter_values
from tarl_lint.workspace.launch_read import read_launch
from tarl_lint.workspace.read import read
from tests.lint.workspace.launching import launched, names, reasons, settings

NODE = '<node pkg="arm" type="drive" name="drive">{}</node>'

PARAMETERS = [
    ('<param name="a" textfile="$(find arm)/words.txt"/>', {"~a": "some words\n"}, []),
    (
        '<param name="a" textfile="$(find arm)/none.txt"/>',
        {"~a": "unknown"},
        ["<param> of drive: none.txt: it cannot be read: No such file or directory"],
    ),
    ('<param name="a" type="yaml" value="[1, 2]"/>', {"~a": "[1, 2]"}, []),
    ('<param name="a" type="int" value="7"/>', {"~a": 7}, []),
    ('<param name="a" type="int" value="x"/>', {"~a": "unknown"}, ["<param> of drive: 'x' is not of type int"]),
    (
        '<param name="a" command="date"/>',
        {"~a": "unknown"},
        ["<param> of drive: ~a is what a command prints on the robot"],
    ),
    ('<param name="a" value="1" if="false"/><param name="b" value="2" unless="false"/>', {"~b": 2}, []),
    ('<rosparam command="delete" param="a"/>', {}, []),
    ('<rosparam command="load" param="a">[1]</rosparam>', {"~a": "[1]"}, []),
    ('<rosparam>a: 1</rosparam>', {"~": "a: 1"}, []),
    ('<rosparam subst_value="1">a: $(eval 1 + 1)</rosparam>', {"~": "a: 2"}, []),
    ('<rosparam>a: $(eval 1 + 1)</rosparam>', {"~": "a: $(eval 1 + 1)"}, []),
    ('<rosparam ns="x" param="y">1</rosparam>', {"~x/y": "1"}, []),
    ('<rosparam file="$(find arm)/arm.yaml"/>', {"~": "/**:\n  ros__parameters:\n    kp: 2.0\n"}, []),
    (
        '<rosparam file="$(find arm)/none.yaml"/>',
        {},
        ["<rosparam> of drive: none.yaml: it cannot be read: No such file or directory"],
    ),
    (
        '<param name="a" value="$(find other)"/>',
        {"~a": "unknown"},
        ["<param> of drive: the package other is not in the workspace"],
    ),
    ('<param name="a" value="$(optenv DEV b c)"/><param name="e" value="$(optenv X)"/>', {"~a": "b c", "~e": ""}, []),
    (  # HOME is always set
        '<param name="a" value="$(optenv HOME b c)"/>',
        {"~a": "unknown"},
        ["<param> of drive: $(optenv HOME b c) is known on the robot only"],
    ),
    ('<param name="a" value="$(eval optenv(\'X\', \'y\') + str(arg(\'n\')))"/>', {"~a": "y3"}, []),
    (
        '<param name="a" value="$(eval n +)"/>',
        {"~a": "unknown"},
        ["<param> of drive: $(eval n +) is not a Python expression"],
    ),
    (
        '<param name="a" value="$(eval none + 1)"/>',
        {"~a": "unknown"},
        ["<param> of drive: $(eval none + 1) is not constant"],
    ),
    ('<param name="a" value="$(arg n)$(arg n)"/>', {"~a": 33}, []),
    ('<param name="a" value="$(arg none)"/>', {"~a": "unknown"}, ["<param> of drive: the argument none has no value"]),
    (
        '<param name="$(arg none)" value="1"/>',
        {},
        ["<param> of drive: the argument none has no value"],
    ),
    ('<param name="a" value="1.5"/><param name="b" value=" true "/><param name="c" value="x y"/>',
     {"~a": 1.5, "~b": True, "~c": "x y"}, []),
    ('<remap from="x" to="y"/>', {}, []),
]  # fmt: skip


@pytest.mark.parametrize(("inside", "found", "problems"), PARAMETERS)
def test_parameter_inside_a_node_gets_its_launch_value(package, inside, found, problems):
    launch = launched(package, f'<launch><arg name="n" value="3"/>{NODE.format(inside)}</launch>')
    assert settings(launch.nodes[0]) == found
    assert reasons(launch) == problems


def test_remappings_and_parameters_apply_to_the_nodes_after_them(package):
    first, last = NODE.replace("drive", "first").format(""), NODE.replace("drive", "last").format("")
    found = launched(
        package,
        f"""<launch>{first}
        <group ns="in"><remap from="a" to="b"/><param name="~p" value="1"/>{NODE.format("")}</group>
        <remap from="c" to="d"/><param name="~q" value="2"/><param name="r" value="3"/>{last}</launch>""",
    )
    assert [(one.remaps, one.inherited) for one in found.nodes] == [
        ((), 0),
        ((("a", "b"),), 1),
        ((("c", "d"),), 1),
    ]
    assert [settings(one) for one in found.nodes] == [{}, {"~p": 1}, {"~q": 2}]
    assert [(one.name, one.value) for one in found.settings] == [("/r", 3)]


def test_parameter_beside_a_node_may_be_unknown(package):
    found = launched(
        package,
        f"""<launch><arg name="none"/><param name="drive/a" value="$(arg none)"/><param name="~b" value="$(env NONE)"/>
        <param name="robot_description" command="xacro x"/><param name="$(arg none)" value="1"/>
        {NODE.format("")}</launch>""",
    )
    assert [(one.name, one.unknown) for one in found.settings] == [("/drive/a", True)]
    assert settings(found.nodes[0]) == {"~b": "unknown"}
    assert len(found.problems) == 4


def test_launch_element_counts_only_if_its_condition_holds(package):
    found = launched(
        package,
        """<launch><arg name="on" default="true"/><arg name="open"/>
        <node pkg="arm" type="d" name="a" if="$(arg on)"/><node pkg="arm" type="d" name="b" unless="$(arg on)"/>
        <node pkg="arm" type="d" name="c" if="0"/><node pkg="arm" type="d" name="d" unless="0"/>
        <group if="$(arg open)"><node pkg="arm" type="d" name="e"/></group>
        <node pkg="arm" type="d" name="f" unless="$(arg open)"/><node pkg="arm" type="d" name="g"/></launch>""",
    )
    assert [(one.name, one.condition) for one in found.nodes] == [
        ("a", ""),
        ("d", ""),
        ("e", "if $(arg open)"),
        ("f", "unless $(arg open)"),
        ("g", ""),
    ]
    assert reasons(found) == [
        "if of <group>: the argument open has no value",
        "unless of <node>: the argument open has no value",
    ]
    assert found.arguments == ("on", "open")


def test_included_file_gets_the_given_arguments(package):
    found = launched(
        package,
        """<launch><arg name="rate" value="8"/><include file="$(find arm)/part.launch"/>
        <include file="$(dirname)/part.launch" ns="one"><arg name="rate" value="6"/></include>
        <include file="$(find arm)/part.launch" pass_all_args="true"/>
        <include file="$(find arm)/part.launch"><arg name="rate" value="9" if="0"/></include>
        <include file="$(find arm)/part.launch" ns="two"><arg name="rate" value="$(arg none)"/></include>
        <include file="$(find arm)/none.launch"/></launch>""",
    )
    assert names(found) == ["/part_5", "/one/part_6", "/part_8", "/part_5", "/two/part_$(arg none)"]
    assert reasons(found) == [
        "<arg name='rate'>: the argument none has no value",
        "name of <node>: the argument rate is known on the robot only: $(arg none)",
        "<include>: none.launch does not exist",
    ]
    assert found.arguments == (), (
        "an argument with a value cannot be given, and that of another file is not of this one"
    )
    assert {one.file.name for one in found.nodes} == {"part.launch"}


def test_default_may_use_earlier_arguments(package):
    found = launched(
        package,
        """<launch><arg name="a" default="x"/><arg name="b" default="$(arg a)y"/><arg name="c" default="$(arg d)"/>
        <node pkg="arm" type="d" name="$(arg b)"/></launch>""",
        a="z",
    )
    assert names(found) == ["/zy"]
    assert reasons(found) == ["<arg name='c'>: the argument d has no value"]


def test_reading_files_that_include_each_other_ends(package):
    inner = '<include file="$(find arm)/b.launch"><arg name="n" value="$(eval n + 1)"/></include>'
    step = f'<launch><arg name="n"/>{inner}</launch>'
    (package / "b.launch").write_text(step)
    found = launched(
        package, '<launch><include file="$(find arm)/b.launch"><arg name="n" value="0"/></include></launch>'
    )
    assert reasons(found) == ["<include>: b.launch: files include each other"]
    same = launched(package, '<launch><include file="$(find arm)/a.launch"/></launch>')
    assert reasons(same) == ["<include>: a.launch: it includes itself"]


def test_anonymous_names_are_distinguished_by_their_file(package):
    (package / "c.launch").write_text('<launch><node pkg="arm" type="d" name="$(anon x)"/></launch>')
    found = launched(
        package,
        """<launch><node pkg="arm" type="d" name="$(anon x)"/><node pkg="arm" type="d" name="y"/>
        <include file="$(find arm)/c.launch"/><include file="$(find arm)/c.launch"/></launch>""",
    )
    assert [(one.name, one.anonymous) for one in found.nodes] == [
        ("x", "file 0"),
        ("y", ""),
        ("x", "file 1"),
        ("x", "file 2"),
    ]


def test_at_most_five_thousand_elements_are_read(package):
    found = launched(package, f"<launch>{NODE.format('') * 5_001}</launch>")
    assert len(found.nodes) == 5_000


def test_a_launch_file_that_does_not_exist_is_reported(package):
    found = read_launch(package / "none.launch.py", read(package.parent), {})
    assert (found.nodes, len(found.problems)) == ((), 1)


def test_parameter_set_after_a_node_replaces_its_value(package):
    found = launched(
        package,
        """<launch><param name="/left/drive/early" value="1"/>
        <group ns="left"><node pkg="arm" type="d" name="drive">
        <param name="early" value="2"/><param name="late" value="2"/><rosparam>{list: [1]}</rosparam></node></group>
        <param name="/left/drive/late" value="3"/><rosparam ns="left/drive">{list: [4]}</rosparam>
        <param name="/left/driver/late" value="5"/></launch>""",
    )
    values = parameter_values(found, found.nodes[0], "/left/drive")
    assert values == {
        "/left/drive/early": 2, "/left/drive/late": 3, "/left/drive/list": [4], "/left/driver/late": 5,
    }  # fmt: skip
