"""Each action of a ROS 2 launch file in Python has its effect, or a problem says why it has none."""

from __future__ import annotations

import pytest

from tests.lint.workspace.launching import HEAD, described, launched, names, reasons, settings

# The actions of a launch file, the nodes that they start, and the problems.
ACTIONS = """\
# a node without a condition
node(),
=> /drive
# conditions that hold
node('a', condition=IfCondition('true')),
node('b', condition=IfCondition('0')),
node('c', condition=UnlessCondition('False')),
node('d', condition=UnlessCondition('1')),
=> /a ; /c
# a condition that is known on the robot
node(condition=IfCondition(LaunchConfiguration('open'))),
=> /drive
!! the condition `$(var open)` is known on the robot only
# comparisons of configurations
SetLaunchConfiguration('m', 'x'),
node('a', condition=LaunchConfigurationEquals('m', 'x')),
node('b', condition=LaunchConfigurationEquals('m', 'y')),
node('c', condition=LaunchConfigurationNotEquals('m', 'x')),
node('d', condition=LaunchConfigurationNotEquals('m', 'y')),
=> /a ; /d
# a comparison with an unknown value
DeclareLaunchArgument('m'),
node(condition=LaunchConfigurationEquals('m', 'x')),
=> /drive
!! the condition `$(var m) == x` is known on the robot only
# a condition of another kind
node(condition=other('x')),
=> /drive
!! the condition `$(other('x'))` is known on the robot only
# configurations set and unset
SetLaunchConfiguration('a', '1'),
node([LaunchConfiguration('a'), 'x']),
UnsetLaunchConfiguration('a'),
UnsetLaunchConfiguration('b'),
node([LaunchConfiguration('a', default='0'), 'y']),
=> /1x ; /0y
# a group keeps its settings inside
GroupAction([PushRosNamespace('in'), SetLaunchConfiguration('a', '1'), node('p')]),
node(LaunchConfiguration('a', default='q')),
GroupAction([PushRosNamespace('out'), SetLaunchConfiguration('b', '2')], scoped=False),
node(LaunchConfiguration('b', default='r')),
=> /in/p ; /q ; /out/2
# a group with configurations
GroupAction([node(LaunchConfiguration('a'))], launch_configurations={'a': 'x'}),
node(LaunchConfiguration('a', default='y')),
=> /x ; /y
# a group of no scope is left with its configurations
GroupAction([node('z')], launch_configurations={'a': 'x'}, scoped=False),
node(LaunchConfiguration('a', default='y')),
=> /z ; /x
# nested lists
[node('a'), [node('b')]],
=> /a ; /b
# an action that is not known
other.Action(),
=> nothing
!! `other.Action()` is not followed
# a node of nothing
Node(name='x'),
=> nothing
!! a node has neither package nor executable
# a package that is known on the robot
Node(package=LaunchConfiguration('p'), executable='e', name='n'),
=> /n
!! the package of a node is known on the robot only: $(var p)
# names in namespaces
PushRosNamespace('a'),
node(namespace='b'),
node('x', namespace='/c'),
node('y'),
=> /a/b/drive ; /c/x ; /a/y
# old names of arguments
Node(package='arm', node_executable='e', node_name='n', node_namespace='s'),
=> /s/n
# timers and events
TimerAction(period=1.0, actions=[node('a')]),
RegisterEventHandler(OnProcessExit(target_action=None, on_exit=[node('b')])),
RegisterEventHandler(event_handler=OnProcessStart(on_start=node('c'))),
LogInfo(msg='x'),
RosTimer(2.0, actions=[node('d')]),
=> /a ; /b ; /c ; /d
# components
ComposableNodeContainer(package='p', executable='e', name='box', namespace='',
    composable_node_descriptions=[ComposableNode(package='c', plugin='a::B', name='k', namespace='s',
    condition=IfCondition('1')), ComposableNode(package='c', plugin='a::C', name='l',
    condition=IfCondition('0')), other()]),
=> /box ; /s/k
!! `other()` is not followed
# components loaded later
LoadComposableNodes(target_container='box', composable_node_descriptions=[ComposableNode(package='c',
    plugin='a::B', name='k')]),
=> /k
# the function of an opaque function
OpaqueFunction(function=lambda context, a, b=0: [node(a), node(b)], args=['x'], kwargs={'b': 'y'}),
=> /x ; /y
# an opaque function that is not known
OpaqueFunction(function=other),
=> nothing
!! `OpaqueFunction` is not followed
# an opaque function without actions
OpaqueFunction(function=lambda context: None),
node(),
=> /drive
# an included file
IncludeLaunchDescription(XMLLaunchDescriptionSource([FindPackageShare('arm'), '/b.launch.xml']),
    launch_arguments={'n': 'x'}.items()),
node(LaunchConfiguration('n', default='left')),
=> /x_in ; /x
# a file that does not exist
IncludeLaunchDescription('/none.launch.py'),
=> nothing
!! there is no such launch file
# a file of another package
IncludeLaunchDescription([FindPackageShare('far'), '/a.launch.py']),
IncludeLaunchDescription(''),
=> nothing
!! the included file $(find-pkg-share far)/a.launch.py is not in the workspace
!! the included file ? is not in the workspace
# substitutions
SetLaunchConfiguration('t', 'true'),
SetLaunchConfiguration('f', 'false'),
*[node(IfElseSubstitution(one, f'a{k}', f'b{k}')) for k, one in enumerate([AndSubstitution('true',
    LaunchConfiguration('t')), AndSubstitution('true', LaunchConfiguration('f')), OrSubstitution('false',
    LaunchConfiguration('t')), OrSubstitution('false', LaunchConfiguration('f')), NotSubstitution('true'),
    NotSubstitution('0'), AllSubstitution('1', 'true', 'false'), AnySubstitution('0', '1'),
    EqualsSubstitution('1', 'true'), EqualsSubstitution('x', 'y'), NotEqualsSubstitution('x', 'y'),
    PythonExpression(['1', ' < 2']), PythonExpression('2 < 1')])],
=> /a0 ; /b1 ; /a2 ; /b3 ; /b4 ; /a5 ; /b6 ; /a7 ; /a8 ; /b9 ; /a10 ; /a11 ; /b12
# substitutions of unknown values
*[node(one) for one in [NotSubstitution(LaunchConfiguration('u')), EqualsSubstitution('a',
    LaunchConfiguration('u')), NotEqualsSubstitution(LaunchConfiguration('u'), 'a'),
    IfElseSubstitution(LaunchConfiguration('u'), 'x', 'y'), PythonExpression([LaunchConfiguration('u'),
    ' + 1']), EnvironmentVariable('E'), EnvironmentVariable('E', default_value='d'), AnonName('n'),
    TextSubstitution(text='t'), LaunchConfiguration(['a', 'b'], default=['c', 'd'])]],
=> /$(not $(var u)) ; /$(equals a $(var u)) ; /$(not-equals $(var u) a)
=> /$(if $(var u)) ; /$(eval $(var u) + 1) ; /$(env E) ; /d ; /n ; /t ; /cd
!! the name of a node is known on the robot only: $(not $(var u))
!! the name of a node is known on the robot only: $(equals a $(var u))
!! the name of a node is known on the robot only: $(not-equals $(var u) a)
!! the name of a node is known on the robot only: $(if $(var u))
!! the name of a node is known on the robot only: $(eval $(var u) + 1)
!! the name of a node is known on the robot only: $(env E)
"""
YAML = "/**:\n  ros__parameters:\n    kp: 2.0\n"  # arm.yaml
CASES = dict(one.split("\n", 1) for one in ACTIONS.strip().removeprefix("# ").split("\n# "))


