"""One episode of the in-process ROS, as tests use it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from pytest_tarl.errors import NodeError, SettingsError
from pytest_tarl.ros.argv import command_line
from pytest_tarl.ros.clock import nanoseconds, seconds
from pytest_tarl.ros.install import standins_installed
from pytest_tarl.ros.keyboard import Terminal
from pytest_tarl.ros.launch_sources import NOTHING, Given
from pytest_tarl.ros.messages import node_workspaces
from pytest_tarl.ros.names import require_remapping
from pytest_tarl.ros.process import Network, Process
from pytest_tarl.ros.scheduler import Spinning, running_task
from pytest_tarl.ros.uninstalled import UninstalledFinder
from pytest_tarl.ros.watchdog import DEFAULT_LIMIT, WATCHDOG


class Ros(Network):
    """Nodes, their bus and their clock, for one episode.

    Every node gets `parameters` (`kp`, `~kp` or `/node/kp`) and `remappings` (old → new name). `watchdog_limit` is the
    CPU time in seconds after which a node that does not wait is stopped.
    """

    def __init__(
        self,
        *,
        parameters: Mapping[str, Any] | None = None,
        remappings: Mapping[str, str] | None = None,
        watchdog_limit: float = DEFAULT_LIMIT,
    ) -> None:
        for old, new in (remappings or {}).items():
            require_remapping(old, new)
        super().__init__(self._run, parameters or {}, remappings or {}, watchdog_limit)
        self.uninstalled = UninstalledFinder()
        self._launched = NOTHING  # launch-file parameters for the next node
        self._launch_notes: list[str] = []
        self.closed = False

    @property
    def now(self) -> float:
        """Virtual seconds since the episode began, as on the nodes' clock."""
        return seconds(self.scheduler.time)

    @property
    def alive(self) -> bool:
        """Return whether the main program of any node is still running."""
        return any(not process.ended for process in self.processes)

    @property
    def published(self) -> Counter[str]:
        """Number of messages that nodes have published, by topic."""
        return self.bus.published

    @property
    def silent(self) -> bool:
        """Whether no node has published a message or called a service yet."""
        return not self.published and not self.services.requests

    @property
    def subscribed(self) -> set[str]:
        """Topics that nodes have subscribed to."""
        return self.bus.subscribed

    @property
    def shutdown_errors(self) -> tuple[NodeError, ...]:
        """Errors that nodes raised while shutting down; they do not fail the episode, which is already over."""
        return tuple(error for process in self.processes for error in process.errors)

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences for the user about how the nodes were started."""
        return (*self._launch_notes, *self.uninstalled.notes(), *self._silent_terminals())

    def type(self, text: str, node: str | None = None) -> None:
        """Type text on the terminals of all nodes, or of those named `node`, which may be a script's path.

        Raise SettingsError if there is none.
        """
        called = set() if node is None else {node, _program(node)}
        living = [one for one in self.processes if not one.ended]
        running = living if node is None else [one for one in living if called & {one.name, one.label}]
        if not running:
            which = "no node is running" if node is None else f"no running node is called {node!r}"
            raise SettingsError(
                f"tarl.type: {which}. Start it first; use its path, the name given to tarl.start, or its ROS name."
            )
        for process in running:
            process.part(Terminal).type(text)

    def _silent_terminals(self) -> list[str]:
        """Return a sentence for each node that waited for keys when the test typed none."""
        terminals = [(one.label, one.part(Terminal)) for one in self.processes]
        return [
            f"Node {label!r} waits for the keyboard, but the test types nothing: call tarl.type(text)."
            for label, terminal in terminals
            if terminal.waited and not terminal.used
        ]

    def give(self, parameters: Mapping[str, Any]) -> None:
        """Add parameters for every node that starts from now on."""
        self.parameters.update(parameters)
        if "parameter_server" in self.__dict__:
            self.parameter_server.take(parameters)

    def launch(self, given: Given) -> None:
        """Set launch-file parameters for the next node; the test's own parameters take precedence."""
        self._launched = given
        if given.note:
            self._launch_notes.append(given.note)

    def note(self, sentence: str) -> None:
        """Add a sentence for the user about how the nodes were started."""
        self._launch_notes.append(sentence)

    def use_definitions_around(self, folder: Path, test: Path) -> None:
        """Load the message, service and action definitions of the workspace that contains `folder`.

        Without a workspace, load those in the test's folder or beside it.
        """
        node_workspaces.search(folder, test)

    def start(self, run: Callable[[], None], *, name: str, argv: Sequence[str] = ()) -> None:
        """Run a node's main program until it first waits. Raise NodeError if it raises."""
        process = Process(self, name, (name, *argv))
        process.launched, self._launched = self._launched, NOTHING
        for key, value in process.launched.shared.items():
            self.parameter_server.fill(key, value)
        self.processes.append(process)
        with command_line(process.argv):
            self._run(process.run, run)

    def spawn(self, process: Process, function: Callable[..., None], *arguments: Any) -> None:
        """Run a function as a task of a process until it first waits."""
        if running_task() is not None:
            self.scheduler.spawn(process, function, *arguments)
        else:
            self._run(self.scheduler.spawn, process, function, *arguments)

    def interrupt(self, name: str, at: float, outage: float) -> None:
        """Kill the node `name` at time `at` (s), and restart it `outage` seconds later."""

        def kill() -> None:
            running = next((one for one in self.processes if one.name == name and not one.ended), None)
            if running is None:
                return
            running.kill()
            self.scheduler.at(self.scheduler.time + nanoseconds(outage), lambda: revive(running))

        def revive(old: Process) -> None:
            process = Process(self, name, old.argv[1:])
            process.launched = old.launched
            self.processes.append(process)
            with command_line(process.argv):
                process.run(old.program)

        self.scheduler.at(nanoseconds(at), kill)

    def step(self, dt: float) -> None:
        """Advance virtual time by `dt` seconds; run all tasks that become due, until every node waits again.

        Raise NodeError if a node raises or never waits.
        """
        self._run(self.scheduler.advance, self.scheduler.time + nanoseconds(dt))

    def on_delivery(self, listener: Callable[[str, Any], None]) -> None:
        """Call `listener(topic, message)` for every message before any subscriber receives it."""
        self.bus.observe(listener)

    def installed(self) -> AbstractContextManager[None]:
        """Make rospy, rclpy and the message packages importable; restore the previous modules on exit."""
        return standins_installed(self.scheduler, self.uninstalled, self.processes)

    def close(self) -> None:
        """End every node as ROS does, then discard all state. Raise NodeError for a node that does not end."""
        if self.closed:
            return
        self.closed = True
        self.scheduler.failure = None
        failures = []
        for process in self.processes:
            try:
                self._run(process.end)
            except Exception as error:  # noqa: PERF203 (the other nodes must end as well)
                failures.append(error)
        self.scheduler.close()
        if failures:
            raise failures[0]

    def _run(self, job: Callable[..., object], *args: object) -> None:
        """Call a function that lets nodes run, under the watchdog; raise the nodes' errors."""
        if running_task() is not None:
            raise NodeError(
                "A node called step(), start() or close() of the episode that runs it: only the test may "
                "call them."
            )
        scheduler = self.scheduler
        WATCHDOG.arm(self.watchdog_limit)
        try:
            try:
                job(*args)
                scheduler.settle()
            finally:
                spun = WATCHDOG.disarm()
        except Spinning:
            spun = True
            # needed only if the exception interrupted the first call
            WATCHDOG.disarm()
        if spun and scheduler.failure is None:
            scheduler.failure = scheduler.spinning()
        if scheduler.failure is not None:
            failure, scheduler.failure = scheduler.failure, None
            raise failure


def _program(node: str) -> str:
    """Return the name that `tarl.start` gives to a script, from its path; names of ROS nodes stay unchanged."""
    return node if node.startswith("/") else Path(node).stem
