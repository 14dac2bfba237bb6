"""ROS 2 launch files in XML and YAML are read, and unusual ones are a problem."""

from __future__ import annotations

import pytest

from tests.lint.workspace.launching import launched, names, reasons, settings

NONE = "it is not a launch file: it has no `launch:`"
YAML = """
launch:
- arg: {name: on, default: "true"}
- let: {name: n, value: [1, two]}
- group:
    scoped: "false"
    children:
    - push_ros_namespace: {namespace: g}
    - node: {pkg: arm, exec: e, name: a, if: $(var on), unless: "false"}
- timer:
  - node: {pkg: arm, exec: e, name: b, if: "0"}
- node:
    pkg: arm
    exec: e
    name: c
    param:
    - {name: l, value: [1, [2, x]]}
    - {name: m, value: {k: 1}}
- executable: {cmd: ls}
- nothing
- text: of an element
"""


def test_launch_files_in_yaml_are_read(package):
    found = launched(package, YAML, "a.launch.yaml")
    assert names(found) == ["/g/a", "/g/c"]
    assert settings(found.nodes[1]) == {"~l": "[1, [2, x]]", "~m": "[k]"}
    assert reasons(found) == ["<text> is not followed"]


@pytest.mark.parametrize(
    ("text", "reason"),
    [("a: 1", NONE), ("- launch", NONE),
     ("", NONE), ("launch: [", "it is not YAML: ")],
)  # fmt: skip
def test_yaml_that_is_not_a_launch_file_is_reported(package, text, reason):
    (problem,) = reasons(launched(package, text, "a.launch.yaml"))
    assert problem.startswith(reason)


def test_at_most_five_thousand_elements_of_yaml_are_read(package):
    text = "launch:\n" + "- node: {pkg: arm, exec: e, name: a}\n" * 5_002
    assert len(launched(package, text, "a.launch.yaml").nodes) == 5_000


def test_less_common_xml_elements_and_substitutions_are_read(package):
    text = """<launch><let name="n" value="$(file-content $(find-pkg-share arm)/words.txt)"/>
        <set_parameter name="w" value="$(var n)"/>
        <load_composable_node target="box"><composable_node pkg="c" plugin="a::B" name="x" if="$(eval 1 &lt; 2)"/>
        <composable_node pkg="c" plugin="a::B" name="y" unless="$(eval 1 &lt; 2)"/></load_composable_node>
        <lifecycle-node pkg="arm" exec="e" name="z" args="--a" ros_args="-p k:=1"/><log message="x"/></launch>"""
    found = launched(package, text, "a.launch.xml")
    assert [(one.name, one.kind) for one in found.nodes] == [("x", "component"), ("z", "node")]
    assert settings(found.nodes[1]) == {"~w": "some words\n", "~k": "1"}
    assert found.nodes[1].arguments == "--a --ros-args -p k:=1"


SEPARATED = (
    ('value="a,b" value-sep=","', "['a', 'b']"),
    ('value="1;2" value-sep=";"', "[1, 2]"),
    ('value="1;2.5" value-sep=";"', "[1.0, 2.5]"),
    ('value="true;False" value-sep=";"', "[True, False]"),
    ('value="1;2" value-sep=";" type="list_of_str"', "['1', '2']"),
    ('value="$(var k);2" value-sep=";"', "[7, 2]"),
)


@pytest.mark.parametrize(("attributes", "expected"), SEPARATED)
def test_a_value_with_a_separator_is_a_list(package, attributes, expected):
    text = f"""<launch><let name="k" value="7"/><node pkg="arm" exec="e" name="a">
        <param name="l" {attributes}/></node></launch>"""
    found = launched(package, text, "a.launch.xml")
    assert settings(found.nodes[0]) == {"~l": expected}
    assert reasons(found) == []
