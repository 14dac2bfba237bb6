"""rospy's services: a task of the serving node handles a call while the caller waits."""

# ruff: noqa: ARG002 (signatures are rospy's)

from __future__ import annotations

import logging
from collections.abc import Callable
from math import ceil
from typing import Any

from pytest_tarl.errors import TarlError
from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.messages.field_values import FieldError
from pytest_tarl.ros.messages.snapshot import snapshot
from pytest_tarl.ros.rospy.exceptions import (
    ROSException,
    ROSInterruptException,
    ROSSerializationException,
    ServiceException,
)
from pytest_tarl.ros.rospy.node import this_node, warn_if_illegal
from pytest_tarl.ros.scheduler import current_task
from pytest_tarl.ros.services import NO_RESPONSE, Answer, Refusal, adapted

_LOGGER = logging.getLogger("rosout")
_POLL = 0.3  # polling period of `wait_for_service` (s)


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
        if not name or not isinstance(name, str):
            raise ValueError("service name is not a non-empty string")
        warn_if_illegal(name, stacklevel=3)
        node = this_node("Service")
        self.process = node.process
        self.resolved_name = node.resolve(name)
        node.require_registrable(self.resolved_name, "service")
        self.service_class = service_class
        self.request_type: type = service_class._request_class
        self.handler = handler
        self._error_handler = error_handler
        self._directory = node.process.ros.services
        if self.resolved_name in self._directory:
            raise ServiceException(f"service [{self.resolved_name}] already registered")
        self._directory.add(self.resolved_name, self)
        self.process.at_end(self.shutdown)

    def shutdown(self, reason: str = "") -> None:
        """Stop serving."""
        self._directory.remove(self.resolved_name, self)

    def spin(self) -> None:
        """Wait until the node is shut down."""
        while not self.process.ending:
            self.process.scheduler.wait()

    def handle(self, request: Any, answer: Answer) -> None:
        """Handle a request in a task of this node; `answer` gets the response, or a Refusal if the handler fails."""
        self.process.scheduler.spawn(self.process, self._serve, request, answer)

    def _serve(self, request: Any, answer: Answer) -> None:
        """Handle a request; as in rospy, an exception in the handler fails the call, but does not end the node."""
        try:
            response = self._as_response(self.handler(request))
            response = None if response is None else snapshot(response)
        except Exception as error:
            if isinstance(error, TarlError):
                raise
            _LOGGER.exception("Error processing request: %s", error)
            if self._error_handler is not None:
                self._error_handler(error, type(error), error.__traceback__)
            answer(Refusal(f"error processing request: {error}"))
            return
        answer(response if response is not None else Refusal(NO_RESPONSE))

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
        """Call the service with a request or its fields. Raise ServiceException."""
        request = self._request(args, kwds)
        process = self._node.process
        service = process.ros.services.find_as(self.resolved_name, self.service_class, process.label)
        if service is None:
            raise ServiceException(f"service [{self.resolved_name}] unavailable")
        clock, task, answers = self._node.process.scheduler, current_task(), []

        def answer(response: Any) -> None:
            answers.append(response)
            clock.wake(task)

        try:
            service.handle(adapted(request, service.request_type), answer)
        except FieldError as error:
            raise ROSSerializationException(f"{error} (calling {self.resolved_name})") from error
        while not answers:
            clock.wait()
            if self._node.process.ending:
                raise ROSInterruptException("rospy shutdown")
        return self._response(answers[0])

    def _request(self, args: tuple[Any, ...], kwds: dict[str, Any]) -> Any:
        if len(args) == 1 and isinstance(args[0], self.request_class):
            return args[0]
        return self.request_class(*args, **kwds)

    def _response(self, answered: Any) -> Any:
        if isinstance(answered, Refusal):
            said = answered.reason.encode()  # as in rospy, the message shows the reason as bytes
            raise ServiceException(f"service [{self.resolved_name}] responded with an error: {said!r}")
        return adapted(answered, self.response_class)

    def wait_for_service(self, timeout: float | None = None) -> None:
        """Wait for the service. Raise ROSException after `timeout` seconds."""
        wait_for_service(self.resolved_name, timeout)

    def close(self) -> None:
        """Do nothing: there is no connection."""


def wait_for_service(service: str, timeout: Any = None) -> None:
    """Wait for a service. Raise ROSException after `timeout` seconds."""
    node = this_node("wait_for_service")
    name = node.resolve(service)
    seconds = getattr(timeout, "to_sec", lambda: timeout)()
    if seconds == 0.0:
        raise ValueError("timeout must be non-zero")
    polls = None if timeout is None else max(ceil(seconds / _POLL), 0)  # rospy checks the time once per poll
    until = None if polls is None else node.process.scheduler.time + polls * nanoseconds(_POLL)
    directory = node.process.ros.services
    if directory.wait(current_task(), name, until, lambda: not node.process.ending):
        return
    if node.process.ending:
        raise ROSInterruptException("rospy shutdown")
    raise ROSException(f"timeout exceeded while waiting for service {name}")