@pytest.mark.parametrize("name", CASES)
def test_each_launch_action_has_its_effect(package, name):
    lines = CASES[name].split("\n")
    body = "\n".join(line for line in lines if line[:3] not in ("=> ", "!! "))
    nodes = [
        one for line in lines if line.startswith("=> ") for one in line[3:].split(" ; ") if one != "nothing"
    ]
    problems = [line[3:] for line in lines if line.startswith("!! ")]
    inner = '<launch><arg name="n" default="y"/><node pkg="arm" exec="part" name="$(var n)_in"/></launch>'
    (package / "b.launch.xml").write_text(inner)
    found = described(package, body)
    assert names(found) == nodes
    assert reasons(found) == problems


def test_nodes_started_by_events_and_anonymous_names_are_marked(package):
    found = described(
        package,
        "node('a'), RegisterEventHandler(OnProcessExit(on_exit=[GroupAction([node('b')])])), node(AnonName('c')),"
        "node([AnonName('d'), 'e']), node('f')",
    )
    assert [(one.name, one.event, one.anonymous) for one in found.nodes] == [
        ("a", False, ""),
        ("b", True, ""),
        ("c", False, "anon"),
        ("de", False, "anon"),
        ("f", False, ""),
    ]


PARAMETERS2 = [
    ("[{'a': 1, 'b': 'x', 'c': 2.5, 'd': True}]", {"~a": 1, "~b": "x", "~c": 2.5, "~d": True}, []),
    ("[{'a': {'b': {'c': 1}, 'd': 2}}]", {"~a.b.c": 1, "~a.d": 2}, []),
    ("[{'a': [1, 2], 'b': ['x', 'y'], 'c': (1.5,)}]", {"~a": "[1, 2]", "~b": "['x', 'y']", "~c": "[1.5]"}, []),
    ("[{'a': ['x', LaunchConfiguration('k', default='y')]}]", {"~a": "xy"}, []),
    ("[{'a': LaunchConfiguration('k', default='7')}]", {"~a": "7"}, []),
    ("[{'a': ParameterValue(LaunchConfiguration('k', default='7'), value_type=str)}]", {"~a": "7"}, []),
    ("[{'a': ParameterValue(5, value_type=int)}]", {"~a": 5}, []),
    ("[{'a': ParameterValue(LaunchConfiguration('k'))}]", {"~a": "unknown"}, ["the parameter a is not constant"]),
    ("[{'a': LaunchConfiguration('k')}]", {"~a": "unknown"}, ["the parameter a is not constant"]),
    ("[{'a': other()}]", {"~a": "unknown"}, ["the parameter a is not constant"]),
    ("[{'a': Command(['xacro', 'x'])}]", {"~a": "unknown"}, ["the parameter a is not constant"]),
    ("[{LaunchConfiguration('k', default='a'): 1}]", {"~a": 1}, []),
    ("[PathJoinSubstitution([FindPackageShare('arm'), 'arm.yaml'])]", {"~": YAML}, []),
    ("[ParameterFile([FindPackageShare('arm'), '/arm.yaml'])]", {"~": YAML}, []),
    (
        "['/none.yaml', LaunchConfiguration('k'), {'a': 1}]",
        {"~a": 1},
        [
            "the parameter file none.yaml: it cannot be read: No such file or directory",
            "the parameter file $(var k) is not known here",
        ],
    ),
]  # fmt: skip


