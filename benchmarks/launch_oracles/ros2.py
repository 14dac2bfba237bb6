"""The result of `launch` and `launch_ros` for launch files: `python ros2.py < request > answer`, with their sources.

The description is visited as the launch service does, but no process is started. Packages of the workspace are found in
their source folders, other packages and files that are not there are skipped. Arguments without a default get their
first choice or `true`, and the answer names them. Environment variables that are required have `ENV_` and their name as
value. Commands are not run, and Python modules that are not installed are stand-ins: what they return is a path below
`/nonexistent`, which the comparison leaves out.
"""

import importlib.abc
import importlib.machinery
import json
import os
import pathlib
import signal
import sys
import types


class Request:
    """The request that a composable node is loaded with; it is never sent."""

    def __init__(self):
        self.package_name = self.plugin_name = self.node_name = self.node_namespace = ""
        self.remap_rules, self.parameters, self.extra_arguments = [], [], []


interfaces = types.ModuleType("composition_interfaces")
interfaces.srv = types.SimpleNamespace(LoadNode=types.SimpleNamespace(Request=Request))
sys.modules |= {"composition_interfaces": interfaces, "composition_interfaces.srv": interfaces.srv}

import ament_index_python.packages as index
import launch
import launch.substitutions
import launch_ros.actions
import launch_xml
import launch_yaml
import yaml
from launch.actions import ExecuteLocal, IncludeLaunchDescription
from launch.frontend import Parser
from launch.launch_description_sources import AnyLaunchDescriptionSource

import launch_ros.descriptions.composable_node  # isort: skip
from launch_ros.actions.load_composable_nodes import get_composable_node_load_request  # isort: skip
from rclpy.parameter import parameter_value_to_python  # isort: skip

NODES = []
GIVEN = {}  # values of arguments without a default
ABSENT = "/nonexistent/module"


class StandIn(str):
    """A text in place of whatever a module that is not installed returns."""

    def __new__(cls, *_, **__):
        return super().__new__(cls, ABSENT)

    def __call__(self, *_, **__):
        return StandIn()

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return StandIn()

    def keys(self):
        return []

    def __getitem__(self, key):
        return str(self)[key] if isinstance(key, (int, slice)) else StandIn()


