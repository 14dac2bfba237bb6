"""rospy's services: a call is handled in a task of the serving node while the caller waits."""

# ruff: noqa: ARG002 (signatures are rospy's)

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.messages.snapshot import snapshot
from pytest_tarl.ros.rospy.exceptions import ROSException, ROSInterruptException, ServiceException
from pytest_tarl.ros.rospy.node import this_node
from pytest_tarl.ros.scheduler import Task, current_task

if TYPE_CHECKING:
    from pytest_tarl.ros.episode import Ros


class ServiceDirectory:
    """Who serves what, in one episode."""

    def __init__(self, ros: Ros) -> None:
        self.services: dict[str, Service] = {}
        self.waiting: list[Task] = []


class Service:
    """Serves requests with `handler(request)`."""

    def __init__(
        self,
        name: str,
        service_class: Any,
        handler: Callable[[Any], Any],
        buff_size: int = 65536,
        error_handler: Callable[..., Any] | None = None,
    ) -> None:
        node = this_node("Service")
        self._process = node.process
        self.resolved_name = node.resolve(name)
        self.service_class = service_class
        self.handler = handler
        self._directory = node.process.ros.part(ServiceDirectory)
        if self.resolved_name in self._directory.services:
            raise ServiceException(f"service [{self.resolved_name}] already registered")
        self._directory.services[self.resolved_name] = self
        self._process.at_end(self.shutdown)
        for task in self._directory.waiting:
            self._process.scheduler.wake(task)

    def shutdown(self, reason: str = "") -> None:
        """Stop serving."""
        self._directory.services.pop(self.resolved_name, None)

    def spin(self) -> None:
        """Wait until the node is shut down."""
        while not self._process.ending:
            self._process.scheduler.wait()

    def handle(self, request: Any, answer: Callable[[Any], None]) -> None:
        """Handle a request in a task of this node; `answer` gets the response, None where the handler gave none."""
        self._process.scheduler.spawn(self._process, self._serve, request, answer)

    def _serve(self, request: Any, answer: Callable[[Any], None]) -> None:
        response = None
        try:
            response = self._as_response(self.handler(request))
        finally:
            answer(response)

    def _as_response(self, returned: Any) -> Any:
        made: type = self.service_class._response_class
        if isinstance(returned, made) or returned is None:
            return returned
        if isinstance(returned, dict):
            return made(**returned)
        return made(*returned) if isinstance(returned, list | tuple) else made(returned)


class ServiceProxy:
    """Calls a service like a function."""

    def __init__(self, name: str, service_class: Any, persistent: bool = False, headers: Any = None) -> None:
        self._node = this_node("ServiceProxy")
        self.resolved_name = self._node.resolve(name)
        self.service_class = service_class
        self.request_class = service_class._request_class
        self.response_class = service_class._response_class

    def __call__(self, *args: Any, **kwds: Any) -> Any:
        """Call the service."""
        return self.call(*args, **kwds)

    def call(self, *args: Any, **kwds: Any) -> Any:
        """Call the service with a request or its fields. Raises ServiceException."""
        if len(args) == 1 and isinstance(args[0], self.request_class):
            request = args[0]
        else:
            request = self.request_class(*args, **kwds)
        service = self._node.process.ros.part(ServiceDirectory).services.get(self.resolved_name)
        if service is None:
            raise ServiceException(f"service [{self.resolved_name}] unavailable")
        clock, task, answers = self._node.process.scheduler, current_task(), []

        def answer(response: Any) -> None:
            answers.append(response)
            clock.wake(task)

        service.handle(snapshot(request), answer)
        while not answers:
            clock.wait()
            if self._node.process.ending:
                raise ROSInterruptException("rospy shutdown")
        if answers[0] is None:
            raise ServiceException(f"service [{self.resolved_name}] responded with an error: "
                                   "service cannot process request: service handler returned None")  # fmt: skip
        return snapshot(answers[0])

    def wait_for_service(self, timeout: float | None = None) -> None:
        """Wait until the service is there. Raises ROSException after `timeout` seconds."""
        wait_for_service(self.resolved_name, timeout)

    def close(self) -> None:
        """Do nothing: there is no connection."""


def wait_for_service(service: str, timeout: Any = None) -> None:
    """Wait until a service is there. Raises ROSException after `timeout` seconds."""
    node = this_node("wait_for_service")
    clock, task = node.process.scheduler, current_task()
    directory = node.process.ros.part(ServiceDirectory)
    name = node.resolve(service)
    until = (
        None if timeout is None else clock.time + nanoseconds(getattr(timeout, "to_sec", lambda: timeout)())
    )
    directory.waiting.append(task)
    while (
        name not in directory.services and not node.process.ending and (until is None or clock.time < until)
    ):
        clock.wait(until)
    directory.waiting.remove(task)
    if name in directory.services:
        return
    if node.process.ending:
        raise ROSInterruptException("rospy shutdown")
    raise ROSException(f"timeout exceeded while waiting for service {name}")
