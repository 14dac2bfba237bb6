"""What the two real ROS generations have in common: the world's end of the topics, and the episode."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from typing import Any

from pytest_tarl.errors import RecordingError
from pytest_tarl.realros.lockstep import WireScheduler
from pytest_tarl.ros.bus import Bus, Topic
from pytest_tarl.ros.episode import Ros
from pytest_tarl.ros.hosttime import virtual_host_time
from pytest_tarl.ros.launched import Given
from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.messages.definitions import Kind
from pytest_tarl.ros.messages.snapshot import stamp_if_unset, translate, type_name
from pytest_tarl.ros.process import Process
from pytest_tarl.ros.scheduler import Program, running_task
from pytest_tarl.ros.threads import threads_as_tasks

_SWITCH_INTERVAL = (
    0.0002  # seconds: threads of the client library hand every message on, each waiting for its turn
)


class RealBus(Bus):
    """What the world publishes and hears, through a node of its own."""

    kind: Kind

    def __init__(self, scheduler: WireScheduler, run: Callable[..., None]) -> None:
        super().__init__(scheduler, run)
        scheduler.collect = self.collect

    def publish(self, topic: str, message: Any, *, latch: bool = False) -> None:
        """Publish from the world; every subscriber has it before this returns, if it can take it now."""
        place = self.topic(topic)
        message = self._own_class(message, place.name)
        stamp_if_unset(message, self._scheduler.time)
        if running_task() is not None:
            self._scheduler.later(lambda: self._publish(place, message, latch))
            return
        self._run(self._publish, place, message, latch)

    def disconnect(self, process: Program) -> None:
        """Do nothing: a process that has ended takes nothing any more."""

    def collect(self) -> bool:
        """Take in one message that is under way; return whether there was one."""
        raise NotImplementedError

    def send(self, place: Topic, message: Any, latch: bool) -> None:
        """Hand a message to the real ROS. Raise RecordingError if a subscriber wants another type."""
        raise NotImplementedError

    def heard(self, topic: str, message: Any) -> None:
        """Take note of what a node has published."""
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
        """Return the message in the class that the installed ROS has for it."""
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
    """An episode whose nodes import the ROS that is installed."""

    def __init__(self, *, parameters: Mapping[str, Any] | None = None, **options: Any) -> None:
        super().__init__(parameters=parameters, **options)
        self.lockstep = WireScheduler()
        self.scheduler = self.lockstep
        self.lockstep.enter = self.enter

    def launch(self, given: Given) -> None:
        """Give all nodes the parameters of a launch file: on a real ROS they have no names before they run."""
        super().launch(given)
        for name, value in {**given.shared, **{f"~{key}": one for key, one in given.private.items()}}.items():
            self.parameters.setdefault(name, value)

    def enter(self, process: Process) -> None:
        """Prepare for a task of a process to go on."""
        raise NotImplementedError

    def installed(self) -> AbstractContextManager[None]:
        """Let nodes see the virtual clock, and their threads be tasks."""
        return self._installed()

    @contextmanager
    def _installed(self) -> Iterator[None]:
        interval = sys.getswitchinterval()
        sys.setswitchinterval(_SWITCH_INTERVAL)
        try:
            with virtual_host_time(self.scheduler), threads_as_tasks():
                yield
        finally:
            sys.setswitchinterval(interval)


def refused(topic: str, published: Any, receiver: str, wanted: Any) -> RecordingError:
    """Say that a node subscribes with another type than is published."""
    return RecordingError(
        f"{topic} carries {type_name(published)}, but node {receiver!r} subscribes to it as {type_name(wanted)}."
    )
