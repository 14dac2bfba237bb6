"""TARL307: a launch file sets a parameter that the node does not have.

The value has no effect, and the node uses its default. Often the parameter was renamed or misspelt. ROS gives no
warning. For example, a filter used two unsuitable defaults, because the names in its parameter file did not match those
of the node (https://github.com/manankharwar/fusioncore/issues/134).

In a parameter file of ROS 2, the section `gate:` applies to the node `/gate`, not to `/robot/gate`. A node that is
started in a namespace therefore gets no values from this section. The rule reports the section unless another section
of the file gives the node the same parameters. It also reports a section without `ros__parameters`, and, if the launch
file renames a node, a section with the name that the node has in its code.

The rule reports a parameter only if it could read the program of the node with all its imports, and if all parameter
names in the program are known. The names may be literals, entries of tables and lists, arguments of functions, fields
of classes, or parameters of dynamic_reconfigure in the workspace's `.cfg` files. A program may also compose a name from
parts that are known at each call, as in `get_param("~%s/%s" % (group, key))` in a helper or `f"tray{n}.tare"` in a loop
over `range(4)`. If some parts of a composed name are unknown, the rule accepts every name that can be formed from words
and digits in the program. If a group sets a parameter for all its nodes, the rule reports the parameter only if none of
the nodes has it.

In ROS 1, a launch file may set private parameters of a node by their full names, outside the node. The rule reports
such a parameter if the same file sets another parameter that the node has, or if the node has a parameter with a
similar name.

In ROS 1, the rule also reports a parameter that is set in the wrong namespace:

- The launch file sets the private parameter `~gain`, but the program reads only `get_param("gain")`.
- The launch file sets `gain` in the namespace, but a parameter of this name is read only by `get_param("~gain")`. The
  rule reports this only if it could read all programs of the launch file.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from typing import Any, Final

from tarl_lint.model import Finding
from tarl_lint.system.hazards import at_node
from tarl_lint.system.model import Instance, System
from tarl_lint.system.similar_names import spelled_alike
from tarl_lint.workspace.bounded_files import UnreadableError
from tarl_lint.workspace.launch_model import Setting
from tarl_lint.workspace.parameter_yaml import (
    SECTION,
    YAML,
    NoYamlError,
    content,
    dotted,
    is_wildcard,
    matches,
    sections,
)

CODE: Final = "TARL307"
SUMMARY: Final = "a launch file sets a parameter that the node does not have"

INVALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="keeper.py" name="keeper">
        <param name="gian" value="0.8"/>
      </node>
    </launch>
    --- scripts/keeper.py
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    rospy.init_node("keeper")
    gain = rospy.get_param("~gain", 0.5)
    pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)

    def on_odom(odom):
        cmd = Twist()
        cmd.angular.z = -gain * odom.pose.pose.position.y
        pub.publish(cmd)

    rospy.Subscriber("odom", Odometry, on_odom)
    rospy.spin()
    """,
    """
    --- launch/robot.launch.xml
    <launch>
      <node pkg="robot" exec="keeper.py" name="keeper" namespace="cart">
        <param from="$(find-pkg-share robot)/config/keeper.yaml"/>
      </node>
    </launch>
    --- config/keeper.yaml
    keeper:
      ros__parameters:
        gain: 0.8
    --- scripts/keeper.py
    import rclpy
    from rclpy.node import Node

    rclpy.init()
    node = Node("keeper")
    gain = node.declare_parameter("gain", 0.5).value
    rclpy.spin(node)
    """,
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="keeper.py" name="keeper">
        <param name="gains/left" value="0.8"/>
        <param name="limits/low" value="0.1"/>
      </node>
    </launch>
    --- scripts/keeper.py
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    def section(name, *keys):
        return [rospy.get_param("~%s/%s" % (name, key), 0.5) for key in keys]

    rospy.init_node("keeper")
    near, far = section("gains", "near", "far")
    low, left = section("limits", "low", "left")
    pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)

    def on_odom(odom):
        cmd = Twist()
        cmd.angular.z = -near * max(low, min(left, odom.pose.pose.position.y)) - far
        pub.publish(cmd)

    rospy.Subscriber("odom", Odometry, on_odom)
    rospy.spin()
    """,
)

VALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="keeper.py" name="keeper">
        <param name="gain" value="0.8"/>
      </node>
    </launch>
    --- scripts/keeper.py
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    rospy.init_node("keeper")
    gain = rospy.get_param("~gain", 0.5)
    pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)

    def on_odom(odom):
        cmd = Twist()
        cmd.angular.z = -gain * odom.pose.pose.position.y
        pub.publish(cmd)

    rospy.Subscriber("odom", Odometry, on_odom)
    rospy.spin()
    """,
    """
    --- launch/robot.launch.xml
    <launch>
      <node pkg="robot" exec="keeper.py" name="keeper" namespace="cart">
        <param from="$(find-pkg-share robot)/config/keeper.yaml"/>
      </node>
    </launch>
    --- config/keeper.yaml
    keeper:
      ros__parameters:
        gain: 0.8
    /cart/keeper:
      ros__parameters:
        gain: 0.9
    --- scripts/keeper.py
    import rclpy
    from rclpy.node import Node

    rclpy.init()
    node = Node("keeper")
    gain = node.declare_parameter("gain", 0.5).value
    rclpy.spin(node)
    """,
)

