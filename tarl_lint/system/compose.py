"""Compose a system: the nodes of a launch file, the interfaces of their programs, and the flows of each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from tarl_lint.model import Finding, Kind
from tarl_lint.read.source import SourceError
from tarl_lint.system.binding import (
    bound,
    command_line,
    fixed,
    parameter_values,
    private_values,
    undetermined,
    whole,
    with_names_in_code,
    with_prints,
)
from tarl_lint.system.called_services import PARTS, part
from tarl_lint.system.cpp_sources import is_compiled, named_topics
from tarl_lint.system.cpp_types import used_types
from tarl_lint.system.gz_bridges import bridged, own_name
from tarl_lint.system.image_transport import is_republisher, republished, transported
from tarl_lint.system.known_packages import identity, kinds, name_words, started_by, typed, unlikely
from tarl_lint.system.known_programs import stated
from tarl_lint.system.model import Hop, Instance, Interface, Role, Seen, System, full_name
from tarl_lint.system.reconfigured import with_configured
from tarl_lint.system.topic_tools import passed_on
from tarl_lint.workspace import hidden_packages
from tarl_lint.workspace.bounded_files import UnreadableError
from tarl_lint.workspace.launch_model import Launch, LaunchedNode, Setting
from tarl_lint.workspace.message_files import fields
from tarl_lint.workspace.model import Problem, Workspace
from tarl_lint.workspace.name_resolution import resolved
from tarl_lint.workspace.node_programs import Program, program
from tarl_lint.workspace.parameter_yaml import YAML, NoYamlError, content

UNKNOWN: Final = "?"
# prefix of the service of an unanalysed server
SERVER: Final = "server of "
# ROS programs that use only topics of transforms, robot models and displays
_SILENT: Final = frozenset(
    ["static_transform_publisher", "robot_state_publisher", "joint_state_publisher", "joint_state_publisher_gui",
     "state_publisher", "rqt_gui", "rqt_graph", "rqt_plot", "rqt_console", "rqt_image_view", "xacro"]
)  # fmt: skip
_NO_YAML: Final = (
    "TARL307 does not check its parameters, since reading them needs PyYAML: run pip install PyYAML"
)

# (program, known parameters) → its interface, or why it cannot be analysed
Reader = Callable[[Program, Mapping[str, object]], Interface | SourceError | str]


def composed(launch: Launch, workspace: Workspace, files: Sequence[Path], read: Reader) -> System:
    """Return the system of a launch file. `files` are the Python files of the workspace."""
    instances = _with_meant([_instance(node, launch, workspace, files, read) for node in launch.nodes])
    problems = (
        *launch.problems,
        *hidden_packages.problems(launch, workspace),
        *_unparsed(launch),
        *_cut_short(instances),
    )
    used = {use.type for one in instances if one.interface is not None for use in one.interface.uses}
    return System(
        launch.file,
        tuple(instances),
        launch.settings,
        tuple(hops(instances)),
        problems,
        messages=fields(used, workspace),
        ros2=launch.ros2,
        packages=frozenset(one.name for one in workspace.packages),
        included={one.package: started_by(one.package) for one in problems if one.hides and one.package},
    )


def _with_meant(instances: Sequence[Instance]) -> list[Instance]:
    """Return the nodes. An unread node gets those remappings of its groups that no other node of the group can use."""
    candidates: dict[tuple[str, str], list[Instance]] = {}
    for one in instances:
        for pair in one.node.remaps[: one.node.inherited]:
            if _may_use(one, pair[0]):
                candidates.setdefault(pair, []).append(one)

    def meant(one: Instance) -> tuple[tuple[str, str], ...]:
        inherited = one.node.remaps[: one.node.inherited]
        return tuple(pair for pair in inherited if candidates.get(pair) == [one])

    return [replace(one, meant=meant(one)) if _opaque(one) else one for one in instances]


def _opaque(instance: Instance) -> bool:
    """Return whether nothing but the remappings of a node is known about its topics."""
    return instance.interface is None and not instance.seen and instance.node.kind != "test"


def _may_use(instance: Instance, old: str) -> bool:
    """Return whether a node may use a name before any remapping: because it is unread, or because it uses the name."""
    if _opaque(instance):
        return not instance.silent
    own, namespace = instance.name.rpartition("/")[2], instance.node.namespace
    ends = instance.interface.endpoints if instance.interface is not None else instance.seen
    unknown = not all(one.names for one in ends)
    used = {resolved(name, namespace, own) for one in ends for name in one.names}
    return unknown or resolved(old, namespace, own) in used


def _cut_short(instances: Iterable[Instance]) -> Iterator[Problem]:
    """Yield a problem for each part of a program whose analysis exhausted the budget, once."""
    cut = {one for each in instances if each.interface is not None for one in each.interface.cut}
    for one in sorted(cut):
        yield Problem(Path(one.path), 0, one.message.removeprefix(one.path).removeprefix(":").strip())


def _unparsed(launch: Launch) -> Iterator[Problem]:
    """Yield a problem for each file with parameters, and each parameter in a launch file, that is not YAML."""
    found: dict[tuple[Path, str], None] = {}
    for setting in (*launch.settings, *(one for node in launch.nodes for one in node.settings)):
        whole = setting.name == "~" or setting.file.suffix in YAML
        if setting.yaml is None or (launch.ros2 and not whole):  # for ROS 2, other texts may be strings
            continue
        reason = _unparsable(setting)
        if reason and (whole or reason != _NO_YAML):
            found[setting.file, reason if whole else f"the parameter {setting.name}: {reason}"] = None
    yield from (Problem(file, 0, reason) for file, reason in found)


def _unparsable(setting: Setting) -> str:
    """Return why the YAML of a setting cannot be read; "" if it can be read."""
    try:
        content(setting)
    except NoYamlError:
        return _NO_YAML
    except UnreadableError as reason:
        return str(reason)
    return ""


def _instance(
    node: LaunchedNode, launch: Launch, workspace: Workspace, files: Sequence[Path], read: Reader
) -> Instance:
    found = program(node, workspace, files)
    interface = read(found, {}) if isinstance(found, Program) else found
    if isinstance(interface, Interface):
        interface = with_configured(interface, workspace)
    own = interface.name if isinstance(interface, Interface) else own_name(node)
    name = full_name(node, own)
    if isinstance(interface, Interface) and isinstance(found, Program):
        decided = _decided(node, launch, name, interface, lambda given: read(found, given))
        return Instance(node, name, with_configured(decided, workspace))
    broken = interface if isinstance(interface, SourceError) else None
    why = f"{broken.path}:{broken.line}: {broken.message}" if broken is not None else str(interface)
    unread = Instance(node, name, None, why, silent=node.executable in _SILENT, broken=broken)
    known = Seen() if isinstance(found, Program) else _known(unread, launch, workspace)
    if any(one.hides and not one.package and one.file.suffix == ".py" for one in launch.problems):
        # problems in a launch file may also hide arguments of its nodes
        known = replace(known, certain=False)
    reason = f"a C++ program of {node.package}" if known.ends else unread.unread
    return replace(unread, known=known, unread=reason)


def _known(instance: Instance, launch: Launch, workspace: Workspace) -> Seen:
    """Return the topics of a C++ program: from its source, from its arguments, or from the tables of known programs."""
    node = instance.node
    if is_republisher(node):
        return Seen(republished(instance, ros2=launch.ros2))
    values = private_values(launch, node, instance.name)
    bridge = bridged(instance, values, workspace)
    if bridge is not None:
        return bridge
    package = workspace.package(node.package)
    if package is None:
        passed = passed_on(instance, values, ros2=launch.ros2)
        found = passed if passed.ends else stated(instance, values, ros2=launch.ros2)
        inside = workspace.package(identity(node)[0])  # for a nodelet, the package of its class
        known = kinds(node) if inside is None else used_types(inside, workspace)
        found = found if found.ends else typed(instance, values, ros2=launch.ros2)
        if inside is not None:
            return replace(found, kinds=known)
        return replace(found, kinds=known, never=unlikely(node), words=name_words(node))
    ends = named_topics(package, node.executable) if node.kind == "node" else ()
    compiled = node.kind == "component" or is_compiled(package, node.executable)
    known = used_types(package, workspace) if compiled else None
    return Seen(tuple(transported(instance, ends)), kinds=known)


def _decided(
    node: LaunchedNode,
    launch: Launch,
    name: str,
    every: Interface,
    read: Callable[[Mapping[str, object]], Interface | SourceError | str],
) -> Interface:
    """Return the interface of a launched node. Pass all its parameters only if some names are unknown without them."""
    values = parameter_values(launch, node, name)
    resolve = Instance(node, name).resolve

    def named(known: Mapping[str, object]) -> Interface:
        decided = read(known) if known else every
        return bound(
            with_prints(decided, every) if isinstance(decided, Interface) else every, values, name, resolve
        )

    known = {**fixed(every.deciding, values, name), **command_line(node, launch, name)}
    first = named(known if every.deciding else {})
    if not undetermined(first):
        return first
    return with_names_in_code(named({**known, **whole(values, name)}), named({}))


def hops(instances: Sequence[Instance]) -> list[Hop]:
    """Return the flows of each node by launched topics, and the possible flows of unread nodes."""
    found: dict[tuple[str, str, str], list[Finding]] = {}
    started: dict[tuple[str, str, str], dict[LaunchedNode, None]] = {}
    for instance in instances:
        for finding, source, sink in _flows(instance):
            key = instance.name, source, sink
            found.setdefault(key, []).append(finding)
            started.setdefault(key, {})[instance.node] = None
    made = [Hop(*key, *_ranked(findings), tuple(started[key])) for key, findings in found.items()]
    published = _names(instances, "publishes")
    subscribed = _names(instances, "subscribes")
    for instance in instances:
        ends = [sorted({name for name, _ in instance.named(role)}) for role in ("subscribes", "publishes")]
        if instance.seen and instance.known.through:
            made += [_unread(instance, one, other) for one in ends[0] for other in ends[1]]
        inputs = [one for one in instance.touched if one in published]
        outputs = [one for one in instance.touched if one in subscribed and one not in published]
        made += [_unread(instance, one, other) for one in inputs for other in outputs]
    made += _chosen_by_requests(instances, made)
    made += _through_servers(instances, made)
    return sorted(made, key=lambda hop: (hop.node, hop.source, hop.sink, hop.kind))


def _chosen_by_requests(instances: Sequence[Instance], found: Sequence[Hop]) -> Iterator[Hop]:
    """Yield the possible flows of unread nodes from requests of services to published topics and responses."""
    sinks = {hop.sink for hop in found}
    asked, answered = PARTS[0]
    for instance in (one for one in instances if one.seen and one.known.through):
        published = sorted({name for name, _ in instance.named("publishes")})
        for service in sorted({name for name, _ in instance.named("serves")}):
            if service + asked in sinks:
                yield from (
                    _unread(instance, service + asked, one) for one in (*published, service + answered)
                )


def _unread(instance: Instance, source: str, sink: str) -> Hop:
    return Hop(instance.name, source, sink, "not read", started=(instance.node,))


def _through_servers(instances: Sequence[Instance], found: Sequence[Hop]) -> Iterator[Hop]:
    """Yield the possible flows of servers that were not read, from requests to responses that nodes use."""
    sinks, sources = {hop.sink for hop in found}, {hop.source for hop in found}
    served = _names(instances, "serves") | _names(instances, "performs")
    for asked, answered in PARTS:
        for sink in sorted(one for one in sinks - sources if one.endswith(asked)):
            name = sink.removesuffix(asked)
            if name + answered in sources and name + answered not in sinks and name not in served:
                yield Hop(f"{SERVER}{name}", sink, name + answered, "not read")


def _flows(instance: Instance) -> Iterator[tuple[Finding, str, str]]:
    for finding in instance.interface.flows if instance.interface is not None else ():
        flow = finding.flow
        if flow is None:
            continue
        arriving, sent = part(flow.source.api, sent=False), part(flow.sink.api, sent=True)
        for source in flow.source.topics or (UNKNOWN,):
            for sink in flow.sink.topics or (UNKNOWN,):
                yield (
                    finding,
                    UNKNOWN if source == UNKNOWN else instance.resolve(source) + arriving,
                    UNKNOWN if sink == UNKNOWN else instance.resolve(sink) + sent,
                )


def _ranked(findings: Iterable[Finding]) -> tuple[Kind, tuple[Finding, ...]]:
    """Return the kind of the strongest flow, and the flows, explicit ones first."""
    ordered = sorted(findings, key=lambda one: (one.flow is None or one.flow.kind != "explicit", one.span))
    first = ordered[0].flow
    return ("explicit" if first is not None and first.kind == "explicit" else "implicit"), tuple(ordered)


def _names(instances: Iterable[Instance], role: Role) -> frozenset[str]:
    return frozenset(name for one in instances for name, _ in one.named(role))
