"""Run rospy's service calls in lock-step: a call is either in transit, or in its handler in virtual time.

Virtual time stands still while a call is in transit. Arrivals are handled in an order that does not depend on the
network: first answers, in the order of their calls; then requests, sorted by service and content.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from pytest_tarl.errors import RecordingError
from pytest_tarl.realros.lockstep import PATIENCE
from pytest_tarl.ros.process import Process
from pytest_tarl.ros.scheduler import Scheduler, Task

Outcome = Callable[[], Any]  # returns the result of a call, or raises its exception
Order = tuple[int, int, str]


class Arrival(NamedTuple):
    """A request or answer that arrived, with its place among simultaneous ones."""

    order: Order
    goes_on: Callable[[], None]


class ServiceCalls:
    """The calls of one episode.

    Threads other than the test's access only `_arrived`, and only while they hold the lock `_arrival`.
    """

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler
        self._arrival = threading.Condition()
        self._arrived: list[Arrival] = []
        self._made = 0
        self._on_wire = 0

    def served(self, process: Process, service: str, handler: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """Return a handler that any thread may call; it runs the original handler in a task of its node."""

        def handle(request: Any) -> Any:
            answer: list[Outcome] = []
            done = threading.Event()
            serve = partial(self._serve, partial(handler, request), answer, done)
            order = (1, 0, f"{service} {request}")
            self._comes(Arrival(order, lambda: self._begin(process, serve)))
            done.wait()
            return answer[0]() if answer else None

        return handle

    def call(self, task: Task, call: Outcome) -> Any:
        """Run a blocking rospy call in a thread; the calling task waits while other nodes run."""
        outcome: list[Outcome] = []
        self._made += 1
        order = (0, self._made, "")

        def work() -> None:
            result = _outcome_of(call)
            self._comes(Arrival(order, lambda: self._ended(task, outcome, result)))

        self._sent()
        threading.Thread(target=work, daemon=True).start()
        while not outcome:
            self._scheduler.wait()
        return outcome[0]()

    def _serve(self, handler: Outcome, answer: list[Outcome], done: threading.Event) -> None:
        try:
            answer.append(_outcome_of(handler))
        finally:
            self._sent()
            done.set()

    def _begin(self, process: Process, serve: Callable[[], None]) -> None:
        self._scheduler.spawn(process, serve)

    def _ended(self, task: Task, outcome: list[Outcome], result: Outcome) -> None:
        outcome.append(result)
        self._scheduler.wake(task)

    def _sent(self) -> None:
        """Count a request or answer as in transit, and schedule waiting for it."""
        self._on_wire += 1
        self._scheduler.later(self._attend)

    def _comes(self, arrival: Arrival) -> None:
        with self._arrival:
            self._arrived.append(arrival)
            self._arrival.notify()

    def _attend(self) -> None:
        """Wait for everything in transit, then handle it in order. Raise RecordingError after PATIENCE."""
        if not self._on_wire:
            return
        with self._arrival:
            if not self._arrival.wait_for(lambda: len(self._arrived) >= self._on_wire, PATIENCE):
                raise RecordingError(
                    f"A service call or its answer did not arrive within {PATIENCE:g} s: check that processes "
                    "on this machine can communicate through 127.0.0.1, and that a node of the test "
                    "offers the service."
                )
            arrived, self._arrived = sorted(self._arrived, key=lambda one: one.order), []
        self._on_wire -= len(arrived)
        for arrival in arrived:
            arrival.goes_on()


def _outcome_of(call: Outcome) -> Outcome:
    try:
        result = call()
    except Exception as error:
        return partial(_raise, error)
    return lambda: result


def _raise(error: BaseException) -> Any:
    raise error
