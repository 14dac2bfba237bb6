"""Collect a node's sensor values, rewards and missions for the writer process.

During a control cycle, the observer only appends numbers to lists, and the garbage collector does not visit numbers.
Every `PERIOD` seconds, a thread moves the lists to memory shared with the writer process.
"""

from __future__ import annotations

import sys
import threading
from collections import deque
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import monotonic, time
from typing import Any

from pytest_tarl.errors import TarlError
from pytest_tarl.formulas.signals import Signal, signal_value
from pytest_tarl.observing.log_format import FORMAT
from pytest_tarl.observing.outlet import Outlet
from pytest_tarl.observing.readers import binner, reader
from pytest_tarl.observing.stream import Stream
from pytest_tarl.observing.writer import Rotation
from pytest_tarl.sensors import Cell, Sensor

PERIOD = 0.02  # seconds between two transfers; each holds the interpreter lock for about 0.1 ms
OUTCOMES = {"succeeded": True, "failed": False}


NEVER = Rotation()
_PLAIN = frozenset({type(None), float, int, bool, str})  # types that JSON stores unchanged


class Observer:
    """Observe a node; messages may come from any thread.

    Slow work, such as conversion and disk access, is left to the writer process. Raise LogError if the log cannot be
    written.
    """

    def __init__(
        self,
        sensors: Sequence[Sensor],
        log: Path,
        about: Mapping[str, Any],
        *,
        rotation: Rotation = NEVER,
        idle: float | None = None,
        signals: Sequence[Signal] = (),
        following: bool = False,
    ) -> None:
        self.stream = Stream()
        self.sensors = tuple(sensors)
        self._how = {
            one.name: (at, reader(one.field), binner(one), following and not one.categories)
            for at, one in enumerate(self.sensors)
        }
        self.signals = tuple(signals)  # signals of formulas that come from messages
        self._signal_readers = {one.name: reader(one.field) for one in self.signals}
        self._following = following  # whether to record every change of a value, as formulas require
        self._changes: deque[list[Any]] = deque()  # [seconds, name, value]; any thread may append
        self._times: list[float] = []  # when steps were closed
        self._begun = monotonic()
        self._outlet = Outlet(log, {"format": FORMAT, **about}, rotation)
        self._idle = idle
        self._bins: list[int | None] = [None] * len(self.sensors)
        self._values: list[Any] = [None] * len(self.sensors)
        self._numbers: dict[str, float] = {}  # signal → value received in this mission
        # signal → earlier value, for signals without a message in this mission
        self._before: dict[str, float] = {}
        self._readings: list[Any] = []  # values of all sensors, step after step
        self._active = monotonic()
        self.running = False  # whether a mission is in progress
        self.problem = ""  # the observer's first error, which must not reach the node
        self._lock = threading.RLock()  # keeps records from several threads in order
        # held until `close`; an Event would take more of the node's time
        self._over = threading.Lock()
        self._over.acquire()
        self._thread = threading.Thread(target=self._look, name="tarl-observer", daemon=True)
        self._outlet.put("start", time())
        self._thread.start()

    def told(self, sensor: Sensor, message: Any) -> None:
        """Update a sensor from a message that is about to reach the node."""
        try:
            at, read, bin_of, followed = self._how[sensor.name]
            self._values[at] = value = read(message)
            if followed:
                self._note(sensor.name, value)
            bin_ = bin_of(value)
            if self._bins[at] != bin_:
                self._bins[at] = bin_
                self.stream.latch(self._cell())
        except (TarlError, AttributeError, LookupError, TypeError, ValueError) as problem:
            self.problem = self.problem or f"Sensor {sensor.name!r}: {problem}"

    def signalled(self, signal: Signal, message: Any) -> None:
        """Record the value of a signal."""
        try:
            if self._following:
                self._note(signal.name, self._signal_readers[signal.name](message))
        except (TarlError, AttributeError, LookupError, TypeError, ValueError) as problem:
            self.problem = self.problem or f"Signal {signal.name!r}: {problem}"

    def _note(self, name: str, value: Any) -> None:
        number = signal_value(name, value)
        if self._numbers.get(name) != number:
            self._numbers[name] = number
            if self.running:
                self._changes.append([monotonic() - self._begun, name, number])

    def step(self, reward: float) -> None:
        """Close a step with its reward; NaN if `judge` computes it later."""
        with self._lock:
            self._times.append(monotonic() - self._begun)
            self._readings += self._values
            self.stream.reward(reward)

    def begin(self) -> None:
        """Begin a mission; if one is in progress, it ends as a success."""
        with self._lock:
            self.end(passed=True)
            self._flush()
            self._readings.clear()
            self._times.clear()
            self._changes.clear()
            self._begun = monotonic()
            self._before, self._numbers = self._before | self._numbers, {}
            self.running = True
            self._outlet.put("mission", time())

    def end(self, *, passed: bool, failure: str = "") -> None:
        """End the mission in progress, if any."""
        with self._lock:
            if not self.running:
                return
            self._flush()
            end = {"passed": passed, "failure": failure, "time": time()}
            if self._following:
                silent = [[0.0, name, one] for name, one in self._before.items() if name not in self._numbers]
                end |= {"lasted": monotonic() - self._begun, "changes": [*self._taken(), *silent]}
            self._outlet.put("end", end)
            self.running = False

    def active(self) -> None:
        """Note that the node is active; with `idle`, this starts a mission."""
        self._active = monotonic()
        if self._idle is not None and not self.running:
            self.begin()

    def order(self, word: str) -> None:
        """Handle a message on the mission topic: begin, succeeded or failed."""
        if word == "begin":
            self.begin()
        elif word in OUTCOMES:
            self.end(passed=OUTCOMES[word], failure="" if OUTCOMES[word] else "reported on the mission topic")

    def close(self) -> None:
        """Write the remaining records."""
        self._over.release()
        self._thread.join()
        with self._lock:
            self._flush()
            self._outlet.close()
            self.problem = "; ".join(filter(None, (self.problem, self._outlet.problem)))

    def _cell(self) -> Cell | None:
        known = [one for one in self._bins if one is not None]
        return tuple(known) if len(known) == len(self._bins) else None

    def _look(self) -> None:
        """Send recorded data, end idle missions, and check the writer."""
        reported = False
        while not self._over.acquire(timeout=PERIOD):
            with self._lock:
                if self._idle is not None and self.running and monotonic() - self._active > self._idle:
                    self.end(passed=True)
                if self._outlet.full:
                    self.stream.relieve()
                else:
                    self._flush()
                self._outlet.pump()
            if self._outlet.problem and not reported:
                reported = True
                print(f"observe: {self._outlet.problem}", file=sys.stderr, flush=True)

    def _flush(self) -> None:
        cut = self.stream.cut(self._outlet.full)
        steps = len(cut.rewards)  # steps to remove; outside missions, they are dropped
        values = steps * len(self.sensors)
        readings, self._readings = self._readings[:values], self._readings[values:]
        times, self._times = self._times[:steps], self._times[steps:]
        if self.running and not cut.empty:
            followed = (times, self._taken()) if self._following else None
            self._outlet.put("steps", tuple(cut), [*map(_plain, readings)], self.stream.dropped, followed)
        elif cut.cells:
            self._outlet.put("cells", cut.cells)

    def _taken(self) -> list[list[Any]]:
        """Return the signal changes that have not been written yet."""
        taken = []
        while self._changes:
            taken.append(self._changes.popleft())
        return taken


def _plain(value: Any) -> Any:
    if type(value) in _PLAIN:
        return value
    if isinstance(value, str):
        return str(value)
    try:
        return int(value) if isinstance(value, int) else float(value)
    except (TypeError, ValueError, OverflowError):
        return None  # not a number: `told` reports it, and the cell stays unknown
