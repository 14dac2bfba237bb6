"""rclpy's ActionServer."""

# ruff: noqa: ARG001 (signatures are rclpy's)

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.messages.snapshot import snapshot
from pytest_tarl.ros.rclpy.action.handles import (
    CANCELING,
    UNKNOWN,
    ActionDirectory,
    CancelResponse,
    GoalResponse,
    ServerGoalHandle,
    goal_key,
)
from pytest_tarl.ros.rclpy.exceptions import RCLError
from pytest_tarl.ros.rclpy.returned import require_returned
from pytest_tarl.ros.rclpy.task import Future

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.action.client import ActionClient
    from pytest_tarl.ros.rclpy.node import Node

__all__ = ["ActionServer", "CancelResponse", "GoalResponse", "ServerGoalHandle"]


async def _result_of(function: Callable[..., Any], *args: Any) -> Any:
    """Call a function or await a coroutine function."""
    outcome = function(*args)
    return await outcome if inspect.iscoroutine(outcome) else outcome


def default_handle_accepted_callback(goal_handle: ServerGoalHandle) -> None:
    """Execute the goal immediately."""
    goal_handle.execute()


def default_goal_callback(goal_request: Any) -> GoalResponse:
    """Accept every goal."""
    return GoalResponse.ACCEPT


def default_cancel_callback(goal_handle: Any) -> CancelResponse:
    """Reject the cancel request."""
    return CancelResponse.REJECT


class ActionServer:
    """Executes goals by `execute_callback(goal_handle)`, which returns the result."""

    def __init__(
        self,
        node: Node,
        action_type: Any,
        action_name: str,
        execute_callback: Callable[[ServerGoalHandle], Any] | None,
        *,
        callback_group: Any = None,
        goal_callback: Callable[[Any], Any] = default_goal_callback,
        handle_accepted_callback: Callable[[ServerGoalHandle], Any] = default_handle_accepted_callback,
        cancel_callback: Callable[[Any], Any] = default_cancel_callback,
        **_qos_and_timeout: Any,
    ) -> None:
        self._node = node
        self.action_type = action_type
        self._name = node.resolve_service_name(action_name)
        self._mailbox = node.create_mailbox(callback_group)
        self._logger = node.get_logger().get_child("action_server")
        self._goals: dict[bytes, ServerGoalHandle] = {}
        self._directory = node.process.ros.part(ActionDirectory)
        self._directory.servers[self._name] = self
        self.register_execute_callback(execute_callback)
        self.register_goal_callback(goal_callback)
        self.register_handle_accepted_callback(handle_accepted_callback)
        self.register_cancel_callback(cancel_callback)

    def register_execute_callback(self, execute_callback: Any) -> None:
        """Replace the execute callback. Raise TypeError if the new one is not callable."""
        if not callable(execute_callback):
            raise TypeError("Failed to register goal execution callback: not callable")
        self._execute_callback: Callable[[ServerGoalHandle], Any] = execute_callback

    def register_goal_callback(self, goal_callback: Callable[[Any], Any] | None) -> None:
        """Replace the goal callback, which accepts or rejects goals."""
        self._goal_callback = goal_callback or default_goal_callback

    def register_handle_accepted_callback(self, callback: Callable[[ServerGoalHandle], Any] | None) -> None:
        """Replace the callback for accepted goals."""
        self._handle_accepted_callback = callback or default_handle_accepted_callback

    def register_cancel_callback(self, cancel_callback: Callable[[Any], Any] | None) -> None:
        """Replace the cancel callback, which accepts or rejects cancel requests."""
        self._cancel_callback = cancel_callback or default_cancel_callback

    def goal_arrives(self, client: ActionClient, goal_id: Any, goal: Any, future: Future) -> None:
        """Post a goal request to the server's executor."""
        self._mailbox.post(self._take_goal, client, goal_id, goal, future)

    def cancel_arrives(self, goal_id: Any, client: ActionClient, future: Future) -> None:
        """Post a cancel request to the server's executor."""
        self._mailbox.post(self._take_cancel, goal_id, client, future)

    def result_wanted(self, goal_id: Any, client: ActionClient, future: Future) -> None:
        """Post a result request to the server's executor."""
        self._mailbox.post(self._send_result, goal_id, client, future)

    def notify_execute(
        self, goal: ServerGoalHandle, callback: Callable[[ServerGoalHandle], Any] | None
    ) -> None:
        """Post the execution of a goal to the node's executor."""
        self._node.executor.create_task(self._execute, callback or self._execute_callback, goal)

    def destroy(self) -> None:
        """Stop serving."""
        if self._directory.servers.get(self._name) is self:
            del self._directory.servers[self._name]
        self._mailbox.destroy()

    def __enter__(self) -> ActionServer:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy()

    async def _take_goal(self, client: ActionClient, goal_id: Any, goal: Any, future: Future) -> None:
        answer = await _result_of(self._goal_callback, goal)
        accepted = answer == GoalResponse.ACCEPT
        if not isinstance(answer, GoalResponse):
            self._logger.warning("Goal request callback did not return a GoalResponse type. Rejecting goal.")
        stamp = self._node.get_clock().now().to_msg()
        handle = ServerGoalHandle(self, client, goal_id, goal)
        if accepted:
            handle.result = Future()
            self._goals[goal_key(goal_id)] = handle
        client.answer_arrives(future, goal_id, accepted, stamp)
        if accepted:
            client.status_arrives(goal_id, handle.status)
            await _result_of(self._handle_accepted_callback, handle)

    async def _execute(self, callback: Callable[[ServerGoalHandle], Any], handle: ServerGoalHandle) -> None:
        try:
            result = await _result_of(callback, handle)
        except Exception as error:
            if getattr(error, "tarl_shutdown", False):
                raise
            self._logger.error(f"Error raised in execute callback: {error}")
            result = self.action_type.Result()
        what = f"the execute callback of action {self._name}"
        require_returned(result, self.action_type.Result, what, callback)
        if handle.is_active:
            self._logger.warning(
                f"Goal state not set, assuming aborted. Goal ID: {goal_key(handle.goal_id).hex()}"
            )
            handle.abort()
        response = self.action_type.Impl.GetResultService.Response()
        response.status, response.result = handle.status, result
        if handle.result is not None:
            handle.result.set_result(response)

    async def _take_cancel(self, goal_id: Any, client: ActionClient, future: Future) -> None:
        response: Any = find_class("ros2", "action_msgs", "CancelGoal", "srv").Response()  # type: ignore[union-attr]
        handle = self._goals.get(goal_key(goal_id))
        if handle is None:
            response.return_code = response.ERROR_UNKNOWN_GOAL_ID
        elif not handle.is_active:
            response.return_code = response.ERROR_GOAL_TERMINATED
        elif await _result_of(self._cancel_callback, handle) == CancelResponse.ACCEPT:
            try:
                handle.move_to(CANCELING)
            except RCLError as error:
                self._logger.debug(f"Failed to cancel goal in cancel callback: {error}")
            else:
                info: Any = find_class("ros2", "action_msgs", "GoalInfo")
                response.goals_canceling = [info(goal_id=goal_id)]
        else:
            response.return_code = response.ERROR_REJECTED
        client.complete(future, response)

    def _send_result(self, goal_id: Any, client: ActionClient, future: Future) -> None:
        handle = self._goals.get(goal_key(goal_id))
        if handle is None or handle.result is None:
            response = self.action_type.Impl.GetResultService.Response()
            response.status = UNKNOWN
            client.complete(future, response)
            return
        result = handle.result
        result.watch(lambda: client.complete(future, snapshot(result.result())))
