"""tf2_ros's buffer server, which answers other nodes' look-ups, and its client."""

# ruff: noqa: ARG002 (signatures are tf2_ros's)

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.names import absolute
from pytest_tarl.ros.process import Network, current_process
from pytest_tarl.ros.tf2_ros.buffer import Buffer, BufferInterface, nanoseconds_of
from pytest_tarl.ros.transforms import TimeoutException

_LOOK = nanoseconds(0.01)  # polling period while waiting for the server (ns)


class BufferServers:
    """The buffers served in an episode, by server name."""

    def __init__(self, _ros: Network) -> None:
        self.by_name: dict[str, Buffer] = {}


class BufferServer:
    """Serves a buffer to other nodes under a name."""

    def __init__(self, buffer: Any, ns: str, auto_start: bool = True) -> None:
        self.buffer, self.ns = buffer, ns
        if auto_start:
            self.start()

    def start(self) -> None:
        """Start answering."""
        process = current_process("tf2_ros.BufferServer")
        process.ros.part(BufferServers).by_name[absolute(self.ns)] = self.buffer


class BufferClient(BufferInterface):
    """Looks up transforms in a server's buffer; waits up to the look-up's timeout plus `timeout_padding`."""

    def __init__(
        self, ns: str, check_frequency: float | None = None, timeout_padding: Any = 2.0, **_: Any
    ) -> None:
        super().__init__()
        self.process = current_process("tf2_ros.BufferClient")
        self._name = absolute(ns)
        self._padding = nanoseconds_of(timeout_padding)

    def wait_for_server(self, timeout: Any = None) -> bool:
        """Wait for a server; return whether one appeared in time. None or zero waits without limit."""
        span = 0 if timeout is None else nanoseconds_of(timeout)
        return self._server(None if not span else self.process.scheduler.time + span) is not None

    def lookup_transform(self, target_frame: str, source_frame: str, time: Any, timeout: Any = None) -> Any:
        """Return the transform from `source_frame` to `target_frame`. Raise TransformException."""
        return self._buffer(timeout).lookup_transform(target_frame, source_frame, time, self._left(timeout))

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = None,
    ) -> Any:
        """Return the transform from `source_frame` at one time to `target_frame` at another, via a fixed frame."""
        return self._buffer(timeout).lookup_transform_full(
            target_frame, target_time, source_frame, source_time, fixed_frame, self._left(timeout)
        )

    def can_transform(self, target_frame: str, source_frame: str, time: Any, timeout: Any = None) -> bool:
        """Return whether a look-up would succeed; wait up to `timeout`."""
        buffer = self._buffer(timeout)
        return bool(buffer.can_transform(target_frame, source_frame, time, self._left(timeout)))

    def _left(self, timeout: Any) -> Any:
        return 0.0 if timeout is None else timeout

    def _buffer(self, timeout: Any) -> Buffer:
        span = self._padding + (0 if timeout is None else nanoseconds_of(timeout))
        found = self._server(self.process.scheduler.time + span)
        if found is None:
            raise TimeoutException(
                f"The LookupTransform goal sent to the BufferServer {self._name} timed out."
            )
        return found

    def _server(self, until: int | None) -> Buffer | None:
        clock, servers = self.process.scheduler, self.process.ros.part(BufferServers).by_name
        while self._name not in servers and not self.process.ending and (until is None or clock.time < until):
            clock.wait(clock.time + _LOOK if until is None else min(until, clock.time + _LOOK))
        return servers.get(self._name)


__all__ = ["BufferClient", "BufferServer"]
