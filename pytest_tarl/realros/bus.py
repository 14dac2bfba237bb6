"""Base classes for an installed rospy or rclpy: the episode, and the bus (the topics as the world sees them)."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from typing import Any

from pytest_tarl.errors import RecordingError, UnsupportedApiError
from pytest_tarl.realros.lockstep import WireScheduler
from pytest_tarl.ros.bus import Bus, Channel, Topic
from pytest_tarl.ros.episode import Ros
from pytest_tarl.ros.hosttime import virtual_host_time
from pytest_tarl.ros.keyboard import terminals
from pytest_tarl.ros.launch_sources import Given
from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.messages.snapshot import stamp_if_unset, translate, type_name
from pytest_tarl.ros.messages.type_definitions import Kind
from pytest_tarl.ros.process import Process
from pytest_tarl.ros.scheduler import Program, running_task
from pytest_tarl.ros.threads import threads_as_tasks

# thread switch interval (s); the default of 0.005 s would delay a message at every switch
_SWITCH_INTERVAL = 0.0002


class RealBus(Bus):
    """The bus of the simulated world, which has its own ROS node."""

    kind: Kind

    def __init__(self, scheduler: WireScheduler, run: Callable[..., None]) -> None:
        super().__init__(scheduler, run)
        scheduler.collect = self.collect

    def publish(self, topic: str, message: Any, *, latch: bool = False) -> None:
        """Publish from the world; return only after every idle subscriber has received the message."""
        place = self.topic(topic)
        message = self._own_class(message, place.name)
        stamp_if_unset(message, self._scheduler.time)
        if running_task() is not None:
            self._scheduler.later(lambda: self._publish(place, message, latch))
            return
        self._run(self._publish, place, message, latch)

    def interpose(self, topic: str, channel: Channel) -> None:  # noqa: ARG002
        """Raise UnsupportedApiError: messages of an installed ROS cannot be intercepted in this process."""
        raise UnsupportedApiError(
            f"The fault of {topic} needs the in-process ROS: remove --tarl-ros, or the fault from the marker."
        )

    def disconnect(self, process: Program) -> None:
        """Do nothing: a process that has ended receives no messages."""

    def collect(self) -> bool:
        """Receive one message in transit; return whether there was one."""
        raise NotImplementedError

    def send(self, place: Topic, message: Any, latch: bool) -> None:
        """Publish on the installed ROS. Raise RecordingError if a subscriber has another message type."""
        raise NotImplementedError

    def heard(self, topic: str, message: Any) -> None:
        """Record a message published by a node."""
        place = self.topic(topic)
        self.published[place.name] += 1
        place.latest = message
        for observer in self._observers:
            observer(place.name, message)
        for listener in place.listeners:
            self._tell(listener, message)

    def _publish(self, place: Topic, message: Any, latch: bool) -> None:
        for observer in self._observers:
            observer(place.name, message)
        self.send(place, message, latch)

    def _own_class(self, message: Any, topic: str) -> Any:
        """Convert a message to the class of the installed ROS.

        Raise RecordingError if the message is invalid or its class is not installed.
        """
        own = type(message)
        package, _, short = type_name(own).partition("/")
        wanted = find_class(self.kind, package, short) if short else None
        if wanted is None:
            raise RecordingError(
                f"The message published on {topic} is not valid: {own.__name__} is not a message type of the ROS that  "
                "is installed here."
            )
        return message if wanted is own else translate(message, wanted)


class RealRos(Ros):
    """An episode whose nodes import the installed ROS."""

    def __init__(self, *, parameters: Mapping[str, Any] | None = None, **options: Any) -> None:
        super().__init__(parameters=parameters, **options)
        self.lockstep = WireScheduler()
        self.scheduler = self.lockstep
        self.lockstep.enter = self.enter

    def launch(self, given: Given) -> None:
        """Set the parameters of a launch file: for all nodes if the node's name is not known yet."""
        super().launch(given)
        private = {} if given.node else {f"~{key}": one for key, one in given.private.items()}
        for name, value in {**given.shared, **private}.items():
            self.parameters.setdefault(name, value)

    def start(self, run: Callable[[], None], *, name: str, argv: Sequence[str] = ()) -> None:
        """Run a node's main program until it first waits. Raise NodeError if the program raises an exception."""
        given = self._launched
        if given.node:
            argv = (*argv, *_arguments(given.private, ros2="--ros-args" in argv))
        super().start(run, name=name, argv=argv)

    def enter(self, process: Process) -> None:
        """Prepare to resume a task of a process."""
        raise NotImplementedError

    def installed(self) -> AbstractContextManager[None]:
        """Make nodes see the virtual clock inside the context, and run their threads as tasks."""
        return self._installed()

    @contextmanager
    def _installed(self) -> Iterator[None]:
        interval = sys.getswitchinterval()
        sys.setswitchinterval(_SWITCH_INTERVAL)
        try:
            with virtual_host_time(self.scheduler), threads_as_tasks(), terminals(self.processes):
                yield
        finally:
            sys.setswitchinterval(interval)


def _arguments(parameters: Mapping[str, Any], *, ros2: bool) -> Iterator[str]:
    """Yield command line arguments that set private parameters, in the remapping syntax of ROS 1 or 2."""
    for name, value in parameters.items():
        text = json.dumps(value)  # the YAML parser of ROS also reads JSON
        yield from ("-p", f"{name}:={text}") if ros2 else (f"_{name}:={text}",)


def refused(topic: str, published: Any, receiver: str, wanted: Any) -> RecordingError:
    """Return the error for a subscription whose message type differs from the published one."""
    return RecordingError(
        f"{topic} carries {type_name(published)}, but node {receiver!r} subscribes to it as {type_name(wanted)}."
    )
