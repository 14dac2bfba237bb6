"""The rclpy context of a node under test: `init` and `shutdown` leave the shared DDS participant alone."""

from __future__ import annotations

from collections.abc import Callable
from inspect import ismethod
from typing import TYPE_CHECKING, Any
from weakref import WeakMethod

from pytest_tarl.ros.scheduler import running_task

if TYPE_CHECKING:
    from pytest_tarl.realros.rclpy_network import RclpyNetwork

_HANDLE = "_Context__context"  # name-mangled attribute of rclpy's class
_NODES = "_Context__node_weak_ref_list"


class SharedParticipant:
    """Mixin for rclpy's Context: the same interface, with one DDS participant for all contexts."""

    network: RclpyNetwork
    error: Any  # the class RCLError of rclpy
    handle: Any
    _callbacks: list[Any]
    _call_on_shutdown_callbacks: Callable[[], None]
    _remove_callback: Callable[[Any], None]

    def __init__(self) -> None:
        super().__init__()
        task = running_task()
        self._up = False
        self.process = None if task is None else task.process
        self.network.contexts.append(self)

    def init(self, args: Any = None, **_: Any) -> None:
        """Initialise the context. Raise RuntimeError if it already was."""
        if self.handle is not None:
            raise RuntimeError("Context.init() must only be called once")
        if args is not None:
            self.network.arguments = tuple(args)
        setattr(self, _HANDLE, self.network.context.handle)
        self._up = True

    def ok(self) -> bool:
        """Return whether the context is initialised."""
        return self._up and not (self.process is not None and self.process.ending)

    def destroy(self) -> None:
        """Do nothing: other contexts use the participant."""

    def shutdown(self) -> None:
        """Shut the context down. Raise RuntimeError before `init`, RCLError if it was already shut down."""
        if self.handle is None:
            raise RuntimeError("Context must be initialized before it can be shutdown")
        if not self.ok():
            failure = self.error("failed to shutdown: rcl_shutdown already called on the given context")
            failure.tarl_shutdown = self.process is not None and self.process.ending
            raise failure
        self._cleanup()

    def try_shutdown(self) -> None:
        """Shut the context down unless it already was."""
        if self.ok():
            self._cleanup()

    def on_shutdown(self, callback: Any) -> None:
        """Register a shutdown callback. Raise TypeError if it is not callable."""
        if not callable(callback):
            raise TypeError("callback should be a callable, got {}", type(callback))
        if self.handle is not None and not self.ok():
            callback()
        else:
            self._callbacks.append(
                WeakMethod(callback, self._remove_callback) if ismethod(callback) else callback
            )

    def stop(self) -> None:
        """Shut down as on Ctrl-C; nodes exist until their program destroys them."""
        if self._up:
            self._up = False
            self._call_on_shutdown_callbacks()

    def _cleanup(self) -> None:
        for reference in list(getattr(self, _NODES)):
            node = reference()
            if node is not None:
                node.destroy_node()
        self.stop()
        self.network.wake_listening()

    def __exit__(self, *_: object) -> None:
        self.try_shutdown()


def shared_context(network: RclpyNetwork) -> type[Any]:
    """Return a context class whose instances share the participant of the run."""
    rclpy = network.rclpy
    error = rclpy.impl.implementation_singleton.rclpy_implementation.RCLError
    bases = (SharedParticipant, rclpy.context.Context)
    return type("Context", bases, {"network": network, "error": error})
