"""Missions in small worlds, as a recording of a test and as a log of a robot."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning.bounds import Range
from pytest_tarl.learning.fixture import Fixture, load, save
from pytest_tarl.learning.guarantees import stated
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.statistics import sample
from pytest_tarl.observing.log_format import LogFile, encoded
from pytest_tarl.observing.writer import packed
from pytest_tarl.seeds import episode_seed
from pytest_tarl.sensors import Cell, Sensor, binning_digest

SENSORS = (
    Sensor("x", topic="/x", field="data", low=0, high=4, bins=4),
    Sensor("wet", topic="/wet", field="data"),
)
TEST = "test_walk.py::test_walk"


@dataclass(frozen=True)
class Walk:
    """The cells and rewards of one mission, by step."""

    cells: tuple[Cell, ...]
    reward: tuple[float, ...]
    passed: bool


def walk(rng: np.random.Generator, drift: float = 0.0) -> Walk:
    """Walk over four places; under the drift, the third one costs more and some missions fail there."""
    cells, reward, wet = [], [], int(rng.random() < 0.5)
    passed = True
    for x in range(4):
        for _ in range(1 + int(rng.random() < 0.5)):
            cells.append((x, wet))
            reward.append(float(rng.normal(1.0, 0.2)) - 0.8 * drift * (x == 2))
        passed &= not (x == 2 and rng.random() < 0.6 * drift)
    return Walk(tuple(cells), tuple(reward), passed)


def walks(count: int, seed: int, drift: float = 0.0) -> list[Walk]:
    """Draw random missions."""
    rng = np.random.default_rng(seed)
    return [walk(rng, drift) for _ in range(count)]


def trace(one: Walk) -> Trace:
    """Return a mission as a test records it."""
    distinct = tuple(dict.fromkeys(one.cells))
    number = {cell: n for n, cell in enumerate(distinct)}
    none = np.empty(0, np.int32)
    steps = np.array([number[cell] for cell in one.cells], np.int32)
    return Trace(distinct, none, np.empty(0), none, none, steps, np.array(one.reward), {})


def fixture(path: Path, missions: list[Walk], declared: Range | None = None, varied: bool = True) -> Fixture:
    """Save missions as a recording, and load it as `tarl watch` does."""
    samples = [sample(trace(one), episode_seed(0, "x", n), one.passed, ()) for n, one in enumerate(missions)]
    whole = merge(samples)
    bounds = stated(whole.passed.tolist(), whole.total.tolist(), declared=declared, varied=varied)
    save(Fixture(TEST, 0, SENSORS, (), {}, whole, (), stated=bounds), path)
    return load(path)


def start(**changes: Any) -> dict[str, Any]:
    """Return the first record of a log."""
    about = {
        "kind": "start",
        "format": 1,
        "time": 1000.0,
        "node": "walker.py",
        "test": TEST,
        "sensors": [sensor.name for sensor in SENSORS],
        "bins": binning_digest(SENSORS),
        "sites": [],
        "judged": False,
    }
    return {**about, **changes}


def records(one: Walk, time: float = 2000.0, pieces: int = 1) -> list[dict[str, Any]]:
    """Return the records of a mission, with its steps in `pieces` records and its fields in the writer's order."""
    distinct = list(dict.fromkeys(one.cells))
    number = {cell: n for n, cell in enumerate(distinct)}
    column = np.array([number[cell] for cell in one.cells], np.int32)
    reward, none = np.array(one.reward), packed(np.empty(0, np.int32))
    steps = [
        {
            "kind": "steps",
            "cells": [list(cell) for cell in distinct],
            "site": none,
            "flow": packed(np.empty(0)),
            **dict.fromkeys(("cell", "step", "thread"), none),
            "step_cell": packed(part),
            "reward": packed(amounts),
            "readings": [],
            "dropped": 0,
        }
        for part, amounts in zip(np.array_split(column, pieces), np.array_split(reward, pieces), strict=True)
    ]
    end = {"kind": "end", "passed": one.passed, "failure": "", "time": time + 1.0}
    return [{"kind": "mission", "time": time}, *steps, end]


def log(path: Path, missions: list[Walk], first: float = 2000.0, apart: float = 1.0, **changes: Any) -> Path:
    """Write a log, or append to one as a restarted observer does; missions begin `apart` seconds after each other."""
    file = LogFile(path)
    file.append(start(**changes))
    for n, one in enumerate(missions):
        for record in records(one, first + n * apart):
            file.append(record)
    file.close()
    return path


def content(missions: list[Walk]) -> bytes:
    """Return the records of some missions as in a log, without its first record."""
    return b"".join(encoded(record) for n, one in enumerate(missions) for record in records(one, 5000.0 + n))
