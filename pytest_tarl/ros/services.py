"""Who serves what in an episode, for both client libraries and for the world."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Protocol

from pytest_tarl.ros.messages.snapshot import snapshot, translate
from pytest_tarl.ros.names import absolute
from pytest_tarl.ros.scheduler import Scheduler, Task, running_task

Answer = Callable[[Any], None]  # takes the response, None where the handler gave none


class Endpoint(Protocol):
    """One end of a service that answers."""

    request_type: type
    service_class: Any

    def handle(self, request: Any, answer: Answer) -> None:
        """Take a request; `answer` is called when the response is there."""


class ServiceDirectory:
    """The services of one episode. An offer becomes an endpoint when somebody asks for it."""

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler
        self._endpoints: dict[str, Endpoint] = {}
        self._offers: dict[str, Callable[[], Any]] = {}
        self._waiting: list[Task] = []

    def __contains__(self, name: str) -> bool:
        return name in self._endpoints or name in self._offers

    def find(self, name: str) -> Endpoint | None:
        """Return who answers, None if nobody does."""
        if name not in self._endpoints and name in self._offers:
            self._offers[name]()  # adds the endpoint
        return self._endpoints.get(name)

    def add(self, name: str, endpoint: Endpoint) -> None:
        """Add a service and wake those who wait for it."""
        self._endpoints[name] = endpoint
        for task in self._waiting:
            self._scheduler.wake(task)

    def offer(self, names: Iterable[str], make: Callable[[], Any]) -> None:
        """Have `make` called when one of `names` is first asked for."""
        for name in names:
            self._offers[name] = make

    def remove(self, name: str, endpoint: Endpoint) -> None:
        """Take a service away, unless another one answers under its name by now."""
        if self._endpoints.get(name) is endpoint:
            del self._endpoints[name]

    def withdraw(self, names: Iterable[str]) -> None:
        """Take offers back."""
        for name in names:
            self._offers.pop(name, None)

    def names(self) -> list[tuple[str, Any]]:
        """List names and service classes."""
        return [(name, endpoint.service_class) for name, endpoint in self._endpoints.items()]

    def wait(self, task: Task, name: str, until: int | None, going_on: Callable[[], bool]) -> bool:
        """Wait in `task` until somebody serves `name`; tell whether that was within the time."""
        clock = self._scheduler
        self._waiting.append(task)
        try:
            while name not in self and going_on() and (until is None or clock.time < until):
                clock.wait(until)
        finally:
            self._waiting.remove(task)
        return name in self

    def serve(self, name: str, service_class: Any, handler: Callable[[Any], Any]) -> None:
        """Have the world answer a service with `handler(request)`, which returns the response."""
        self.add(absolute(name), WorldService(self._scheduler, service_class, handler))

    def call(self, name: str, request: Any) -> Reply | None:
        """Call a node's service from the world. Return None if no node offers it."""
        endpoint = self.find(absolute(name))
        if endpoint is None:
            return None
        reply = Reply()
        sent = adapted(request, endpoint.request_type)
        if running_task() is not None:
            self._scheduler.later(lambda: endpoint.handle(sent, reply.take))
        else:
            endpoint.handle(sent, reply.take)
        return reply


class Reply:
    """What the world gets for a call: `response` is None until the node has answered."""

    def __init__(self) -> None:
        self.response: Any = None
        self.done = False

    def take(self, response: Any) -> None:
        """Take the answer."""
        self.response, self.done = response, True


class WorldService:
    """A service that the simulated world answers, as quickly as it is asked."""

    def __init__(self, scheduler: Scheduler, service_class: Any, handler: Callable[[Any], Any]) -> None:
        self.service_class = service_class
        self.request_type = request_class(service_class)
        self._scheduler = scheduler
        self._handler = handler

    def handle(self, request: Any, answer: Answer) -> None:
        """Let the world answer; its own errors go to the test, not into the node."""
        try:
            answer(self._handler(request))
        except Exception as error:
            self._scheduler.failure = self._scheduler.failure or error
            answer(None)


def request_class(service_class: Any) -> Any:
    """Return the class of a service's requests, of either ROS generation."""
    return getattr(service_class, "Request", None) or service_class._request_class


def adapted(message: Any, wanted: type) -> Any:
    """Return a copy of a request or response in the class that the other side uses."""
    return snapshot(message) if isinstance(message, wanted) else translate(message, wanted)
