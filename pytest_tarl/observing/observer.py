"""What is watched: sensors latched when their message comes, rewards, missions; a thread that writes it down."""

from __future__ import annotations

import base64
import threading
from collections import deque
from collections.abc import Mapping, Sequence
from time import monotonic, time
from typing import Any

import numpy as np

from pytest_tarl.errors import TarlError
from pytest_tarl.formulas.signals import Signal, signal_value
from pytest_tarl.instrumentation.trace import Floats, Ints
from pytest_tarl.observing.frames import FORMAT, LogFile, Record
from pytest_tarl.observing.stream import Chunk, Stream
from pytest_tarl.sensors import Cell, Sensor, reading

PERIOD = (
    0.25  # seconds between two writings: what a power cut can cost at most is this and the writing itself
)
OUTCOMES = {"succeeded": True, "failed": False}


class Observer:
    """One node under observation. Messages may come from any thread."""

    def __init__(
        self,
        sensors: Sequence[Sensor],
        log: LogFile,
        about: Mapping[str, Any],
        *,
        idle: float | None = None,
        signals: Sequence[Signal] = (),
        following: bool = False,
    ) -> None:
        self.stream = Stream()
        self.sensors = tuple(sensors)
        self.signals = tuple(signals)  # that formulas name, and that messages hold
        self._following = following  # whether there are formulas, for which every change is written down
        self._changes: deque[list[Any]] = deque()  # [seconds, name, value]; any thread appends
        self._times: list[float] = []  # when steps were closed
        self._begun = monotonic()
        self._log = log
        self._idle = idle
        self._bins: dict[str, int | None] = {}
        self._values: dict[str, Any] = {}
        self._numbers: dict[str, float] = {}  # what signals are, as heard in this mission
        self._before: dict[str, float] = {}  # and what they were before it, for those that stay silent
        self._readings: list[list[Any]] = []
        self._active = monotonic()
        self.running = False  # whether a mission runs
        self.problem = ""  # the first thing that went wrong in here: nothing of it may reach the node
        self._lock = threading.RLock()  # order of records
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._write, name="tarl-observer", daemon=True)
        self._log.append({"kind": "start", "format": FORMAT, "time": time(), **about})
        self._log.sync()
        self._thread.start()

    def told(self, sensor: Sensor, message: Any) -> None:
        """Latch a sensor: its message is about to reach the node."""
        try:
            self._latch(sensor, reading(message, sensor.field or ""))
        except (TarlError, AttributeError, LookupError, TypeError, ValueError) as problem:
            self.problem = self.problem or f"Sensor {sensor.name!r}: {problem}"
        self.stream.relieve()

    def signalled(self, signal: Signal, message: Any) -> None:
        """Note the value of a signal."""
        try:
            self._note(signal.name, reading(message, signal.field or ""))
        except (TarlError, AttributeError, LookupError, TypeError, ValueError) as problem:
            self.problem = self.problem or f"Signal {signal.name!r}: {problem}"

    def _note(self, name: str, value: Any) -> None:
        if not self._following:
            return
        number = signal_value(name, value)
        if self._numbers.get(name) != number:
            self._numbers[name] = number
            if self.running:
                self._changes.append([monotonic() - self._begun, name, number])

    def _latch(self, sensor: Sensor, value: Any) -> None:
        self._values[sensor.name] = value
        if not sensor.categories:
            self._note(sensor.name, value)
        bin_ = sensor.bin(value)
        if self._bins.get(sensor.name, self) == bin_:
            return
        self._bins[sensor.name] = bin_
        self.stream.latch(self._cell())

    def step(self, reward: float) -> None:
        """Close a step with its reward; NaN where the test's own `judge` is to say it later."""
        with self._lock:
            self._times.append(monotonic() - self._begun)
            self._readings.append([_plain(self._values.get(sensor.name)) for sensor in self.sensors])
            self.stream.reward(reward)

    def begin(self) -> None:
        """Begin a mission; one that still runs has ended, well as far as anybody knows."""
        with self._lock:
            self.end(passed=True)
            self._flush()
            self._readings.clear()
            self._times.clear()
            self._changes.clear()
            self._begun = monotonic()
            self._before, self._numbers = self._before | self._numbers, {}
            self.running = True
            self._log.append({"kind": "mission", "time": time()})

    def end(self, *, passed: bool, failure: str = "") -> None:
        """End the mission, if there is one."""
        with self._lock:
            if not self.running:
                return
            self._flush()
            end = {"kind": "end", "passed": passed, "failure": failure, "time": time()}
            if self._following:
                silent = [[0.0, name, one] for name, one in self._before.items() if name not in self._numbers]
                end |= {"lasted": monotonic() - self._begun, "changes": [*self._taken(), *silent]}
            self._log.append(end)
            self.running = False

    def active(self) -> None:
        """Note that the node does something; with `idle`, this begins a mission."""
        self._active = monotonic()
        if self._idle is not None and not self.running:
            self.begin()

    def order(self, word: str) -> None:
        """Follow what the mission topic says: begin, succeeded or failed."""
        if word == "begin":
            self.begin()
        elif word in OUTCOMES:
            self.end(passed=OUTCOMES[word], failure="" if OUTCOMES[word] else "the mission topic said so")

    def close(self) -> None:
        """Write what is left."""
        self._over.set()
        self._thread.join()
        with self._lock:
            self._flush()
            self._log.close()

    def _cell(self) -> Cell | None:
        bins = [self._bins.get(sensor.name) for sensor in self.sensors]
        known = [one for one in bins if one is not None]
        return tuple(known) if len(known) == len(bins) else None

    def _write(self) -> None:
        while not self._over.wait(PERIOD):
            with self._lock:
                if self._idle is not None and self.running and monotonic() - self._active > self._idle:
                    self.end(passed=True)
                self._flush()
            self._log.sync()

    def _flush(self) -> None:
        chunk = self.stream.drain()
        if self.running and not chunk.empty:
            steps = chunk.reward.size
            readings, self._readings = self._readings[:steps], self._readings[steps:]
            times, self._times = self._times[:steps], self._times[steps:]
            followed = {"times": times, "changes": self._taken()} if self._following else {}
            self._log.append(_steps(chunk, readings, self.stream.dropped) | followed)

    def _taken(self) -> list[list[Any]]:
        """Return the changes of signals that are not written yet."""
        taken = []
        while self._changes:
            taken.append(self._changes.popleft())
        return taken


def _steps(chunk: Chunk, readings: list[list[Any]], dropped: int) -> Record:
    return {
        "kind": "steps",
        "cells": [list(cell) for cell in chunk.cells],
        "site": packed(chunk.site),
        "flow": packed(chunk.flow),
        "cell": packed(chunk.cell),
        "step": packed(chunk.step),
        "thread": packed(chunk.thread),
        "step_cell": packed(chunk.step_cell),
        "reward": packed(chunk.reward),
        "readings": readings,
        "dropped": dropped,
    }


def packed(column: Ints | Floats) -> str:
    """Return a column as text: base64 of its little-endian bytes."""
    little = column.astype(column.dtype.newbyteorder("<"))
    return base64.b64encode(little.tobytes()).decode()


def unpacked(text: str, kind: str) -> Any:
    """Return a column from its text; `kind` is numpy's name of its type."""
    return np.frombuffer(base64.b64decode(text), np.dtype(kind).newbyteorder("<")).astype(kind)


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, bool | int | str):
        return value
    return float(value)
