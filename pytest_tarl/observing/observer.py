"""What is watched: sensors latched when their message comes, rewards, missions; a thread that writes it down."""

from __future__ import annotations

import base64
import threading
from collections.abc import Mapping, Sequence
from time import monotonic, time
from typing import Any

import numpy as np

from pytest_tarl.errors import TarlError
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
        self, sensors: Sequence[Sensor], log: LogFile, about: Mapping[str, Any], *, idle: float | None = None
    ) -> None:
        self.stream = Stream()
        self.sensors = tuple(sensors)
        self._log = log
        self._idle = idle
        self._bins: dict[str, int | None] = {}
        self._values: dict[str, Any] = {}
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

    def _latch(self, sensor: Sensor, value: Any) -> None:
        self._values[sensor.name] = value
        bin_ = sensor.bin(value)
        if self._bins.get(sensor.name, self) == bin_:
            return
        self._bins[sensor.name] = bin_
        self.stream.latch(self._cell())

    def step(self, reward: float) -> None:
        """Close a step with its reward; NaN where the test's own `judge` is to say it later."""
        with self._lock:
            self._readings.append([_plain(self._values.get(sensor.name)) for sensor in self.sensors])
            self.stream.reward(reward)

    def begin(self) -> None:
        """Begin a mission; one that still runs has ended, well as far as anybody knows."""
        with self._lock:
            self.end(passed=True)
            self._flush()
            self._readings.clear()
            self.running = True
            self._log.append({"kind": "mission", "time": time()})

    def end(self, *, passed: bool, failure: str = "") -> None:
        """End the mission, if there is one."""
        with self._lock:
            if not self.running:
                return
            self._flush()
            self._log.append({"kind": "end", "passed": passed, "failure": failure, "time": time()})
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
            self._log.append(_steps(chunk, readings, self.stream.dropped))


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
