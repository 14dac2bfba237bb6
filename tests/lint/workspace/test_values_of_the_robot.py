"""Names, namespaces, remappings and parameters that only the robot knows, in each form of a ROS 2 launch file."""

from __future__ import annotations

from pathlib import Path

import pytest

from tarl_lint.settings.config import Options, resolve
from tarl_lint.system.command import Request, systems
from tarl_lint.system.json import document
from tests.lint.workspace.launching import HEAD, launched, reasons

PYTHON = HEAD + "import os, socket\ndef generate_launch_description():\n    return LaunchDescription([{}])\n"
YAML = "launch:\n{}"
# place → the text of the problem, and the actions in Python, XML and YAML; @ is the value
PLACES: dict[str, tuple[str, str, str, str]] = {
    "name": (
        "the name of a node",
        "node(@)",
        '<node pkg="arm" exec="drive" name="@"/>',
        "- node: {pkg: arm, exec: drive, name: '@'}",
    ),
    "namespace": (
        "the namespace of drive",
        "node(namespace=@)",
        '<node pkg="arm" exec="drive" name="drive" namespace="@"/>',
        "- node: {pkg: arm, exec: drive, name: drive, namespace: '@'}",
    ),
    "namespace of a group": (
        "the namespace of a group",
        "GroupAction([PushRosNamespace(@), node()])",
        '<group><push-ros-namespace namespace="@"/><node pkg="arm" exec="drive" name="drive"/></group>',
        "- group:\n  - push_ros_namespace: {namespace: '@'}\n  - node: {pkg: arm, exec: drive, name: drive}",
    ),
    "remapping": (
        "a remapping of drive",
        "node(remappings=[('scan', @)])",
        '<node pkg="arm" exec="drive" name="drive"><remap from="scan" to="@"/></node>',
        "- node: {pkg: arm, exec: drive, name: drive, remap: [{from: scan, to: '@'}]}",
    ),
    "remapping of a group": (
        "a remapping",
        "SetRemap('scan', @), node()",
        '<set_remap from="scan" to="@"/><node pkg="arm" exec="drive" name="drive"/>',
        "- set_remap: {from: scan, to: '@'}\n- node: {pkg: arm, exec: drive, name: drive}",
    ),
    "parameter": (
        "the parameter kp",
        "node(parameters=[{'kp': @}])",
        '<node pkg="arm" exec="drive" name="drive"><param name="kp" value="@"/></node>',
        "- node: {pkg: arm, exec: drive, name: drive, param: [{name: kp, value: '@'}]}",
    ),
    "parameter of a group": (
        "the parameter kp",
        "SetParameter('kp', @), node()",
        '<set_parameter name="kp" value="@"/><node pkg="arm" exec="drive" name="drive"/>',
        "- set_parameter: {name: kp, value: '@'}\n- node: {pkg: arm, exec: drive, name: drive}",
    ),
    "parameter file": (
        "the parameter file",
        "node(parameters=[@])",
        '<node pkg="arm" exec="drive" name="drive"><param from="@"/></node>',
        "- node: {pkg: arm, exec: drive, name: drive, param: [{from: '@'}]}",
    ),
    "command line": (
        "the command line of drive",
        "node(arguments=['--side', @])",
        '<node pkg="arm" exec="drive" name="drive" args="--side @"/>',
        "- node: {pkg: arm, exec: drive, name: drive, args: '--side @'}",
    ),
}
VALUES = {
    "an argument without a default": ("LaunchConfiguration('x')", "$(var x)"),
    "a variable of the environment": ("EnvironmentVariable('X')", "$(env X)"),
    "the output of a command": ("Command(['hostname', ' -s'])", "$(command hostname)"),
    "the host's name": ("socket.gethostname()", ""),  # XML and YAML have no expressions of Python
    "a variable that Python reads": ("os.environ['X']", ""),
    "a text with the host's name": ("f'a_{socket.gethostname()}'", ""),
}


@pytest.mark.parametrize(
    ("form", "place", "value"),
    [(form, place, value) for form in ("py", "xml", "yaml") for place in PLACES for value in VALUES
     if form == "py" or VALUES[value][1]],
)  # fmt: skip
def test_a_value_that_only_the_robot_knows_is_named(form, place, value, package):
    what, *actions = PLACES[place]
    in_python, elsewhere = VALUES[value]
    if form == "py":
        text = PYTHON.format(actions[0].replace("@", in_python))
    elif form == "xml":
        text = f"<launch>{actions[1].replace('@', elsewhere)}</launch>"
    else:
        text = YAML.format(actions[2].replace("@", elsewhere))
    found = launched(package, text, f"a.launch.{form}")
    assert len(found.nodes) == 1
    (problem,) = found.problems
    assert problem.reason.startswith(what)
    assert problem.line > 0
    assert not problem.hides


