"""An external simulator in an episode; the nodes follow its clock."""

from __future__ import annotations

import os
import queue
import signal
from collections.abc import Callable, Sequence
from time import monotonic, time_ns
from typing import TYPE_CHECKING, Any

from pytest_tarl.errors import SimulatorError, SimulatorLostError
from pytest_tarl.external.arguments import Call, Setup
from pytest_tarl.external.client import Event
from pytest_tarl.external.kept_simulator import KEPT
from pytest_tarl.external.plain import filled, to_plain
from pytest_tarl.external.shutdown_output import without_interrupts
from pytest_tarl.ros.clock import nanoseconds, seconds
from pytest_tarl.ros.messages import find_class, unknown_type
from pytest_tarl.ros.messages.snapshot import snapshot, type_name

if TYPE_CHECKING:
    from pytest_tarl.ros import Ros

SETTLED = 0.3  # the simulator has started once the ROS graph was unchanged for this time (s of real time)


class Simulator:
    """The simulator of an episode; `latest(topic)` returns its last message on a topic."""

    def __init__(self, setup: Setup, ros: Ros, watched: Sequence[str]) -> None:
        self.setup = setup
        self._ros = ros
        self._client = KEPT.opened()
        self._topics = dict.fromkeys((*setup.ready, *setup.every_step, *watched))
        self._heard: dict[
            str, int
        ] = {}  # topic → when its newest message was sent, in ns of this machine's clock
        self._latest: dict[str, Any] = {}
        self._graph: dict[str, set[str]] = {"published": set(), "subscribed": set(), "connected": set()}
        self._forwarded: set[str] = set()
        self._answers: dict[int, Event] = {}
        self._calls = 0
        self._clock: int | None = None
        self._target = 0
        self._tick = 0
        self._waiting: (
            list[Event] | None
        ) = []  # messages to deliver later; None while messages are delivered at once
        # whether the running simulator was ever ready; the graph does not tell, because a simulator also leaves it when
        # it ends, and this event may arrive first
        self._was_ready = False
        # whether the last step ended without an error, so that the simulator can be used again
        self._usable = False
        # whether arriving events come from the simulator of this episode
        self._current = False

    @property
    def clock(self) -> float:
        """Return the simulator's time in s."""
        return seconds(self._clock or 0)

    def latest(self, topic: str) -> Any | None:
        """Return the simulator's newest message on a topic, or None.

        Messages of a topic that no node, sensor or argument names are received only after the first call.
        """
        if topic not in self._topics:
            self._want([topic])
        return self._latest.get(topic)

    def begin(self) -> None:
        """Start or reset the simulator. Raise SimulatorError if it does not become ready."""
        if self.setup.reset is None or KEPT.running != self.setup or not self._reset(self.setup.reset):
            self._start()
        self._wait(self._ready, self.setup.timeout, self._unready)
        self._was_ready = True
        self._settle()
        assert self._clock is not None  # noqa: S101 - it is ready
        self._ros.scheduler.time = self._target = self._clock
        KEPT.running = self.setup

    def advance(self, dt: float) -> None:
        """Run simulator and nodes for `dt` s of simulator time. Raise SimulatorLostError."""
        self._usable = False
        self._connect()
        self._target += nanoseconds(dt)
        if self.setup.step is not None:
            self._stepped(self.setup.step)
        else:
            # the running simulator is already past this time
            if self._target <= self._time:
                self._target = self._time + nanoseconds(dt)
            self._deliver(self._released())
            self._wait(lambda: self._time >= self._target, self.setup.patience, self._hung)
        self._usable = True

    def end(self) -> None:
        """Print the simulator's output; end the simulator unless it can be reset."""
        _print(self.setup, self._client.output())
        if self.setup.reset is None or not self._usable:
            self._stop(self.setup)

    @property
    def _time(self) -> int:
        return -1 if self._clock is None else self._clock

    def _stop(self, running: Setup) -> None:
        """End the running simulator, and print what it writes while shutting down."""
        KEPT.running = None
        self._client.stop()
        _print(running, without_interrupts(self._client.output()), " after TARL had ended it")

    def _start(self) -> None:
        one = self.setup
        if KEPT.running is not None:
            self._stop(KEPT.running)
        # rospy connects to only one master per process, and a new simulator has a new master
        if one.ros == "ros1":
            KEPT.close()
            self._client = KEPT.opened()
        self._forget()
        environment = {
            "PYTHONUNBUFFERED": "1",
            **os.environ,
            **one.environment,
        }  # error messages quote the simulator's last output
        self._client.do(
            "start",
            command=list(one.command),
            folder=str(one.folder),
            environment=environment,
            clock=one.clock,
            topics=list(self._topics),
            ros=one.ros,
        )
        self._wait(lambda: self._current, self.setup.timeout, self._unready)

    def _reset(self, reset: Call) -> bool:
        """Reset the running simulator; return whether it answered."""
        self._current = self._was_ready = True
        try:
            self._client.do("subscribe", topics=list(self._topics))
            self._call(reset)
        except SimulatorError as problem:
            self._current = self._was_ready = False
            why = problem.why if isinstance(problem, SimulatorLostError) else str(problem).removesuffix(".")
            self._ros.note(f"The simulator could not be reset, so a new one was started: {why}.")
            return False
        self._forget()
        return True

    def _forget(self) -> None:
        """Forget the old time, so that the simulator does not count as ready at once."""
        self._heard.clear()
        self._clock = None
        self._waiting = []

    def _ready(self) -> bool:
        connected = {*self._graph["subscribed"], *self._heard}
        return self._time > 0 and all(topic in connected for topic in self.setup.ready)

    def _settle(self) -> None:
        """Wait until the ROS graph is stable, so that early commands arrive."""
        calm = monotonic()
        while monotonic() - calm < SETTLED:
            event = self._next(SETTLED / 4)
            if event is not None and event["kind"] == "graph":
                calm = monotonic()

    def _connect(self) -> None:
        """Connect the topics of nodes and simulator."""
        for topic in sorted(self._graph["subscribed"] - self._forwarded - {self.setup.clock}):
            self._forwarded.add(topic)
            self._ros.bus.subscribe(topic, self._forward(topic))
        self._want(sorted(self._ros.bus.subscribed - {*self._topics, self.setup.clock}))

    def _want(self, topics: Sequence[str]) -> None:
        """Receive further topics; wait for connections to those that the simulator publishes."""
        if not topics:
            return
        self._topics.update(dict.fromkeys(topics))
        self._client.do("subscribe", topics=list(topics))
        theirs = self._graph["published"].intersection(topics)
        self._wait(lambda: theirs <= self._graph["connected"], self.setup.patience, self._hung)

    def _forward(self, topic: str) -> Callable[[Any], None]:
        return lambda message: self._client.do("send", topic=topic, data=to_plain(self._theirs(message)))

    def _class(self, package: str, name: str) -> Any:
        """Return a message class of the simulator. Raise UnsupportedApiError."""
        found = find_class("ros1" if self.setup.ros == "ros1" else "ros2", package, name)
        if found is None:
            raise unknown_type(package, name)
        return found

    def _theirs(self, message: Any) -> Any:
        """Convert a node's message to the class used by the simulator's ROS."""
        package, _, name = type_name(type(message)).partition("/")
        wanted = self._class(package, name)
        return message if type(message) is wanted else snapshot(message, wanted)

    def _stepped(self, step: Call) -> None:
        """Run the nodes up to the next step, then make the step."""
        self._deliver(self._released())
        while self._time < self._target:
            before = self._time
            self._run_nodes(min(self._target, before + self._tick) if self._tick else self._target)
            self._waiting = []
            asked = self._call(step)
            self._wait(lambda: self._over(before, asked), self.setup.patience, self._hung)  # noqa: B023 - called now
            self._tick = self._time - before
            self._run_nodes(self._time)
            self._deliver(self._released())
            self._waiting = []

    def _over(self, before: int, asked: int) -> bool:
        """Return whether a step has ended, according to its clock and topics.

        Messages sent before the step was requested may still arrive; they do not count.
        """
        return self._time > before and all(
            self._heard.get(topic, 0) >= asked for topic in self.setup.every_step
        )

    def _released(self) -> list[Event]:
        """Return the waiting messages in a reproducible order."""
        waiting, self._waiting = self._waiting or [], None
        return sorted(waiting, key=lambda event: str(event["topic"]))

    def _deliver(self, events: Sequence[Event]) -> None:
        for event in events:
            self._ros.bus.publish(event["topic"], self._latest[event["topic"]])

    def _run_nodes(self, until: int) -> None:
        if until > self._ros.scheduler.time:
            self._ros.step(seconds(until - self._ros.scheduler.time))

    def _call(self, call: Call) -> int:
        """Call a service and wait for it; return the time of the request (ns of this machine's clock)."""
        self._calls += 1
        number = self._calls
        self._client.do("call", id=number, service=call.service, request=dict(call.request))
        self._wait(lambda: number in self._answers, self.setup.patience, lambda: self._unanswered(call))
        answer = self._answers.pop(number)
        if "error" in answer:
            raise self._lost(
                f"The simulator's service {call.service} failed: {answer['error']}",
                f"its service {call.service} failed",
            )
        return int(answer["asked"])

    def _wait(self, done: Callable[[], bool], limit: float, late: Callable[[], SimulatorError]) -> None:
        """Handle events until a condition holds.

        After `limit` s without progress, raise the error returned by `late`.
        """
        deadline, progress = monotonic() + limit, self._time
        while not done():
            self._next(max(0.0, deadline - monotonic()))
            if self._time > progress:
                deadline, progress = monotonic() + limit, self._time
            if monotonic() > deadline:
                raise late()

    def _next(self, limit: float) -> Event | None:
        try:
            event = self._client.events.get(timeout=limit)
        except queue.Empty:
            return None
        if self._current or event["kind"] in ("stopped", "gone"):
            getattr(self, f"_on_{event['kind']}")(event)
        return event

    def _on_clock(self, event: Event) -> None:
        if self._clock is not None and event["time"] < self._clock and self._waiting is None:
            raise self._lost(
                f"{self.setup.clock} went back from {self.clock:g} s to {seconds(event['time']):g} s during an "
                "episode: something else reset the simulator.",
                f"{self.setup.clock} went back",
            )
        self._clock = event["time"]
        if self._waiting is None:
            self._run_nodes(self._time)

    def _on_message(self, event: Event) -> None:
        topic, (package, *_, name) = event["topic"], event["type"].split("/")
        kind = self._class(package, name)
        self._latest[topic] = filled(kind(), event["data"], self._class)
        self._heard[topic] = event["sent"] or time_ns()
        if self._waiting is None:
            self._ros.bus.publish(topic, self._latest[topic])
        else:
            self._waiting = [*(one for one in self._waiting if one["topic"] != topic), event]

    def _on_graph(self, event: Event) -> None:
        self._graph = {name: {*event[name]} for name in self._graph}

    def _on_answer(self, event: Event) -> None:
        self._answers[event["id"]] = event

    def _on_stopped(self, _: Event) -> None:
        self._current = True

    def _on_failed(self, event: Event) -> None:
        raise SimulatorError(
            f"The simulator {self.setup.shown} cannot be started ({event['reason']}): check the command of "
            "tarl.external."
        )

    def _on_ended(self, event: Event) -> None:
        how = _ending(event["status"])
        if not self._was_ready:
            raise SimulatorError(
                f"The simulator {self.setup.shown} {how} before it was ready{self._words()}."
            )
        when = "during its reset" if self._clock is None else f"at {self.clock:g} s of its time"
        raise self._lost(f"The simulator {self.setup.shown} {how} {when}{self._words()}.", f"it {how}")

    def _on_gone(self, _: Event) -> None:
        raise self._lost(
            f"The process that keeps the simulator has ended{self._words()}.",
            "the process that keeps it ended",
        )

    def _unready(self) -> SimulatorError:
        missing = [one for one in self.setup.ready if one not in {*self._graph["subscribed"], *self._heard}]
        what = f"no message on {missing[0]}" if missing else f"no time on {self.setup.clock}"
        there = ", ".join(sorted(self._graph["published"])) or "nothing"
        return SimulatorError(
            f"The simulator {self.setup.shown} was not ready after {self.setup.timeout:g} s: {what}; it publishes "
            f"{there}. Check `ready` and `clock`, or raise `timeout`{self._words()}."
        )

    def _hung(self) -> SimulatorError:
        return self._lost(
            f"The simulator {self.setup.shown} hung at {self.clock:g} s of simulated time: nothing new came "
            f"within {self.setup.patience:g} s{self._words()}.",
            "it hung",
        )

    def _unanswered(self, call: Call) -> SimulatorError:
        return self._lost(
            f"The simulator did not answer on {call.service} within {self.setup.patience:g} s{self._words()}.",
            f"it did not answer on {call.service}",
        )

    def _lost(self, text: str, why: str) -> SimulatorLostError:
        """Return an error with the last line of the simulator's output."""
        last = self._client.last_words().rpartition(" | ")[2]
        return SimulatorLostError(text, f"{why} (last output: {last})" if last else why)

    def _words(self) -> str:
        words = self._client.last_words()
        return f"; its last output: {words}" if words else ""


def _ending(status: int) -> str:
    """Describe a process's exit status; negative ones are signals."""
    if status >= 0:
        return f"ended with status {status}"
    try:
        return f"was killed by {signal.Signals(-status).name}"
    except ValueError:  # a real-time signal, which has no name
        return f"was killed by signal {-status}"


def _print(of: Setup, output: str, when: str = "") -> None:
    if output.strip():
        print(f"output of {of.shown}{when}:\n{output.strip()}")