@pytest.mark.parametrize(("given", "found", "problems"), PARAMETERS2)
def test_ros2_parameter_gets_its_value_in_the_launch_file(package, given, found, problems):
    launch = described(package, f"node(parameters={given})")
    assert settings(launch.nodes[0]) == found
    assert reasons(launch) == problems


def test_parameters_and_remappings_of_actions_apply_to_later_nodes(package):
    found = described(
        package,
        "node('a'), SetParameter('p', 1), SetParameter(name='q', value=LaunchConfiguration('k')), SetUseSimTime(True),"
        "SetParametersFromFile([FindPackageShare('arm'), '/arm.yaml']), SetRemap('x', 'y'),"
        "node('b', remappings=[('z', '/w')])",
    )
    assert [settings(one) for one in found.nodes] == [
        {},
        {"~p": 1, "~q": "unknown", "~use_sim_time": True, "~": YAML},
    ]
    assert [(one.remaps, one.inherited) for one in found.nodes] == [((), 0), ((("x", "y"), ("z", "/w")), 1)]


def test_remapping_in_a_group_may_apply_after_the_group(package):
    inside = "GroupAction([SetRemap('x', 'y'), SetParameter('p', 1)]), node('a')"
    alone = described(package, inside).nodes[0]
    assert (alone.remaps, settings(alone)) == ((), {})
    after = described(package, f"SetRemap('u', 'v'), SetParameter('q', 2), {inside}").nodes[0]
    assert (after.remaps, settings(after)) == ((("u", "v"), ("x", "y")), {"~q": 2, "~p": 1})


