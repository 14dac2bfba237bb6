"""The steps of missions as columns: their cells are rows of the recording, whichever log they come from."""

from __future__ import annotations

from binascii import b2a_base64
from pathlib import Path
from typing import Any

import numpy as np

from pytest_tarl.monitoring.assembling import Assembly, Expected
from pytest_tarl.monitoring.mission import Mission, Progress, Steps, columns

KNOWN = {(0, 0): 0, (1, 0): 1, (5, 1): 2}
UNKNOWN = len(KNOWN)  # the row of all cells that the recording lacks


def assembly(name: str = "a.log") -> Assembly:
    return Assembly(
        Expected("t", ("x", "wet"), "digest", KNOWN), Path(name), Progress(name, name, 0, 0, ""), 0
    )


def steps(of: Assembly, cells: list[list[int]], places: list[int], rewards: list[float]) -> Steps:
    cell, reward = np.array(places, "<i4").tobytes(), np.array(rewards, "<f8").tobytes()
    return of._steps(cells, b2a_base64(cell), b2a_base64(reward))


def mission(of: Assembly, *some: Steps) -> Mission:
    return of._ended(True, 1.0, [*some], (0, 1, 2))


def as_lists(*missions: Mission) -> Any:
    return tuple(column.tolist() for column in columns(missions))


def test_places_in_a_record_become_rows_of_the_recording() -> None:
    log = assembly()
    one = mission(log, steps(log, [[5, 1], [9, 9], [0, 0]], [0, 1, 2, 2, -1], [0.5, 1.5, 2.5, 3.5, 4.5]))
    assert as_lists(one) == ([0] * 5, [2, UNKNOWN, 0, 0, -1], [0.5, 1.5, 2.5, 3.5, 4.5])
    assert one.new == ((9, 9),)
    assert as_lists() == ([], [], [])


def test_steps_of_a_mission_without_new_cells_name_none() -> None:
    log = assembly()
    both = [[5, 1], [9, 9]]
    assert mission(log, steps(log, both, [0, 0, -1], [0.0] * 3)).new == ()
    assert mission(log, steps(log, [[5, 1]], [0], [0.0]), steps(log, both, [1], [0.0])).new == ((9, 9),)


def test_missions_of_different_logs_are_joined() -> None:
    first, second = assembly("a.log"), assembly("b.log")
    cells = [[0, 0], [5, 1]]
    missions = [
        mission(first, steps(first, cells, [0, 1], [1.0, 2.0])),
        mission(second, steps(second, [*map(list, cells)], [1], [3.0])),
        mission(first, steps(first, cells, [], [])),
        mission(first, steps(first, [[5, 1], [1, 0]], [1, 0], [4.0, 5.0]), steps(first, cells, [1], [6.0])),
    ]
    assert as_lists(*missions) == (
        [0, 0, 1, 3, 3, 3],
        [0, 2, 2, 1, 2, 2],
        [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
    )
