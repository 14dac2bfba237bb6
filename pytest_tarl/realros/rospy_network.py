"""The ROS 1 network of a test run: master, world's node and nodes under test, kept between episodes."""

from __future__ import annotations

import warnings
import xmlrpc.client
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from time import monotonic, sleep
from typing import Any

from pytest_tarl.errors import NodeError, RecordingError
from pytest_tarl.realros.lockstep import PATIENCE, Way, Wire, WireScheduler
from pytest_tarl.realros.rospy_copy import RospyCopy
from pytest_tarl.realros.service_calls import ServiceCalls
from pytest_tarl.ros.messages.snapshot import snapshot
from pytest_tarl.ros.names import absolute
from pytest_tarl.ros.process import Process
from pytest_tarl.ros.scheduler import Task, running_task
from pytest_tarl.ros.watchdog import WATCHDOG
from pytest_tarl.rosmaster import Master

WORLD = "tarl_world"
_BASE = frozenset({"/run_id", "/rosdistro", "/rosversion"})


class RospyNetwork:
    """The network of a test run.

    The episode sets `scheduler` and the two callbacks. `patch` makes a copy of rospy run in lock-step.
    """

    def __init__(self, patch: Callable[[RospyCopy, RospyNetwork], None]) -> None:
        self._patch = patch
        self.master = Master()
        self.wire = Wire()
        self.scheduler = WireScheduler()
        self.calls = ServiceCalls(self.scheduler)
        self.listening: list[Task] = []  # tasks to wake when a message arrives
        self.in_hooks = False
        self.parameters: Mapping[str, Any] = {}
        self.node_publishes: Callable[[str, Any], None] | None = None
        self.node_subscribes: Callable[[str], None] | None = None
        self._kept: dict[tuple[str, ...], RospyCopy] = {}
        self._copies: dict[Process, RospyCopy] = {}
        self._server = xmlrpc.client.ServerProxy(self.master.uri)
        self.world = self._made((WORLD,))
        self.world.register(WORLD, {"argv": [WORLD], "disable_rosout": True})

    def close(self) -> None:
        """Shut every node down, then the master."""
        for copy in (*self._kept.values(), self.world):
            copy.close()
        self._server("close")()
        self.master.close()

    def begin(self, scheduler: WireScheduler, parameters: Mapping[str, Any]) -> None:
        """Start an episode with an empty parameter server."""
        self.wire.forget()
        self.scheduler, self.parameters, self.in_hooks = scheduler, parameters, False
        self.calls = ServiceCalls(scheduler)
        self.listening.clear()
        for name in set(self._call("getParamNames")) - _BASE:
            self._call("deleteParam", name)
        for name, value in parameters.items():
            if not name.startswith("~"):
                self.world.rospy.set_param(absolute(name), value)

    def end(self) -> None:
        """End the episode."""
        for copy in self._copies.values():
            copy.end()
        self._copies.clear()
        self.wire.forget()

    def enter(self, process: Process) -> None:
        """Give a starting process a copy of rospy; if possible, the one that it had in the last episode."""
        if process in self._copies:
            return
        key, number = process.argv, 0
        while (copy := self._kept.get((*key, str(number)))) is not None and copy.process is not None:
            number += 1  # another process of the same program already has this copy in this episode
        if copy is None:
            copy = self._kept[(*key, str(number))] = self._made(key)
        copy.begin(process)
        self._copies[process] = copy
        process.at_end(lambda: self._run_hooks(copy, process))

    def copy_of(self, process: Process) -> RospyCopy:
        """Return the copy of rospy of a process."""
        return self._copies[process]

    def initialise(self, copy: RospyCopy, name: str, args: Sequence[Any], kwargs: Mapping[str, Any]) -> None:
        """Do the work of `init_node`; reset the node if it exists from an earlier episode.

        Raise NodeError if the node's name has changed since the earlier episode.
        """
        if copy.core.is_initialized():
            copy.real["init_node"](name, *args, **kwargs)  # raises if its arguments have changed
            return
        given = dict(zip(("argv", "anonymous", "log_level"), args, strict=False)) | dict(kwargs)
        if not copy.name:
            copy.register(name, given)
        elif not given.get("anonymous") and copy.name.rpartition("/")[2] not in (name, self._renamed(copy)):
            raise NodeError(
                f"The node called itself {copy.name} in an earlier episode and {name} now: real rospy cannot rename a "
                "node while its connections are kept. Start it with tarl.start(…, argv=[…]), with a different argv for "
                "each name."
            )
        copy.core.set_initialized(True)
        copy.rostime.set_rostime_initialized(True)
        copy.rostime.__dict__["_rostime_current"] = copy.rostime.Time(0)
        if copy.process is not None:
            copy.process.label = copy.name
        self._give_parameters(copy, given.get("argv"))
        WATCHDOG.beat()

    def joined(self, copy: RospyCopy, impl: Any, *, publishes: bool) -> None:
        """Wait until a new publisher or subscriber is fully connected."""
        if copy is not self.world and impl.resolved_name != "/rosout":
            if publishes and self.node_publishes is not None:
                self.node_publishes(impl.resolved_name, impl.data_class)
            elif not publishes and self.node_subscribes is not None:
                self.node_subscribes(impl.resolved_name)
        self.connect(impl.resolved_name)

    def connect(self, topic: str) -> None:
        """Wait until all publishers and subscribers of a topic are connected.

        Raise RecordingError on a type mismatch.
        """
        deadline = monotonic() + PATIENCE
        for sender, publisher in self._ends(topic, "pubs"):
            for receiver, subscriber in self._ends(topic, "subs"):
                if mismatch(publisher, subscriber):
                    continue
                while not _connected(sender, publisher, receiver, subscriber):
                    if monotonic() > deadline:
                        raise RecordingError(
                            f"{sender.name} and {receiver.name} did not connect on {topic} within {PATIENCE:g} s: "
                            "check that processes on this machine can communicate through 127.0.0.1."
                        )
                    sleep_really(0.0005)
        WATCHDOG.beat()

    def subscribers(self, topic: str) -> list[tuple[RospyCopy, Any]]:
        """Return a topic's subscribers, each with its connection."""
        return [end for end in self._ends(topic, "subs") if end[0] is not self.world]

    def sent(self, way: Way) -> None:
        """Count a message as in transit."""
        if way.receiver in {copy.name for copy in (self.world, *self._kept.values())}:
            self.wire.expect(way)
            self.scheduler.sent()

    def latched(self, copy: RospyCopy, subscriber: Any, callback: Any, arguments: Any) -> None:
        """Deliver a topic's latched messages to a new callback."""
        if copy.process is None:
            return
        for _, publisher in self._ends(subscriber.resolved_name, "pubs"):
            if publisher.is_latch and publisher.latch is not None and not mismatch(publisher, subscriber):
                job = partial(spawn_callback, copy.process, callback, snapshot(publisher.latch), arguments)
                self.scheduler.later(job)

    def wake_listening(self) -> None:
        """Wake tasks that wait for a message."""
        tasks, self.listening = self.listening, []
        for task in tasks:
            self.scheduler.wake(task)

    def _made(self, argv: Sequence[str]) -> RospyCopy:
        copy = RospyCopy(argv)
        self._patch(copy, self)
        return copy

    def _ends(self, topic: str, kind: str) -> list[tuple[RospyCopy, Any]]:
        found = []
        for copy in (self.world, *self._kept.values()):
            impl = getattr(copy.topic_manager, kind).get(topic)
            if impl is not None and copy.name:
                found.append((copy, impl))
        return found

    def _renamed(self, copy: RospyCopy) -> str:
        return str(copy.names.get_mappings().get("__name", ""))

    def _give_parameters(self, copy: RospyCopy, argv: Sequence[str] | None) -> None:
        for name, value in self.parameters.items():
            if not name.startswith("/"):
                own = f"{copy.name}/{name.removeprefix('~')}"
                if not self._call("hasParam", own):
                    self.world.rospy.set_param(own, value)
        copy.client._init_node_params(copy.argv if argv is None else argv, copy.name)

    def _run_hooks(self, copy: RospyCopy, process: Process) -> None:
        hooks, copy.core.__dict__["_client_shutdown_hooks"] = copy.core._client_shutdown_hooks, []
        self.in_hooks = True
        task = running_task()
        for hook in hooks:
            if task is None:
                self.scheduler.spawn(process, hook)
                continue
            try:
                hook()
            except Exception as error:
                process.failed(task, error)
        if task is None:
            self.scheduler.later(self._hooks_done)
        else:
            self._hooks_done()

    def _hooks_done(self) -> None:
        self.in_hooks = False

    def _call(self, name: str, *args: Any) -> Any:
        return getattr(self._server, name)("/" + WORLD, *args)[2]


def spawn_callback(process: Process, callback: Any, message: Any, arguments: Any) -> None:
    """Run a callback in a task of its node."""
    if process.ending:
        return
    if arguments is None:
        process.scheduler.spawn(process, callback, message)
    else:
        process.scheduler.spawn(process, callback, message, arguments)


def mismatch(publisher: Any, subscriber: Any) -> bool:
    """Return whether a publisher and a subscriber have different types."""
    sums = (publisher.data_class._md5sum, subscriber.data_class._md5sum)
    return "*" not in sums and sums[0] != sums[1]


def sleep_really(duration: float, _sleep: Callable[[float], None] = sleep) -> None:
    """Sleep for a short wall time, to let other threads run."""
    _sleep(duration)


def quiet_publisher(copy: RospyCopy, topic: str, message_class: Any) -> Any:
    """Return a publisher that sends in the caller's thread, without rospy's warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)
        return copy.rospy.Publisher(topic, message_class)


def _connected(sender: RospyCopy, publisher: Any, receiver: RospyCopy, subscriber: Any) -> bool:
    out = any(connection.endpoint_id == receiver.name for connection in publisher.connections)
    return out and any(
        getattr(connection, "callerid_pub", None) == sender.name for connection in subscriber.connections
    )
