"""rclpy's wait_for_message."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.scheduler import current_task

__all__ = ["wait_for_message"]


def wait_for_message(
    msg_type: Any, node: Any, topic: str, *, qos_profile: Any = 1, time_to_wait: float = -1
) -> tuple[bool, Any]:
    """Wait for the next message on a topic, without an executor; return (False, None) after the timeout."""
    clock, task = node.process.scheduler, current_task()
    until = None if time_to_wait < 0 else clock.time + nanoseconds(time_to_wait)
    subscription = node.create_subscription(msg_type, topic, lambda _: None, qos_profile)
    subscription.arrived = lambda: clock.wake(task)
    try:
        while not subscription.queue and node.context.ok() and (until is None or clock.time < until):
            clock.wait(until)
        return (True, subscription.queue.popleft()) if subscription.queue else (False, None)
    finally:
        node.destroy_subscription(subscription)
