"""rclpy's services and clients: request and response each wait for the executor of the node they reach."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

import inspect
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.messages.snapshot import snapshot
from pytest_tarl.ros.rclpy.task import Future
from pytest_tarl.ros.scheduler import Task, current_task

if TYPE_CHECKING:
    from pytest_tarl.ros.episode import Ros
    from pytest_tarl.ros.rclpy.node import Node


class ServiceDirectory:
    """Who serves what, in one episode."""

    def __init__(self, ros: Ros) -> None:
        self.services: dict[str, Service] = {}
        self.waiting: list[Task] = []


class Service:
    """Answers requests with `callback(request, response)`."""

    def __init__(
        self, node: Node, srv_type: Any, srv_name: str, callback: Callable[..., Any], group: Any
    ) -> None:
        self.node = node
        self.srv_type = srv_type
        self.srv_name = self.service_name = srv_name
        self.callback = callback
        self.callback_group = group
        self.queue: deque[tuple[Any, Client, Future]] = deque()
        self._directory = node.process.ros.part(ServiceDirectory)
        self._directory.services[srv_name] = self
        for task in self._directory.waiting:
            node.process.scheduler.wake(task)

    def is_ready(self) -> bool:
        """Tell whether a request waits."""
        return bool(self.queue)

    def run(self) -> Any:
        """Answer the oldest request; a coroutine answers when it has finished."""
        request, client, future = self.queue.popleft()
        response = self.callback(request, self.srv_type.Response())
        if inspect.iscoroutine(response):
            return self._answer_later(response, client, future)
        client.answer(future, snapshot(response))
        return None

    async def _answer_later(self, response: Any, client: Client, future: Future) -> None:
        client.answer(future, snapshot(await response))

    def destroy(self) -> None:
        """Stop serving."""
        if self._directory.services.get(self.srv_name) is self:
            del self._directory.services[self.srv_name]


class Client:
    """Calls a service."""

    def __init__(self, node: Node, srv_type: Any, srv_name: str, group: Any) -> None:
        self.node = node
        self.srv_type = srv_type
        self.srv_name = self.service_name = srv_name
        self.callback_group = group
        self.queue: deque[tuple[Future, Any]] = deque()
        self._directory = node.process.ros.part(ServiceDirectory)
        self._calling: dict[Future, Task] = {}

    def service_is_ready(self) -> bool:
        """Tell whether somebody serves it."""
        return self.srv_name in self._directory.services

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Wait until somebody serves it; tell whether that was within the timeout."""
        clock, task = self.node.process.scheduler, current_task()
        until = None if timeout_sec is None else clock.time + nanoseconds(timeout_sec)
        self._directory.waiting.append(task)
        while (
            not self.service_is_ready() and self.node.context.ok() and (until is None or clock.time < until)
        ):
            clock.wait(until)
        self._directory.waiting.remove(task)
        if self.node.process.ending:
            self.node.process.refuse_to_wait()
        return self.service_is_ready()

    def call_async(self, request: Any) -> Future:
        """Send a request; the future is done once an executor has handled the response."""
        if not isinstance(request, self.srv_type.Request):
            raise TypeError(f"Expected {self.srv_type.Request}, got {type(request)}")
        future = Future(executor=self.node.executor)
        service = self._directory.services.get(self.srv_name)
        if service is not None:
            service.queue.append((snapshot(request), self, future))
            service.node.notify()
        return future

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Send a request and wait for the response in this task; None after the timeout."""
        clock = self.node.process.scheduler
        future = self.call_async(request)
        self._calling[future] = current_task()
        until = None if timeout_sec is None else clock.time + nanoseconds(timeout_sec)
        while not future.done() and self.node.context.ok() and (until is None or clock.time < until):
            clock.wait(until)
        del self._calling[future]
        return future.result()

    def answer(self, future: Future, response: Any) -> None:
        """Take a response: for a waiting `call` at once, for a future through the executor."""
        waiting = self._calling.get(future)
        if waiting is not None:
            future.set_result(response)
            self.node.process.scheduler.wake(waiting)
            return
        self.queue.append((future, response))
        self.node.notify()

    def is_ready(self) -> bool:
        """Tell whether a response waits."""
        return bool(self.queue)

    def run(self) -> None:
        """Complete the oldest future whose response has arrived."""
        future, response = self.queue.popleft()
        if not future.cancelled():
            future.set_result(response)

    def remove_pending_request(self, future: Future) -> None:
        """Give up on a request."""
        future.cancel()

    def destroy(self) -> None:
        """Forget it."""
