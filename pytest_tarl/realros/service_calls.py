"""Service calls of rospy in lock-step: each is on the wire, or in a handler that plays in virtual time.

Time stands still while any call is on the wire. What has come off it goes on in an order that does not depend on the
network: answers in the order of the calls, then requests by service and content.
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

Outcome = Callable[[], Any]  # returns what a call returned, raises what it raised
Order = tuple[int, int, str]


class Arrival(NamedTuple):
    """What has come off the wire, with its place among what comes at the same time."""

    order: Order
    goes_on: Callable[[], None]


class ServiceCalls:
    """The calls of one episode. Everything but `_arrived` belongs to the test's thread."""

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler
        self._arrival = threading.Condition()
        self._arrived: list[Arrival] = []
        self._made = 0
        self._on_wire = 0

    def served(self, process: Process, service: str, handler: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """Return a service's handler that runs as a task of its node, whoever's thread calls it."""

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
        """Run a blocking call of rospy in a thread; meanwhile nodes run, the calling task waits."""
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
        """Note that a request or an answer goes onto the wire, and see to it that it is waited for."""
        self._on_wire += 1
        self._scheduler.later(self._attend)

    def _comes(self, arrival: Arrival) -> None:
        with self._arrival:
            self._arrived.append(arrival)
            self._arrival.notify()

    def _attend(self) -> None:
        """Wait for all that is on the wire, then let it go on. Raise RecordingError on failure."""
        if not self._on_wire:
            return
        with self._arrival:
            if not self._arrival.wait_for(lambda: len(self._arrived) >= self._on_wire, PATIENCE):
                raise RecordingError(
                    f"A service call or its answer did not arrive within {PATIENCE:g} s: look whether the network "
                    "of this machine lets processes talk on 127.0.0.1, and whether the service is a node of the test."
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
