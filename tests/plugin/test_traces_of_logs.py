"""The trace of a mission in a log, joined from its chunks by hand."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import pytest

from pytest_tarl.errors import LogError
from pytest_tarl.logged import Mission, trace

KINDS = {
    "site": "<i4",
    "flow": "<f8",
    "cell": "<i4",
    "step": "<i4",
    "thread": "<i4",
    "step_cell": "<i4",
    "reward": "<f8",
}
NUMBER = {"a": 0, "b": 1}


def chunk(cells: list[list[int]], **columns: list[float]) -> dict[str, Any]:
    names = {name: columns.get(name, [0] * len(columns["site"])) for name in KINDS} | columns
    packed = {
        name: base64.b64encode(np.array(values, KINDS[name]).tobytes()).decode()
        for name, values in names.items()
    }
    return {"cells": cells, **packed}


def joined(*chunks: dict[str, Any], by_formulas: list[float] | None = None) -> Any:
    fixture: Any = None
    return trace(Mission(["b", "gone", "a"], chunks=[*chunks]), NUMBER, fixture, None, by_formulas)


FIRST = chunk(
    [[0]],
    site=[0, 2, 1, 0], flow=[1.0, 2.0, 3.0, 4.0], cell=[0, 0, 0, 0], step=[1, 0, 0, 2],
    step_cell=[0, 0], reward=[0.5, 1.5],
)  # fmt: skip
SECOND = chunk(
    [[0], [7]], site=[2, 0], flow=[5.0, 6.0], cell=[1, 1], step=[1, 0], step_cell=[1, 0], reward=[2.5, 3.5]
)


def test_chunks_are_joined_in_the_order_of_their_steps() -> None:
    found = joined(FIRST, SECOND)
    assert found.cells == ((0,), (7,))
    assert found.reward.tolist() == [0.5, 1.5, 2.5, 3.5]
    assert found.step_cell.tolist() == [0, 0, 1, 0]
    # sites of the node are numbered anew, and those that it no longer contains are left out
    assert found.flow.tolist() == [2.0, 1.0, 4.0, 6.0, 5.0]
    assert found.site.tolist() == [0, 1, 1, 1, 0]
    assert found.event_step.tolist() == [0, 1, 2, 2, 3]
    assert found.event_cell.tolist() == [0, 0, 0, 1, 1]
    assert found.thread is None


def test_events_after_the_last_step_belong_to_it() -> None:
    assert joined(FIRST).event_step.tolist() == [0, 1, 1]
    nothing = chunk([[0]], site=[2], flow=[1.0], step=[0], step_cell=[], reward=[])
    assert joined(nothing).event_step.tolist() == [0]


def test_events_of_one_step_are_ordered_by_thread() -> None:
    one = chunk(
        [[0]],
        site=[0, 2, 0],
        flow=[1.0, 2.0, 3.0],
        step=[0, 0, 0],
        thread=[1, 0, 1],
        step_cell=[0],
        reward=[1],
    )
    found = joined(one)
    assert (found.flow.tolist(), found.thread.tolist()) == ([2.0, 1.0, 3.0], [0, 1, 1])


def test_formula_rewards_replace_logged_rewards() -> None:
    assert joined(FIRST, by_formulas=[7.0, 8.0]).reward.tolist() == [7.0, 8.0]
    assert joined(FIRST, by_formulas=[7.0]).reward.tolist() == [0.5, 1.5]
    unknown = chunk([[0]], site=[0], flow=[1.0], step=[0], step_cell=[0, 0], reward=[np.nan, 1.0])
    assert joined(unknown, by_formulas=[7.0, 8.0]).reward.tolist() == [7.0, 8.0]
    with pytest.raises(LogError):
        joined(unknown)
