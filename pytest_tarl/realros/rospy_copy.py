"""One node on an installed rospy: a private copy of rospy, initialised once, with connections that outlive episodes."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

from pytest_tarl.realros.copies import Modules, load_copy, show
from pytest_tarl.ros.process import Process

_PARTS = ("client", "core", "names", "rostime", "timer", "topics", "service", "numpy_msg", "impl.init",
          "impl.tcpros", "impl.tcpros_base", "impl.tcpros_pubsub", "impl.tcpros_service", "impl.paramserver",
          "impl.registration", "impl.simtime", "impl.rosout")  # fmt: skip


class RospyCopy:
    """A private copy of rospy, used by `process` in this episode; None for the world's copy."""

    def __init__(self, argv: Sequence[str]) -> None:
        self.argv = tuple(argv)
        self.modules: Modules = load_copy("rospy", _PARTS, argv)
        self.process: Process | None = None
        self.name = ""  # set by `init_node`
        self.real: dict[str, Callable[..., Any]] = {}  # originals of patched functions
        self.services: list[Any] = []  # services of the current episode

    def __getattr__(self, part: str) -> ModuleType:
        """Return a module of this copy, such as `copy.core` or `copy.topics`."""
        try:
            return self.modules[f"rospy.{part}"]
        except KeyError:
            raise AttributeError(part) from None

    @property
    def rospy(self) -> ModuleType:
        """The copy's `rospy` module."""
        return self.modules["rospy"]

    @property
    def tcp_services(self) -> ModuleType:
        """The copy's module `rospy.impl.tcpros_service`."""
        return self.modules["rospy.impl.tcpros_service"]

    @property
    def topic_manager(self) -> Any:
        """The copy's topic manager, which holds the node's connections."""
        return self.modules["rospy.impl.registration"].get_topic_manager()

    def show(self) -> None:
        """Make `import rospy` return this copy."""
        show("rospy", self.modules)

    def register(self, name: str, arguments: dict[str, Any]) -> None:
        """Run the original `init_node`, once per copy."""
        self.real["init_node"](name, **{**arguments, "disable_signals": True})
        self.name = self.names.get_caller_id()

    def begin(self, process: Process) -> None:
        """Reset to the state of a new process, but keep the connections."""
        self.process = process
        self.core.__dict__.update(_client_shutdown_hooks=[])
        self.rostime.__dict__.update(_rostime_initialized=False, _rostime_current=None)
        self.core.set_initialized(False)
        self.core.__dict__["_logging_once"].called_caller_ids.clear()
        self.core.__dict__["_logging_throttle"].last_logging_time_table.clear()
        self.core.__dict__["_logging_identical"].last_logging_msg_table.clear()
        for subscriber in self.topic_manager.subs.values():
            subscriber.callbacks, subscriber.queue_size = [], None
        for publisher in self.topic_manager.pubs.values():
            publisher.seq, publisher.is_latch, publisher.latch = 0, False, None
            publisher.subscriber_listeners.clear()

    def end(self) -> None:
        """End the episode: drop its callbacks and services."""
        for service in self.services:
            service.shutdown("")
        self.services.clear()
        for subscriber in self.topic_manager.subs.values():
            subscriber.callbacks = []
        self.process = None

    def close(self) -> None:
        """Shut the node down."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self.real["signal_shutdown"]("the test run is over")