_OF_ROS: Final = frozenset(
    ["use_sim_time", "qos_overrides", "start_type_description_service", "robot_description"]
)


def findings(system: System) -> Iterator[Finding]:
    """Yield a hazard for each parameter setting that applies only to nodes without this parameter."""
    carriers: dict[Setting, list[Instance]] = {}
    for instance in system.instances:
        for setting in instance.node.settings:
            carriers.setdefault(setting, []).append(instance)
    for setting, instances in carriers.items():
        untitled = list(_untitled(setting, instances)) if system.ros2 else []
        yield from untitled
        given = _given(setting, instances) if setting.name.startswith("~") and not untitled else ()
        for name, receivers, certain in dict.fromkeys(given):
            if all(_lacks(instance, name) for instance in receivers) and (
                certain or _misspelt(name, receivers)
            ):
                first = receivers[0]
                message = f"{first.name} has no parameter {name}: the launch file sets it without effect"
                yield at_node(CODE, first, message, name)
        yield from _elsewhere(setting, instances, system)
    yield from _above(system)
    yield from _beside(system)


def _above(system: System) -> Iterator[Finding]:
    """Yield a hazard for each parameter of ROS 1 that is set outside the nodes, below the name of a node.

    Controllers and other nodes may read parameters there. The hazard is therefore reported only if the node has
    another parameter of the same setting, or a parameter with a similar name.
    """
    readers = [one for one in system.instances if one.interface is not None]
    for setting in system.settings:
        names = list(_absolute(setting))
        for instance in readers:
            above = f"{instance.name}/"
            own = [one.removeprefix(above) for one in names if one.startswith(above)]
            meant = not all(_lacks(instance, one) for one in own)
            for name in own:
                if all(_lacks(one, name) for one in readers) and (meant or _misspelt(name, [instance])):
                    message = (
                        f"{instance.name} has no parameter {name}: the launch file sets it without effect"
                    )
                    yield at_node(CODE, instance, message, name)


def _absolute(setting: Setting) -> Iterator[str]:
    """Yield the absolute names of the parameters in a setting outside nodes; none for files of ROS 2."""
    if not setting.name.startswith("/"):
        return
    parsed = _parsed(setting) if setting.yaml is not None else None
    if not isinstance(parsed, dict):
        yield from () if setting.yaml is not None else (setting.name,)
    elif not list(sections(parsed)):
        yield from (f"{setting.name.rstrip('/')}/{one.replace('.', '/')}" for one in dotted(parsed))


def _untitled(setting: Setting, instances: list[Instance]) -> Iterator[Finding]:
    """Yield a hazard for each node whose section of a parameter file of ROS 2 has no `ros__parameters`."""
    parsed = _parsed(setting) if setting.file.suffix in YAML else None
    if not isinstance(parsed, dict) or list(sections(parsed)):
        return
    for key in (str(key) for key, values in parsed.items() if isinstance(values, dict)):
        meant = [
            one
            for one in instances
            if matches(key, one.name) or key.strip("/") == one.name.rpartition("/")[2]
        ]
        if meant:
            message = (f"{meant[0].name} gets no parameter of {setting.file.name}: "
                       f"the section {key} has no {SECTION}")  # fmt: skip
            yield at_node(CODE, meant[0], message, f"{key} in {setting.file.name}")


def _beside(system: System) -> Iterator[Finding]:
    """Yield a hazard for each parameter of ROS 1 in a namespace that a node there reads only as a private parameter.

    No other node of the system may read the parameter, so all programs must have been read.
    """
    if system.ros2 or any(one.interface is None and not one.silent for one in system.instances):
        return
    for setting in system.settings:
        for whole in _absolute(setting):
            above, _, name = whole.rpartition("/")
            readers = [one for one in system.instances if one.interface and name in one.interface.words]
            meant = [one for one in readers if one.interface and name in one.interface.private
                     and one.node.namespace.rstrip("/") == above]  # fmt: skip
            given = {one.name.lstrip("~").strip("/") for reader in readers for one in reader.node.settings}
            given |= _OF_ROS
            if meant and len(meant) == len(readers) and name not in given and "" not in given:
                message = (
                    f"{meant[0].name} reads its own ~{name}: the launch file sets {whole} without effect"
                )
                yield at_node(CODE, meant[0], message, name)