class StandIns(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Import modules that are not installed as stand-ins; `launch` and `launch_ros` are there as a whole."""

    def find_spec(self, fullname, path=None, target=None):
        top = fullname.partition(".")[0]
        if top in ("launch", "launch_ros", "launch_xml", "launch_yaml", "rclpy", *self.own):
            return None
        return importlib.machinery.ModuleSpec(fullname, self, is_package=True)

    def create_module(self, spec):
        module = types.ModuleType(spec.name)
        module.__getattr__ = lambda name: absent_attribute(name)
        return module

    def exec_module(self, module):
        pass


def absent_attribute(name):
    if name.startswith("__"):
        raise AttributeError(name)
    return StandIn()


class PathSubstitution(launch.substitutions.PathJoinSubstitution):
    """`PathSubstitution` of newer versions of launch, whose parts `/` joins."""

    def __init__(self, path):
        super().__init__([path])

    def __truediv__(self, other):
        joined = PathSubstitution("")
        joined._PathJoinSubstitution__substitutions = [
            *self.substitutions, *launch.utilities.normalize_to_list_of_substitutions(other)]  # fmt: skip
        return joined



def patch(packages):
    """Make launch find packages of the workspace, and record nodes instead of starting them."""
    home = os.path.dirname(os.path.dirname(launch.__file__))
    packages = {"launch": f"{home}/share/launch", **packages}
    absent = lambda name: packages.get(name, f"/absent/{name}")
    for module in list(sys.modules.values()):
        for name in ("get_package_share_directory", "get_package_prefix"):
            if getattr(module, name, None) is not None:
                setattr(module, name, absent)
    index.get_package_share_directory = index.get_package_prefix = absent
    index.get_packages_with_prefixes = lambda: packages
    index.get_package_share_path = lambda name: pathlib.Path(absent(name))
    os.environ.setdefault("AMENT_PREFIX_PATH", "/absent")
    patch_surroundings()
    accept_old_names()
    Parser.extensions_loaded = True
    Parser.frontend_parsers = {"xml": launch_xml.Parser, "yaml": launch_yaml.Parser}
    include = IncludeLaunchDescription.execute

    def _include(self, context):
        name = "".join(one.perform(context) for one in _location(self))
        if not os.path.isfile(name):
            return []
        if not getattr(context, "is_inside", False):
            context.is_inside = True
            _give(self, context)
        return include(self, context)

    def _node(self, context):
        self._perform_substitutions(context)
        text = lambda value: launch.utilities.perform_substitutions(
            context, launch.utilities.normalize_to_list_of_substitutions(value)) if value is not None else ""
        NODES.append([text(self.node_package), text(self.node_executable), self.expanded_node_namespace,
                      self._Node__expanded_node_name, [list(pair) for pair in self.expanded_remapping_rules or ()],
                      {**_shared(context), **_parameters(self._Node__expanded_parameter_arguments)}])  # fmt: skip

    IncludeLaunchDescription.execute = _include
    launch_ros.actions.Node.execute = _node
    launch_ros.actions.LoadComposableNodes.execute = _components
    for kind in (ExecuteLocal, launch.actions.TimerAction, launch_ros.actions.RosTimer):
        kind.execute = lambda self, context: None


def patch_surroundings():
    """Replace what depends on the machine: environment, commands, programs, and newer classes of launch."""
    substitutions = launch.substitutions
    if not hasattr(substitutions, "PathSubstitution"):
        substitutions.PathSubstitution = PathSubstitution
        substitutions.PathJoinSubstitution.__truediv__ = PathSubstitution.__truediv__
    environment = type(os.environ)
    find = environment.__getitem__
    environment.__contains__ = lambda self, name: name in list(self)
    environment.__getitem__ = lambda self, name: (
        find(self, name) if name in list(self) or isinstance(name, bytes) else f"ENV_{name}")  # fmt: skip
    environment.get = lambda self, name, default=None: find(self, name) if name in list(self) else default
    variable = substitutions.EnvironmentVariable.perform

    def _variable(self, context):
        try:
            return variable(self, context)
        except substitutions.substitution_failure.SubstitutionFailure:
            return "ENV_" + launch.utilities.perform_substitutions(context, self.name)

    substitutions.EnvironmentVariable.perform = _variable
    substitutions.AnonName.perform = lambda self, context: launch.utilities.perform_substitutions(context, self.name)
    substitutions.Command.perform = lambda self, context: "/nonexistent/command"
    substitutions.FindExecutable.perform = lambda self, context: "/nonexistent/executable"


def accept_old_names():
    """Let nodes have the keywords of ROS 2 Eloquent: `node_executable`, `node_name`, `node_namespace`."""
    made = launch_ros.actions.Node.__init__

    def _make(self, **keywords):
        made(self, **{name.removeprefix("node_"): value for name, value in keywords.items()})

    launch_ros.actions.Node.__init__ = _make


def _give(action, context):
    """Give the arguments of a launch file that have no default a value."""
    description = action._IncludeLaunchDescription__launch_description_source.get_launch_description(context)
    for one in description.get_launch_arguments(conditional_inclusion=True):
        if one.default_value is None and one.name not in context.launch_configurations:
            GIVEN[one.name] = one.choices[0] if one.choices else "true"
    context.launch_configurations.update(GIVEN)
    action._IncludeLaunchDescription__launch_arguments = tuple(
        {**{name: value for name, value in action.launch_arguments}, **GIVEN}.items())  # fmt: skip


def _location(action):
    source = action._IncludeLaunchDescription__launch_description_source
    return source._LaunchDescriptionSource__location


def _shared(context):
    """Return the parameters that the launch file sets for all nodes that follow."""
    given = context.launch_configurations.get("global_params", ())
    return {one[0]: list(one[1]) if isinstance(one[1], tuple) else one[1] for one in given if isinstance(one, tuple)}


class _Loader(yaml.SafeLoader):
    """Reads tuples, which launch_ros writes into parameter files, as lists."""


_Loader.add_constructor("tag:yaml.org,2002:python/tuple", lambda loader, node: loader.construct_sequence(node))


def _parameters(arguments):
    """Return the parameters of a node from its files and rules, as a flat mapping by name."""
    found = {}
    for text, is_file in arguments or ():
        if ABSENT in str(text):
            found["*"] = ABSENT  # some parameters come from a module that is not installed
        elif is_file and os.path.isfile(text):
            with open(text) as file:
                for content in (yaml.load(file, _Loader) or {}).values():
                    if isinstance(content, dict):
                        found.update(_flat(content.get("ros__parameters") or {}))
        elif not is_file:
            name, _, value = str(text).partition(":=")
            found[name] = yaml.safe_load(value)
    return found


def _flat(values, above=""):
    found = {}
    for name, value in values.items():
        found.update(_flat(value, f"{above}{name}.") if isinstance(value, dict) else {f"{above}{name}": value})
    return found


def _components(action, context):
    """Record composable nodes, which a container would be asked to load."""
    for one in action._LoadComposableNodes__composable_node_descriptions:
        asked = get_composable_node_load_request(one, context)
        if asked is None:
            continue
        rules = [rule.split(":=", 1) for rule in asked.remap_rules]
        values = {value.name: parameter_value_to_python(value.value) for value in asked.parameters}
        NODES.append([asked.package_name, asked.plugin_name, asked.node_namespace, asked.node_name, rules, values])


def _later(entity):
    if isinstance(entity, launch.actions.RegisterEventHandler):
        return getattr(entity.event_handler, "_OnActionEventBase__actions_on_event", ())
    return entity.actions if isinstance(entity, launch.actions.TimerAction) else ()


def visit(entity, context):
    """Visit an entity and the entities it creates, also those that a timer or an event of a process starts."""
    for one in (*(entity.visit(context) or ()), *_later(entity)):
        if isinstance(one, launch.launch_description_entity.LaunchDescriptionEntity):
            visit(one, context)


def answer(path, arguments):
    """Return the nodes of a launch file."""
    NODES.clear()
    GIVEN.clear()
    context = launch.LaunchContext()
    context.launch_configurations.update(arguments)
    description = IncludeLaunchDescription(AnyLaunchDescriptionSource(path))
    visit(description, context)
    return {"nodes": list(NODES), "arguments": dict(GIVEN)}


def main():
    request = json.load(sys.stdin)
    patch(request["packages"])
    sys.path += [place for folder in request["packages"].values() for place in (folder, f"{folder}/src")]
    StandIns.own = set(request["packages"])
    sys.meta_path.append(StandIns())
    signal.signal(signal.SIGALRM, lambda *_: (_ for _ in ()).throw(TimeoutError("it takes too long")))
    answers, out = [], os.dup(1)
    os.dup2(2, 1)
    for file in request["files"]:
        try:
            signal.alarm(20)
            answers.append(answer(file["path"], file["arguments"]))
        except BaseException as error:
            answers.append({"error": " ".join(str(error).split())[:300] or type(error).__name__})
    with os.fdopen(out, "w") as stream:
        json.dump(answers, stream, default=str)
        signal.alarm(0)
    os._exit(0)  # end without waiting for threads of rclpy, which would never end


if __name__ == "__main__":
    main()
