"""The result of `launch` and `launch_ros` for launch files: `python ros2.py < request > answer`, with their sources.

The description is visited as the launch service does, but no process is started. Packages of the workspace are found in
their source folders, other packages and files that are not there are skipped.
"""

import json
import os
import signal
import sys
from unittest.mock import MagicMock

for absent in ("composition_interfaces", "composition_interfaces.srv"):  # interfaces that are never called
    sys.modules.setdefault(absent, MagicMock())

import ament_index_python.packages as index
import launch
import launch_ros.actions
import launch_xml
import launch_yaml
import yaml
from launch.actions import ExecuteLocal, IncludeLaunchDescription
from launch.frontend import Parser
from launch.launch_description_sources import AnyLaunchDescriptionSource

import launch_ros.descriptions.composable_node  # isort: skip

NODES = []


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
    Parser.extensions_loaded = True
    Parser.frontend_parsers = {"xml": launch_xml.Parser, "yaml": launch_yaml.Parser}
    include = IncludeLaunchDescription.execute

    def _include(self, context):
        name = "".join(one.perform(context) for one in _location(self))
        return include(self, context) if os.path.isfile(name) else []

    def _node(self, context):
        self._perform_substitutions(context)
        text = lambda value: launch.utilities.perform_substitutions(
            context, launch.utilities.normalize_to_list_of_substitutions(value)) if value is not None else ""
        NODES.append([text(self.node_package), text(self.node_executable), self.expanded_node_namespace,
                      self._Node__expanded_node_name, [list(pair) for pair in self.expanded_remapping_rules or ()],
                      _parameters(self._Node__expanded_parameter_arguments)])  # fmt: skip

    IncludeLaunchDescription.execute = _include
    launch_ros.actions.Node.execute = _node
    launch_ros.actions.ComposableNodeContainer.execute = _node
    launch_ros.actions.LoadComposableNodes.execute = lambda self, context: None
    ExecuteLocal.execute = lambda self, context: None


def _location(action):
    source = action._IncludeLaunchDescription__launch_description_source
    return source._LaunchDescriptionSource__location


def _parameters(arguments):
    """Return the parameters of a node from its files and rules, as a flat mapping by name."""
    found = {}
    for text, is_file in arguments or ():
        if is_file and os.path.isfile(text):
            with open(text) as file:
                for content in (yaml.safe_load(file) or {}).values():
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


def visit(entity, context):
    """Visit an entity and the entities it creates, except timers and event handlers."""
    for one in entity.visit(context) or ():
        if isinstance(one, launch.launch_description_entity.LaunchDescriptionEntity):
            visit(one, context)


def answer(path, arguments):
    """Return the nodes of a launch file."""
    NODES.clear()
    context = launch.LaunchContext()
    context.launch_configurations.update(arguments)
    description = IncludeLaunchDescription(AnyLaunchDescriptionSource(path))
    visit(description, context)
    return {"nodes": list(NODES)}


def main():
    request = json.load(sys.stdin)
    patch(request["packages"])
    sys.path += [place for folder in request["packages"].values() for place in (folder, f"{folder}/src")]
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
