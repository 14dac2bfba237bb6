"""States that watch a topic or a condition, and a function that ends a container with its node."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from pytest_tarl.ros.rospy.node import is_shutdown, on_shutdown
from pytest_tarl.ros.rospy.timing import Duration, get_time, sleep
from pytest_tarl.ros.rospy.topics import Subscriber
from pytest_tarl.ros.smach.state import State
from pytest_tarl.ros.smach_ros import slots

_LOOK = Duration(0.05)


class MonitorState(State):
    """Calls `cond_cb(userdata, message)` for each message on a topic, until it returns a false value.

    The outcome is "invalid" after a false value, "valid" after `max_checks` messages, or "preempted".
    """

    def __init__(
        self,
        topic: str,
        msg_type: Any,
        cond_cb: Callable[..., Any],
        max_checks: int = -1,
        input_keys: Iterable[str] = (),
        output_keys: Iterable[str] = (),
    ) -> None:
        super().__init__(["valid", "invalid", "preempted"], input_keys, output_keys)
        self._topic, self._type, self._condition = topic, msg_type, cond_cb
        self._most = max_checks
        slots.declare(self, [cond_cb], (), ())

    def execute(self, ud: Any) -> str:
        """Watch the topic, and return the outcome."""
        if self.preempt_requested():
            self.service_preempt()
            return "preempted"
        ended: list[str] = []
        count = [0]

        def take(message: Any) -> None:
            if ended:
                return
            count[0] += 1
            if 0 < self._most <= count[0]:
                ended.append("valid")
            elif not self._condition(ud, message):
                ended.append("invalid")

        subscriber = Subscriber(self._topic, self._type, take)
        while not ended and not self.preempt_requested() and not is_shutdown():
            sleep(_LOOK)
        subscriber.unregister()
        if self.preempt_requested():
            self.service_preempt()
            return "preempted"
        return ended[0] if ended else "preempted"


class ConditionState(State):
    """Calls `cond_cb(userdata)` until it returns a true value.

    The outcome is then "true". It is "false" after `timeout` or, as in smach_ros, after one call more than `max_checks`
    (-1: no limit). It can also be "preempted".
    """

    def __init__(
        self,
        cond_cb: Callable[..., Any],
        input_keys: Iterable[str] = (),
        poll_rate: Any = None,
        timeout: Any = None,
        max_checks: int = 1,
    ) -> None:
        super().__init__(["true", "false", "preempted"], input_keys)
        self._condition, self._most = cond_cb, max_checks
        rate = slots.seconds(poll_rate)
        self._pause = Duration(0.05 if rate is None else rate)
        self._limit = slots.seconds(timeout)
        slots.declare(self, [cond_cb], (), ())

    def execute(self, ud: Any) -> str:
        """Check the condition, and return the outcome."""
        began, checks = get_time(), 0
        while not is_shutdown() and (self._most == -1 or checks <= self._most):
            if self._limit and get_time() - began > self._limit:
                break
            if self.preempt_requested():
                self.service_preempt()
                return "preempted"
            if self._condition(ud):
                return "true"
            checks += 1
            sleep(self._pause)
        return "preempted" if is_shutdown() else "false"


def set_preempt_handler(sc: Any) -> None:
    """Ask a container to end when its node ends."""

    def end() -> None:
        if sc.is_running():
            sc.request_preempt()

    on_shutdown(end)