COMPUTED = {
    "node(remappings=made())": "the remappings of drive: `made()` is not constant",
    "node(remappings=[made(), ('a', 'b')])": "the remappings of drive: `made()` is not constant",
    "node(parameters=made())": "the parameters of drive: `made()` is not constant",
    "node(parameters=[{LaunchConfiguration('x'): 1}])": "the name of a parameter is known on the robot only: $(var x)",
    "IncludeLaunchDescription(part, launch_arguments=made())":
        "the arguments of part.launch.xml: `made()` is not constant",
    "ComposableNodeContainer(package='c', executable='e', name='c', composable_node_descriptions=made())":
        "`made()` is not followed",
}  # fmt: skip


@pytest.mark.parametrize("action", COMPUTED)
def test_a_list_that_is_not_constant_is_named(action, package):
    (package / "part.launch.xml").write_text('<launch><node pkg="arm" exec="part" name="part"/></launch>')
    part = f"part = {str(package / 'part.launch.xml')!r}\n"
    assert reasons(launched(package, part + PYTHON.format(action), "a.launch.py")) == [COMPUTED[action]]


def test_values_in_a_parameter_file_are_named(package):
    (package / "arm.yaml").write_text(
        "/**:\n  ros__parameters:\n    kp: $(env KP)\n    kd: $(var kd)\n    ki: 1\n"
    )
    file = package / "arm.yaml"
    node = f'<node pkg="arm" exec="drive" name="drive"><param from="{file}" allow_substs="true"/></node>'
    text = f"<launch>{node}</launch>"
    assert reasons(launched(package, text, "a.launch.xml")) == [
        "a value in the parameter file arm.yaml is known on the robot only: $(env KP)",
        "a value in the parameter file arm.yaml is known on the robot only: $(var kd)",
    ]


def test_known_values_are_not_named(package):
    known = "TextSubstitution(text='a')"
    actions = [one.replace("@", known) for name, (_, one, *_) in PLACES.items() if name != "parameter file"]
    assert reasons(launched(package, PYTHON.format(", ".join(actions)), "a.launch.py")) == []


TEXTS = {
    "a.launch.py": PYTHON.format("node(namespace=LaunchConfiguration('x'))"),
    "a.launch.xml": '<launch>\n<node pkg="arm" exec="drive" name="drive" namespace="$(var x)"/></launch>',
    "a.launch.yaml": YAML.format("- node: {pkg: arm, exec: drive, name: drive, namespace: $(var x)}"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_report_lists_values_only_the_robot_knows(name, package):
    launched(package, TEXTS[name], name)
    root: Path = package.parent
    found = systems(Request(str(package / name), (), (root,)), resolve(Options((root,))))
    (unknown,) = document(found)["systems"][0]["unknown"]
    assert unknown["reason"] == "the namespace of drive is known on the robot only: $(var x)"
    assert unknown["path"].endswith(name)
    assert unknown["line"] > 0


@pytest.mark.parametrize(
    ("element", "name", "reason"),
    [
        ('<node pkg="arm" type="n" name="n"><rosparam file="{}"/></node>', "bad.yaml", "it is not YAML"),
        (
            '<node pkg="arm" type="n" name="n"><rosparam file="{}" ns="a"/></node>',
            "bad.yaml",
            "it is not YAML",
        ),
        ('<rosparam file="{}"/><node pkg="arm" type="n" name="n"/>', "bad.yaml", "it is not YAML"),
        ("<rosparam>a: [1</rosparam>", "a.launch", "the parameter /: it is not YAML"),
        ('<param name="a" value="[1" type="yaml"/>', "a.launch", "the parameter /a: it is not YAML"),
    ],
)
def test_parameters_that_are_not_yaml_are_named(element, name, reason, package):
    bad = package / "bad.yaml"
    bad.write_text("a: [1\n")
    launched(package, f"<launch>{element.format(bad)}</launch>", "a.launch")
    root: Path = package.parent
    found = systems(Request(str(package / "a.launch"), (), (root,)), resolve(Options((root,))))
    (unknown,) = document(found)["systems"][0]["unknown"]
    assert Path(unknown["path"]).name == name
    assert unknown["reason"].startswith(reason)
