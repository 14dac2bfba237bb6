"""Find the subscriptions of an installed rclpy that have a waiting message."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from typing import Any


def silent(rclpy: Any, context: Any, subscriptions: Sequence[Any]) -> list[Any]:
    """Return the subscriptions without a waiting message; messages stay queued."""
    make = rclpy.impl.implementation_singleton.rclpy_implementation.WaitSet
    with ExitStack() as open_:
        for one in (*(subscription.handle for subscription in subscriptions), context.handle):
            open_.enter_context(one)
        waiting = make(len(subscriptions), 0, 0, 0, 0, 0, context.handle)
        waiting.clear_entities()
        for subscription in subscriptions:
            waiting.add_subscription(subscription.handle)
        waiting.wait(0)
        ready = set(waiting.get_ready_entities("subscription"))
        return [one for one in subscriptions if one.handle.pointer not in ready]
