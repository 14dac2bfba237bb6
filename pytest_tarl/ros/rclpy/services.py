"""rclpy's services and clients: requests and responses wait for the receiving node's executor."""

from __future__ import annotations

import inspect
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.rclpy.returned import require_returned
from pytest_tarl.ros.rclpy.service_introspection import Introspected
from pytest_tarl.ros.rclpy.task import Future
from pytest_tarl.ros.scheduler import Task, current_task
from pytest_tarl.ros.services import Answer, Refusal, adapted

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.node import Node


SrvType = TypeVar("SrvType")  # three names of rclpy that nodes use in annotations
SrvTypeRequest = TypeVar("SrvTypeRequest")
SrvTypeResponse = TypeVar("SrvTypeResponse")


class Service(Introspected):
    """Answers requests with `callback(request, response)`."""

    def __init__(
        self, node: Node, srv_type: Any, srv_name: str, callback: Callable[..., Any], group: Any
    ) -> None:
        self.node = node
        self.srv_type = self.service_class = srv_type
        self.request_type: type = srv_type.Request
        self.srv_name = self.service_name = srv_name
        self.callback = callback
        self.callback_group = group
        self.queue: deque[tuple[Any, Answer]] = deque()
        self._directory = node.process.ros.services
        self._directory.add(srv_name, self)

    def handle(self, request: Any, answer: Answer) -> None:
        """Queue a request for the node's executor."""
        self.queue.append((request, answer))
        self.node.notify()

    def is_ready(self) -> bool:
        """Return whether a request is waiting."""
        return bool(self.queue)

    def run(self) -> Any:
        """Handle the oldest request; if the callback is a coroutine, answer when it has finished."""
        request, answer = self.queue.popleft()
        response = self.callback(request, self.srv_type.Response())
        if inspect.iscoroutine(response):
            return self._answer_later(response, answer)
        answer(self._checked(response))
        return None

    async def _answer_later(self, response: Any, answer: Answer) -> None:
        answer(self._checked(await response))

    def _checked(self, response: Any) -> Any:
        what = f"the callback of service {self.srv_name}"
        require_returned(response, self.srv_type.Response, what, self.callback)
        return response

    def destroy(self) -> None:
        """Stop serving."""
        self._directory.remove(self.srv_name, self)


class Client(Introspected):
    """Calls a service."""

    def __init__(self, node: Node, srv_type: Any, srv_name: str, group: Any) -> None:
        self.node = node
        self.srv_type = srv_type
        self.srv_name = self.service_name = srv_name
        self.callback_group = group
        self.queue: deque[tuple[Future, Any]] = deque()
        self._directory = node.process.ros.services
        self._calling: dict[Future, Task] = {}
        self._pending: list[Future] = []

    def service_is_ready(self) -> bool:
        """Return whether the service is available."""
        asked()
        return self.srv_name in self._directory

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Wait for the service; return whether it became available in time."""
        process = self.node.process
        until = None if timeout_sec is None else process.scheduler.time + nanoseconds(timeout_sec)
        found = self._directory.wait(current_task(), self.srv_name, until, self.node.context.ok)
        if process.ending:
            process.refuse_to_wait()
        return found

    def call_async(self, request: Any) -> Future:
        """Send a request; the future is done when an executor has handled the response.

        Raise TypeError for a request of another type.
        """
        if not isinstance(request, self.srv_type.Request):
            raise TypeError(f"Expected {self.srv_type.Request}, got {type(request)}")
        future = Future()
        service = self._directory.find_as(self.srv_name, self.srv_type, self.node.process.label)
        if service is not None:
            service.handle(
                adapted(request, service.request_type), lambda response: self.answer(future, response)
            )
        self._pending.append(future)
        return future

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Send a request and wait for the response in this task; return None after the timeout."""
        clock = self.node.process.scheduler
        future = self.call_async(request)
        self._calling[future] = current_task()
        until = None if timeout_sec is None else clock.time + nanoseconds(timeout_sec)
        while not future.done() and self.node.context.ok() and (until is None or clock.time < until):
            clock.wait(until)
        del self._calling[future]
        return future.result()

    def answer(self, future: Future, response: Any) -> None:
        """Handle a response: a waiting `call` returns it at once; a future is completed by the executor.

        A ROS 2 client never learns that a ROS 1 node refused its request: the bridge between them only logs this.
        """
        if isinstance(response, Refusal):
            self.node.get_logger().error(f"{self.srv_name} gave no response: {response.reason}")
            return
        response = adapted(response, self.srv_type.Response)
        waiting = self._calling.get(future)
        if waiting is not None:
            future.set_result(response)
            self.node.process.scheduler.wake(waiting)
            return
        self.queue.append((future, response))
        self.node.notify()

    def is_ready(self) -> bool:
        """Return whether a response is waiting."""
        return bool(self.queue)

    def run(self) -> None:
        """Complete the oldest future whose response has arrived."""
        future, response = self.queue.popleft()
        if future in self._pending:
            self._pending.remove(future)
        if not future.cancelled():
            future.belongs_to(self.node.executor)
            future.set_result(response)

    def remove_pending_request(self, future: Future) -> None:
        """Discard a request."""
        if future in self._pending:
            self._pending.remove(future)

    def destroy(self) -> None:
        """Discard all requests."""
        for future in self._pending:
            future.cancel()
        self._pending.clear()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy()