def test_arguments_of_ros2_nodes_set_names_remappings_and_parameters(package):
    found = described(
        package,
        "Node(package='arm', executable='e', arguments=['a b', '--ros-args', '-r', '__node:=n', '-r', '__ns:=/s',"
        " '--remap', 'x:=y', '-p', 'k:=3', '--params-file', [FindPackageShare('arm'), '/arm.yaml'], '--',"
        " '-r', 'u:=v']),"
        "Node(package='arm', executable='e', arguments='-r u:=v', ros_arguments=['--param', 'k:=4'])",
    )
    first, second = found.nodes
    assert (first.name, first.namespace, first.remaps) == ("n", "/s", (("x", "y"),))
    assert settings(first) == {"~k": "3", "~": YAML}
    assert first.arguments.startswith("'a b' --ros-args -r __node:=n")
    assert (second.arguments, second.remaps, settings(second)) == (
        "-r u:=v --ros-args --param k:=4",
        (),
        {"~k": "4"},
    )


OPAQUE = """
def made(context):
    names = context.launch_configurations
    found = [
        str(IfCondition("true").evaluate(context)),
        str(UnlessCondition("true").evaluate(context)),
        LaunchConfiguration("a").perform(context),
        context.perform_substitution(["x", LaunchConfiguration("a")]),
        names["a"],
        names.get("b", "no"),
        "has" if "c" in names else "lacks",
    ]
    return [node(one) for one in found]
def generate_launch_description():
    return LaunchDescription([DeclareLaunchArgument("a", default_value="1"), OpaqueFunction(function=made)])
"""


def test_an_opaque_function_can_read_configurations_and_conditions(package):
    found = launched(package, HEAD + OPAQUE, "a.launch.py", a="2")
    assert [one.name for one in found.nodes] == ["True", "False", "2", "x2", "2", "no", "lacks"]
    assert found.arguments == ("a", "b", "c"), "those that are declared or read"
    assert found.problems == ()


def test_opaque_function_value_from_the_robot_is_not_followed(package):
    body = """
def made(context):
    if IfCondition(LaunchConfiguration("open")).evaluate(context):
        return [node(LaunchConfiguration("open").perform(context))]
def generate_launch_description():
    return LaunchDescription([OpaqueFunction(function=made)])
"""
    found = launched(package, HEAD + body, "a.launch.py")
    assert [one.name for one in found.nodes] == ["$(var open)"]
    assert reasons(found) == [
        "the condition `IfCondition(LaunchConfiguration('open')).evaluate(context)` is not constant",
        "the name of a node is known on the robot only: $(var open)",
    ]
    assert found.arguments == ("open",)


@pytest.mark.parametrize(
    ("text", "ros2"),
    [
        ('<launch><node pkg="a" exec="b"/></launch>', True),
        ('<launch><node pkg="a" type="b"/></launch>', False),
        ('<launch><let name="a" value="$(var b)"/></launch>', True),
        ('<launch><arg name="a" default="$(arg b)"/></launch>', False),
        ('<launch><group><push-ros-namespace namespace="x"/></group></launch>', True),
        ('<launch><arg name="a"/></launch>', False),
    ],
)
def test_xml_launch_elements_show_the_ros_version(package, text, ros2):
    assert launched(package, text, "a.launch.xml").ros2 is ros2


def test_plain_xml_launch_file_has_the_ros_version_of_its_package(package):
    text = '<launch><arg name="a"/></launch>'
    (package / "package.xml").write_text(
        "<package><name>arm</name><export><build_type>ament_cmake</build_type></export></package>"
    )
    assert launched(package, text, "a.launch.xml").ros2