def _elsewhere(setting: Setting, instances: list[Instance], system: System) -> Iterator[Finding]:
    """Yield a hazard for each section without a namespace that has the name of a node in a namespace.

    If a launch file gives a node a name different from the name in the code, the section may have the name in the
    code.
    """
    named = list(sections(_parsed(setting)))
    for pattern, values in named:
        own = pattern.strip("/")
        # a section with a namespace may be for another launch file
        if "/" in own or is_wildcard(pattern) or any(matches(pattern, one.name) for one in instances):
            continue
        meant = next(
            (one for one in instances if one.name.rpartition("/")[2] == own and "$(" not in one.name), None
        )
        if meant is None and all(one.name != f"/{own}" for one in system.instances):
            named_so = (one for one in instances if one.interface is not None and one.interface.name == own)
            meant = next((one for one in named_so if "$(" not in one.name), None)
        if meant is None:
            continue
        given = {name for other, more in named if matches(other, meant.name) for name in dotted(more)}
        lost = sorted(dotted(values).keys() - given)
        if lost:
            shown = f"{', '.join(lost[:3])}{' …' if len(lost) > 3 else ''}"
            wild = f" or /**/{own}" if meant.name.endswith(f"/{own}") else ""
            message = (f"{meant.name} does not get {shown}: the section {pattern} of {setting.file.name} is for "
                       f"/{own}; name it {meant.name}{wild}")  # fmt: skip
            yield at_node(CODE, meant, message, f"{pattern} in {setting.file.name}")


def _lacks(instance: Instance, name: str) -> bool:
    """Return whether a node certainly has no such parameter."""
    interface = instance.interface
    if interface is None or not interface.parameters or name.partition(".")[0] in _OF_ROS:
        return False
    if name in interface.public:
        return True  # the program reads the parameter from its namespace, not as a private one
    spellings = {name, name.replace(".", "/"), name.replace("/", ".")}
    known = interface.exact if interface.exact is not None else frozenset[str]()
    words = interface.words | known
    if any(one.endswith(f"/{name}") for one in words):
        return False  # the program reads the parameter by its absolute name
    # ROS 1 nodes may read a whole group of parameters; in ROS 2, `gain` is not the group of `gain.p`
    parts = name.split("/")
    if interface.exact is not None:
        above = {"/".join(parts[:number]) for number in range(1, len(parts))}
        return spellings.isdisjoint(words) and above.isdisjoint(known)
    groups = parts if len(parts) > 1 else ()
    return spellings.isdisjoint(words) and words.isdisjoint(groups) and not _joined_of(name, words)


def _joined_of(name: str, words: Collection[str]) -> bool:
    """Return whether a name may be put together from words, digits and separators."""
    reached = {0}
    for place in range(len(name)):
        if place in reached:
            reached |= {place + len(word) for word in words if word and name.startswith(word, place)}
            reached |= {place + 1} if name[place].isdigit() or name[place] in "._-/" else set()
    return len(name) in reached


def _parsed(setting: Setting) -> Any:
    """Return the parsed YAML of a setting; None if it has none, or if it cannot be read."""
    try:
        return content(setting)
    except (NoYamlError, UnreadableError):
        return None  # another part of the report names the unreadable file


def _misspelt(name: str, instances: Iterable[Instance]) -> bool:
    """Return whether a program has a string that differs from the name by one letter."""
    return any(
        spelled_alike(f"/{name}", f"/{word}")
        for one in instances
        if one.interface is not None
        for word in (*one.interface.words, *_OF_ROS)
    )


def _given(setting: Setting, instances: list[Instance]) -> Iterator[tuple[str, tuple[Instance, ...], bool]]:
    """Yield the parameters in a setting, each with the nodes for which it is meant.

    The last item of each tuple says whether the parameter is certainly meant for these nodes: a section for all
    nodes may be meant for nodes of other launch files.
    """
    above = setting.name.lstrip("~").strip("/")
    if setting.yaml is None or above:
        yield above, tuple(instances), True
        return
    parsed = _parsed(setting)
    named = list(sections(parsed))
    if not named and isinstance(parsed, dict):
        yield from ((one.replace(".", "/"), tuple(instances), True) for one in dotted(parsed))
    for pattern, values in named:
        receivers = tuple(one for one in instances if matches(pattern, one.name))
        if receivers:
            yield from ((one, receivers, not is_wildcard(pattern)) for one in dotted(values))
