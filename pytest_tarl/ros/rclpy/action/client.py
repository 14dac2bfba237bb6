"""rclpy's ActionClient."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.messages.snapshot import snapshot
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.rclpy.action.handles import ActionDirectory, ClientGoalHandle, goal_key
from pytest_tarl.ros.rclpy.task import Future
from pytest_tarl.ros.scheduler import current_task

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.node import Node

_LOOK = nanoseconds(0.25)  # rclpy's polling period when waiting for the server


class ActionClient:
    """Sends goals."""

    def __init__(
        self, node: Node, action_type: Any, action_name: str, *, callback_group: Any = None, **_qos: Any
    ) -> None:
        self._node = node
        self._action_type = action_type
        self._name = node.resolve_service_name(action_name)
        self._mailbox = node.create_mailbox(callback_group)
        self._directory = node.process.ros.part(ActionDirectory)
        self._feedback: dict[bytes, Callable[[Any], Any]] = {}
        self._handles: dict[bytes, ClientGoalHandle] = {}

    def server_is_ready(self) -> bool:
        """Return whether the action has a server."""
        asked()
        return self._name in self._directory.servers

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        """Wait for a server; return whether one appeared in time."""
        process = self._node.process
        clock = process.scheduler
        until = None if timeout_sec is None else clock.time + nanoseconds(timeout_sec)
        while not self.server_is_ready() and self._node.context.ok():
            if until is not None and clock.time >= until:
                break
            clock.wait(clock.time + _LOOK if until is None else min(until, clock.time + _LOOK))
        if process.ending:
            process.refuse_to_wait()
        return self.server_is_ready()

    def send_goal_async(
        self, goal: Any, feedback_callback: Callable[[Any], Any] | None = None, goal_uuid: Any = None
    ) -> Future:
        """Send a goal; the future's result is a goal handle. Raise TypeError for a goal of another type."""
        if not isinstance(goal, self._action_type.Goal):
            raise TypeError(f"Expected goal type ({self._action_type.Goal}) but received ({type(goal)})")
        goal_id = goal_uuid if goal_uuid is not None else self._directory.new_goal_id()
        if feedback_callback is not None:
            self._feedback[goal_key(goal_id)] = feedback_callback
        future = Future()
        server = self._directory.servers.get(self._name)
        if server is not None:
            server.goal_arrives(self, goal_id, snapshot(goal), future)
        return future

    def send_goal(self, goal: Any, **options: Any) -> Any:
        """Send a goal and wait for its result; another task must spin."""
        handle = self.block_on(self.send_goal_async(goal, **options))
        return self.block_on(self.result_of(handle))

    def result_of(self, handle: ClientGoalHandle) -> Future:
        """Request a goal's result from the server."""
        return self._ask("result_wanted", handle)

    def cancel(self, handle: ClientGoalHandle) -> Future:
        """Ask the server to cancel a goal."""
        return self._ask("cancel_arrives", handle)

    def block_on(self, future: Future) -> Any:
        """Block this task until a future is done."""
        clock, task = self._node.process.scheduler, current_task()
        future.watch(lambda: clock.wake(task))
        while not future.done() and self._node.context.ok():
            clock.wait()
        if self._node.process.ending:
            self._node.process.refuse_to_wait()
        return future.result()

    def answer_arrives(self, future: Future, goal_id: Any, accepted: bool, stamp: Any) -> None:
        """Handle the server's answer to a goal."""
        handle = ClientGoalHandle(self, goal_id, accepted=accepted, stamp=stamp)
        if accepted:
            self._handles[goal_key(goal_id)] = handle
        self.complete(future, handle)

    def feedback_arrives(self, message: Any) -> None:
        """Handle feedback."""
        callback = self._feedback.get(goal_key(message.goal_id))
        if callback is not None:
            self._mailbox.post(callback, message)

    def status_arrives(self, goal_id: Any, status: int) -> None:
        """Handle a goal's new state."""
        self._mailbox.post(self._take_status, goal_key(goal_id), status)

    def complete(self, future: Future, result: Any) -> None:
        """Complete a future through the executor."""
        self._mailbox.post(self._complete, future, result)

    def destroy(self) -> None:
        """Discard all goals."""
        self._mailbox.destroy()
        self._feedback.clear()

    def __enter__(self) -> ActionClient:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy()

    def _ask(self, what: str, handle: ClientGoalHandle) -> Future:
        if not isinstance(handle, ClientGoalHandle):
            raise TypeError(f"Expected type ClientGoalHandle but received {type(handle)}")
        future = Future()
        server = self._directory.servers.get(self._name)
        if server is not None:
            getattr(server, what)(handle.goal_id, self, future)
        return future

    def _take_status(self, key: bytes, status: int) -> None:
        if key in self._handles:
            self._handles[key].status = status

    def _complete(self, future: Future, result: Any) -> None:
        if not future.cancelled():
            future.belongs_to(self._node.executor)
            future.set_result(result)


__all__ = ["ActionClient", "ClientGoalHandle"]
