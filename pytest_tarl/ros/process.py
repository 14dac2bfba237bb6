"""A started program, with what an operating system process has: arguments, tasks, shutdown."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any, TypeVar

from pytest_tarl.errors import NodeError, StuckNodeError, TarlError, UnsupportedApiError, text_of
from pytest_tarl.ros import blame
from pytest_tarl.ros.bus import Bus
from pytest_tarl.ros.exiting import ProcessExit
from pytest_tarl.ros.launch_sources import NOTHING
from pytest_tarl.ros.node_advice import advice
from pytest_tarl.ros.parameter_server import ParameterServer
from pytest_tarl.ros.scheduler import Scheduler, Spinning, Task, current_task, running_task
from pytest_tarl.ros.services import ServiceDirectory
from pytest_tarl.ros.watchdog import WATCHDOG

Part = TypeVar("Part")

_PATIENCE = 1_000  # a task counts as ignoring the shutdown if more than this many of its waits return at once
_LONGEST = 100  # maximum characters of a node's last words in a message
_ROUNDS = 5  # maximum number of rounds for an ending process's tasks, before they are killed


class Network:
    """What the processes of an episode share: clock, topics, services and parameters.

    `part` has state that a client library shares between processes, such as its actions.
    """

    def __init__(
        self,
        run: Callable[..., None],
        parameters: Mapping[str, Any],
        remappings: Mapping[str, str],
        watchdog_limit: float,
    ) -> None:
        self.parameters = dict(parameters)
        self.remappings = dict(remappings)
        self.watchdog_limit = watchdog_limit
        self.scheduler = Scheduler()
        self.services = ServiceDirectory(self.scheduler)
        self.bus = Bus(self.scheduler, run, self.services)
        self.processes: list[Process] = []
        # absolute parameter name → number, for parameters that nodes have read
        self.parameters_read: dict[str, bool | int | float] = {}
        self._parts: dict[Any, Any] = {}

    def read(self, name: str, value: Any) -> None:
        """Note that a node reads a parameter: its number, or all numbers of a subtree."""
        if isinstance(value, Mapping):
            for key, inner in value.items():
                self.read(f"{name}/{key}", inner)
        elif isinstance(value, int | float):
            self.parameters_read[name] = value

    @cached_property
    def parameter_server(self) -> ParameterServer:
        """The ROS 1 parameters, filled from `parameters` on first use."""
        return ParameterServer(self.parameters)

    def part(self, kind: Callable[[Network], Part]) -> Part:
        """Return this episode's instance of `kind`; create it on first use."""
        if kind not in self._parts:
            self._parts[kind] = kind(self)
        found: Part = self._parts[kind]
        return found


