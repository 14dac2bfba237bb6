"""The node of a process: name, initialisation, shutdown."""

# ruff: noqa: ARG001 (signatures are rospy's)

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from pytest_tarl.errors import RecordingError
from pytest_tarl.ros import names
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.process import Process, current_process
from pytest_tarl.ros.rospy.exceptions import ROSException, ROSInitException
from pytest_tarl.ros.scheduler import Task, running_task
from pytest_tarl.ros_names import is_legal_ros1, is_refused_by_master

DEBUG, INFO, WARN, ERROR, FATAL = 1, 2, 4, 8, 16

ShutdownHook = Callable[[], Any]


class RospyNode:
    """rospy's global state in one process."""

    def __init__(self, process: Process) -> None:
        self.process = process
        self.command_line = names.parse_ros1(process.argv[1:])
        self.namespace = names.absolute(self.command_line.namespace or "/")
        self.name = names.expand("unnamed", names.absolute(f"{self.namespace}/_"))
        self.initialised = False
        self.in_hooks = False
        self.hooks: list[ShutdownHook] = []
        self.remappings: Mapping[str, str] = {**process.ros.remappings, **self.command_line.remappings}
        process.at_end(self.run_hooks)

    def resolve(self, name: str) -> str:
        """Resolve the name of a topic, service or parameter."""
        return names.resolve(name, self.name, self.remappings)

    def require_registrable(self, name: str, kind: str) -> None:
        """End the episode with an error if the ROS master would reject a topic or service of this name.

        rospy would log the rejection and shut the node down.
        """
        if is_refused_by_master(name):
            scheduler = self.process.scheduler
            scheduler.failure = scheduler.failure or RecordingError(
                f"Node {self.process.label!r} names a {kind} {name!r}. The master of ROS 1 refuses names with a space "
                "or a colon and the node shuts down: correct the name in the node or its remapping."
            )

    def initialise(self, name: str, *, anonymous: bool) -> None:
        """Set the name, then the private parameters from the test and the command line."""
        name = self.command_line.name or name
        if anonymous and self.command_line.name is None:
            name = f"{name}_{len(self.process.ros.processes)}_{self.process.scheduler.time // 1_000_000}"
        self.name = self.process.label = names.absolute(f"{self.namespace}/{name}")
        self.initialised = True
        server = self.process.ros.parameter_server
        server.enter_node(self.name)
        for key, value in self.process.launched.private.items():
            server.fill(f"{self.name}/{key}", value)
        for key, value in self.command_line.parameters.items():
            server.set(names.expand(key, self.name), value)

    def require(self) -> None:
        """Raise ROSInitException before `init_node`."""
        if not self.initialised:
            raise ROSInitException("time is not initialized. Have you called init_node()?")

    def run_hooks(self) -> None:
        """Call the shutdown hooks in a task of this process; if one fails, the others still run."""
        if self.in_hooks:
            return
        self.in_hooks = True
        task = running_task()
        if task is not None:
            self._call_hooks(task)
            self._hooks_done()
            return
        for hook in self.hooks:
            self.process.scheduler.spawn(self.process, hook)
        self.process.scheduler.later(self._hooks_done)

    def _call_hooks(self, task: Task) -> None:
        for hook in self.hooks:
            try:
                hook()
            except Exception as error:  # noqa: PERF203 (rospy prints it and goes on)
                self.process.failed(task, error)

    def _hooks_done(self) -> None:
        self.in_hooks = False


def this_node(api: str) -> RospyNode:
    """Return the node of the running program."""
    return current_process(f"rospy.{api}").part(RospyNode)


def warn_if_illegal(name: str, *, stacklevel: int) -> None:
    """Warn, as rospy does, about a topic, service or parameter name that breaks the rules."""
    if name and not is_legal_ros1(name):
        warnings.warn(
            f"'{name}' is not a legal ROS graph resource name. This may cause problems with other ROS tools",
            stacklevel=stacklevel,
        )


def init_node(
    name: str,
    argv: Sequence[str] | None = None,
    anonymous: bool = False,
    log_level: int | None = None,
    disable_rostime: bool = False,
    disable_rosout: bool = False,
    disable_signals: bool = False,
    xmlrpc_port: int = 0,
    tcpros_port: int = 0,
    **_: Any,
) -> None:
    """Register the node under its name.

    Raise ValueError for an invalid name, and ROSException for a second call with different arguments.
    """
    if not name:
        raise ValueError("name must not be empty")
    if "/" in name:
        raise ValueError("namespaces are not allowed in node names")
    node = this_node("init_node")
    if argv is not None:
        node.command_line = names.parse_ros1(argv)
    if node.initialised and not anonymous and not node.name.endswith("/" + name):
        raise ROSException("rospy.init_node() has already been called with different arguments: " + node.name)
    if not is_legal_ros1(name) or name[0] == "~":
        warnings.warn(
            f"'{name}' is not a legal ROS base name. This may cause problems with other ROS tools.",
            stacklevel=2,
        )
    if not node.initialised:
        node.initialise(name, anonymous=anonymous)


def is_shutdown() -> bool:
    """Return whether the node is shutting down."""
    process = current_process("rospy.is_shutdown")
    asked()
    return process.ending


def signal_shutdown(reason: str) -> None:
    """Shut the node down: call the hooks now, then interrupt every wait of the node."""
    process = current_process("rospy.signal_shutdown")
    if not process.ending:
        process.part(RospyNode)
        process.ask_to_end()


def on_shutdown(h: ShutdownHook) -> None:
    """Register a function for shutdown. Raise TypeError if it is not callable."""
    if not callable(h):
        raise TypeError(f"shutdown hook [{h}] must be a function or callable object: {type(h)}")
    this_node("on_shutdown").hooks.append(h)


def spin() -> None:
    """Wait until the node is shut down, while callbacks run. Raise ROSInitException before init_node."""
    node = this_node("spin")
    if not node.initialised:
        raise ROSInitException("client code must call rospy.init_node() first")
    while not node.process.ending:
        node.process.scheduler.wait()


def get_name() -> str:
    """Return the node's resolved name."""
    return this_node("get_name").name


def get_caller_id() -> str:
    """Return the node's resolved name."""
    return this_node("get_caller_id").name


def get_namespace() -> str:
    """Return the node's namespace with a trailing slash."""
    namespace = this_node("get_namespace").namespace
    return namespace if namespace == "/" else namespace + "/"


def resolve_name(name: str, caller_id: str | None = None) -> str:
    """Resolve a name in the node's namespace."""
    node = this_node("resolve_name")
    return names.resolve(name, caller_id or node.name, node.remappings)


remap_name = resolve_name


def myargv(argv: Sequence[str] | None = None) -> list[str]:
    """Return the command line without ROS arguments."""
    process = current_process("rospy.myargv")
    return [argument for argument in (process.argv if argv is None else argv) if ":=" not in argument]


def get_node_uri() -> str:
    """Return a dummy address: there is no network."""
    return "http://localhost:0/"


def get_ros_root(required: bool = False, env: Any = None) -> str | None:
    """Return None: no ROS installation is used."""
    return None
