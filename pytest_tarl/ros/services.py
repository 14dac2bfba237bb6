"""The services of an episode, for both client libraries and the world."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Protocol

from pytest_tarl.errors import RecordingError
from pytest_tarl.ros.messages.snapshot import snapshot, translate
from pytest_tarl.ros.names import given_name
from pytest_tarl.ros.scheduler import Scheduler, Task, running_task
from pytest_tarl.ros.service_types import (
    request_class,
    require_part,
    require_service,
    response_class,
    service_type,
)

Answer = Callable[[Any], None]  # receives the response, or a Refusal if the handler failed
NO_RESPONSE = "service cannot process request: service handler returned None"


class Refusal:
    """Replaces the response if a ROS 1 service's handler failed or returned None."""

    def __init__(self, reason: str) -> None:
        self.reason = reason


class Endpoint(Protocol):
    """The serving end of a service."""

    request_type: type
    service_class: Any

    def handle(self, request: Any, answer: Answer) -> None:
        """Handle a request; `answer` is called with the response once it is available."""


class ServiceDirectory:
    """The services of an episode. An offered service is created only when first requested."""

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler
        self._endpoints: dict[str, Endpoint] = {}
        self._offers: dict[str, Callable[[], Any]] = {}
        self._waiting: list[Task] = []
        self.requests = 0  # number of requests from nodes to existing services

    def __contains__(self, name: str) -> bool:
        return name in self._endpoints or name in self._offers

    def find(self, name: str) -> Endpoint | None:
        """Return the endpoint of a service, or None if there is none."""
        if name not in self._endpoints and name in self._offers:
            self._offers[name]()  # this adds the endpoint
        return self._endpoints.get(name)

    def find_as(self, name: str, service_class: Any, caller: str) -> Endpoint | None:
        """Return a service's endpoint for a calling node, or None.

        If the endpoint has another type, the test fails, because on a robot, server and `caller` would not connect.
        """
        endpoint = self.find(name)
        if endpoint is None or service_type(endpoint.service_class) == service_type(service_class):
            self.requests += endpoint is not None
            return endpoint
        self._scheduler.failure = self._scheduler.failure or RecordingError(
            f"{name} is served as {service_type(endpoint.service_class)}, but node {caller!r} calls it as "
            f"{service_type(service_class)}."
        )
        return None

    def add(self, name: str, endpoint: Endpoint) -> None:
        """Add a service, and wake the tasks that wait for it."""
        self._endpoints[name] = endpoint
        for task in self._waiting:
            self._scheduler.wake(task)

    def offer(self, names: Iterable[str], make: Callable[[], Any]) -> None:
        """Register `make`, which creates services when one of `names` is first requested."""
        for name in names:
            self._offers[name] = make

    def remove(self, name: str, endpoint: Endpoint) -> None:
        """Remove a service, unless another one has taken its name."""
        if self._endpoints.get(name) is endpoint:
            del self._endpoints[name]

    def withdraw(self, names: Iterable[str]) -> None:
        """Withdraw offers."""
        for name in names:
            self._offers.pop(name, None)

    def names(self) -> list[tuple[str, Any]]:
        """Return the services as (name, service class)."""
        return [(name, endpoint.service_class) for name, endpoint in self._endpoints.items()]

    def wait(self, task: Task, name: str, until: int | None, going_on: Callable[[], bool]) -> bool:
        """Wait in `task` until `name` is served; return whether this was in time."""
        clock = self._scheduler
        self._waiting.append(task)
        try:
            while name not in self and going_on() and (until is None or clock.time < until):
                clock.wait(until)
        finally:
            self._waiting.remove(task)
        return name in self

    def serve(self, name: str, service_class: Any, handler: Callable[[Any], Any]) -> None:
        """Serve a service from the world; `handler(request)` returns the response.

        Raise RecordingError if `service_class` is not a service type, or `handler` is not callable.
        """
        require_service(name, service_class, handler)
        resolved = given_name(name)
        self.add(resolved, WorldService(resolved, self._scheduler, service_class, handler))

    def call(self, name: str, request: Any) -> Reply | None:
        """Call a node's service from the world; return None if no node offers it.

        Raise RecordingError for a request of another type.
        """
        resolved = given_name(name)
        endpoint = self.find(resolved)
        if endpoint is None:
            return None
        require_part(request, endpoint.request_type, f"The request to {resolved}")
        reply = Reply(resolved)
        sent = adapted(request, endpoint.request_type)
        if running_task() is not None:
            self._scheduler.later(lambda: endpoint.handle(sent, reply.take))
        else:
            endpoint.handle(sent, reply.take)
        return reply


class Reply:
    """The result of a call from the world; `error` is the reason if a ROS 1 node refused the request."""

    def __init__(self, service: str) -> None:
        self._service = service
        self._response: Any = None
        self.error = ""
        self.done = False

    @property
    def response(self) -> Any:
        """Return the response; None until the node has answered. Raise RecordingError if it refused."""
        if self.error:
            raise RecordingError(f"{self._service} gave no response: {self.error}.")
        return self._response

    def take(self, response: Any) -> None:
        """Store the response, or the reason why there is none."""
        if isinstance(response, Refusal):
            self.error = response.reason
        else:
            self._response = response
        self.done = True


class WorldService:
    """A service that the simulated world answers immediately."""

    def __init__(
        self, name: str, scheduler: Scheduler, service_class: Any, handler: Callable[[Any], Any]
    ) -> None:
        self._name = name
        self.service_class = service_class
        self.request_type = request_class(service_class)
        self._scheduler = scheduler
        self._handler = handler

    def handle(self, request: Any, answer: Answer) -> None:
        """Call the world's handler; errors are raised in the test, not in the node."""
        try:
            response = self._checked(self._handler(request))
            answer(Refusal(NO_RESPONSE) if response is None else response)
        except Exception as error:
            self._scheduler.failure = self._scheduler.failure or error
            answer(Refusal(f"error processing request: {error}"))

    def _checked(self, response: Any) -> Any:
        """Return the response. Raise RecordingError if its type is wrong; in ROS 1, None refuses the request."""
        if response is not None or not hasattr(self.service_class, "_response_class"):
            require_part(
                response,
                response_class(self.service_class),
                f"The response of the test's handler of {self._name}",
            )
        return response


def adapted(message: Any, wanted: type) -> Any:
    """Copy a request or response into the class used by the other side."""
    return snapshot(message) if isinstance(message, wanted) else translate(message, wanted)