class Process:
    """A program, and the global state of rospy or rclpy in its interpreter (`part`)."""

    def __init__(self, ros: Network, name: str, argv: Sequence[str]) -> None:
        self.ros = ros
        self.name = name
        self.argv = tuple(argv)
        self.tasks: list[Task] = []
        self.main: Task | None = None
        self.program: Callable[[], None] = lambda: None
        self.ending = False
        self.ended = False
        self._closing = False
        self._refused = 0
        self.launched = NOTHING  # parameters from a launch file
        self.unset: dict[str, None] = {}  # missing parameters that the node asked for, by the names it used
        self.label = name  # name shown in messages; changes to the node's name once known
        self.errors: list[NodeError] = []  # errors while shutting down
        self._parts: dict[Any, Any] = {}
        self._at_end: list[Callable[[], None]] = []

    @property
    def scheduler(self) -> Scheduler:
        """The episode's clock."""
        return self.ros.scheduler

    @property
    def bus(self) -> Bus:
        """The episode's bus."""
        return self.ros.bus

    def part(self, kind: Callable[[Process], Part]) -> Part:
        """Return this process's instance of `kind`; create it on first use."""
        if kind not in self._parts:
            self._parts[kind] = kind(self)
        found: Part = self._parts[kind]
        return found

    def at_end(self, hook: Callable[[], None]) -> None:
        """Register `hook` for shutdown; it is called before tasks are woken."""
        self._at_end.append(hook)

    def run(self, program: Callable[[], None]) -> None:
        """Start the main program."""
        self.program = program
        self.scheduler.spawn(self, self._run_main, program)

    def _run_main(self, program: Callable[[], None]) -> None:
        self.main = current_task()
        program()

    def failed(self, task: Task, error: BaseException) -> None:
        """Handle the exception that ended a task; if the node raised it, it becomes a NodeError."""
        if self.ending and getattr(error, "tarl_shutdown", False):
            return
        if isinstance(error, Spinning):
            self.scheduler.failure = self.spins(blame.of_traceback(error.__traceback__))
        elif isinstance(error, SystemExit):
            whole = task is self.main or isinstance(error, ProcessExit)
            if whole and error.code not in (None, 0) and not self.ending:
                self._fail(self._ended_in(error))
            elif whole and task is not self.main and not self._closing:
                self.scheduler.later(self.end)
        elif isinstance(error, TarlError | KeyboardInterrupt) or _of_pytest(error):
            self._fail(error)  # Ctrl-C by the user, or an error that the node did not cause
        else:
            self._fail(self._ended_in(error))

    def finished(self, task: Task) -> None:
        """Remove an ended task; if it was the main program, end the process."""
        if task in self.tasks:
            self.tasks.remove(task)
        if task is self.main and not self._closing:
            self.scheduler.later(self.end)

    def end(self) -> None:
        """End the process: call hooks, let every task return, then kill the rest. Call this outside tasks."""
        if self._closing:
            return
        self._closing = True
        if not self.ending:
            self.ask_to_end()
        for _ in range(_ROUNDS):
            self.scheduler.settle()
            if not self.tasks:
                break
            for task in tuple(self.tasks):
                self.scheduler.wake(task)
        for _ in range(_ROUNDS):
            for task in tuple(self.tasks):
                self.scheduler.kill(task)
        self.ended = True
        self.bus.disconnect(self)

    def kill(self) -> None:
        """End the process at once, without hooks, as SIGKILL does. Call this outside tasks."""
        self._closing = self.ending = True
        for _ in range(_ROUNDS):
            for task in tuple(self.tasks):
                self.scheduler.kill(task)
        self.ended = True
        self.bus.disconnect(self)

    def ask_to_end(self) -> None:
        """Mark the process as ending, call the hooks, and wake every task."""
        self.ending = True
        for hook in self._at_end:
            hook()
        for task in tuple(self.tasks):
            self.scheduler.wake(task)

    def refuse_to_wait(self) -> None:
        """Count a refused wait; suspend a task that tries too often."""
        self._refused += 1
        while self._refused > _PATIENCE:
            self.scheduler.wait()

    def spins(self, place: blame.Place | None) -> NodeError:
        """Return the error for a node that never waits."""
        return StuckNodeError(
            f"Node {self.label!r} never waits: {WATCHDOG.hanging(self.ros.watchdog_limit)} passed while "
            f"virtual time stood still, at {blame.describe(place)}. Call Rate.sleep(), rospy.sleep() or a "
            "spin function in "
            "that loop."
        )

    def _ended_in(self, error: BaseException) -> NodeError:
        what = (
            f"exited with status {_status(error)}"
            if isinstance(error, SystemExit)
            else f"raised {type(error).__name__}: {text_of(error)}"
        )
        where = blame.describe(getattr(error, "tarl_place", None) or blame.of_traceback(error.__traceback__))
        hint = advice(error, self.launched, tuple(self.unset))
        failure = NodeError(f"Node {self.label!r} {what} ({where}). {hint}".rstrip())
        failure.__cause__ = error
        return failure

    def _fail(self, error: BaseException) -> None:
        if self.ending and isinstance(error, NodeError):
            self.errors.append(error)
        elif self.scheduler.failure is None:
            self.scheduler.failure = error


def _status(error: SystemExit) -> str:
    """Return the exit status; for an exit with a string, 1 and its first line."""
    if isinstance(error.code, int):
        return str(error.code)
    first = next((one.strip() for one in text_of(error.code).splitlines() if one.strip()), "")
    return f"1: {first[:_LONGEST]}{'…' if len(first) > _LONGEST else ''}"


def _of_pytest(error: BaseException) -> bool:
    """Return whether an exception is from pytest.fail, skip or exit, without importing pytest."""
    return any(kind.__module__ == "_pytest.outcomes" for kind in type(error).__mro__)


def running_process() -> Process | None:
    """Return the process of the running task, or None outside nodes."""
    task = running_task()
    return task.process if task is not None and isinstance(task.process, Process) else None


def current_process(api: str) -> Process:
    """Return the process of the running task. Raise UnsupportedApiError outside nodes."""
    process = running_process()
    if process is not None:
        return process
    raise UnsupportedApiError(
        f"{api} was called outside a node, or from a thread that the node started: the in-process ROS "
        "serves only programs started by tarl.start(…), and each only in the thread in which it was "
        "started. In the test itself use "
        "tarl.bus and tarl.step."
    )
