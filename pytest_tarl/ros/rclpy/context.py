"""The context that `rclpy.init` initialises: whether ROS is running in this process."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

from pytest_tarl.ros import names
from pytest_tarl.ros.process import Process, current_process
from pytest_tarl.ros.rclpy.exceptions import NotInitializedException, RCLError


class Context:
    """The rclpy context of a process; `Context()` always returns the same one."""

    def __new__(cls, process: Process | None = None) -> Context:
        """Return the process's context; create it on first use."""
        return object.__new__(cls) if process is not None else this_context("Context")

    def __init__(self, process: Process | None = None) -> None:
        if process is None:
            return
        self.process = process
        self.command_line = names.parse_ros2(process.argv[1:])
        self.initialised = False
        self.nodes: list[Any] = []
        self.executor: Any = None
        self._callbacks: list[Callable[[], Any]] = []
        self._wakers: list[Callable[[], None]] = []
        process.at_end(self._stop)

    def init(self, args: list[str] | None = None, **_: Any) -> None:
        """Initialise ROS. Raise RuntimeError if this was already done."""
        if self.initialised:
            raise RuntimeError("Context.init() must only be called once")
        if args is not None:
            self.command_line = names.parse_ros2(args)
        self.initialised = True

    def ok(self) -> bool:
        """Return whether ROS is initialised and not shut down."""
        return self.initialised and not self.process.ending

    def get_domain_id(self) -> int:
        """Return the environment's DDS domain. Raise NotInitializedException before `init`."""
        self.require()
        return int(os.environ.get("ROS_DOMAIN_ID") or 0)

    def require(self) -> None:
        """Raise NotInitializedException before `init`."""
        if not self.initialised:
            raise NotInitializedException

    def shutdown(self) -> None:
        """Shut ROS down.

        Raise RuntimeError if ROS is not initialised, and RCLError if the node was ended from outside.
        """
        if self.process.ending:
            error = RCLError("failed to shutdown: rcl_shutdown already called on the given context")
            # not reported, because programs often end with `shutdown`
            error.tarl_shutdown = True
            raise error
        if not self.initialised:
            raise RuntimeError("Context must be initialized before it can be shutdown")
        self._stop()

    def try_shutdown(self) -> None:
        """Shut ROS down, unless it already is."""
        if self.ok():
            self._stop()

    def on_shutdown(self, callback: Callable[[], Any]) -> None:
        """Register a callback for the shutdown."""
        self._callbacks.append(callback)

    def on_wake(self, waker: Callable[[], None]) -> None:
        """Register an executor to be woken at shutdown."""
        self._wakers.append(waker)

    def _stop(self) -> None:
        self.initialised = False
        callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            callback()
        for waker in self._wakers:
            waker()

    def __enter__(self) -> Context:
        return self

    def __exit__(self, *_: object) -> None:
        self.try_shutdown()


def this_context(api: str) -> Context:
    """Return the context of the running program."""
    return current_process(f"rclpy.{api}").part(Context)
