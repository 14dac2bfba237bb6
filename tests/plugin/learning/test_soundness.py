"""Each check of a recording's columns detects its own kind of invalid value."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.learning.archive import DamagedError
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.soundness import check
from tests.plugin.learning.test_fixture import example

FIXTURE: Fixture = example()
SAMPLE = FIXTURE.sample
TABLES = [np.zeros((len(SAMPLE.cells), one.width)) for one in SAMPLE.lists]
CELLS, STATES = len(SAMPLE.cells), 1 + len(SAMPLE.cells) * SAMPLE.lists[0].width

LIMITS = [
    ("chain", "episode", 0, SAMPLE.episodes),
    ("chain", "cell", 0, CELLS),
    ("chain", "next_cell", -1, CELLS),
    ("edges", "episode", 0, SAMPLE.episodes),
    ("edges", "state", 0, STATES),
    ("edges", "next_state", -1, STATES),
]


def changed(part: str, name: str, change: Callable[[np.ndarray[Any, Any]], np.ndarray[Any, Any]]) -> Any:
    """Return the sample with one column changed."""
    if part == "chain":
        chain = replace(SAMPLE.chain, **{name: change(getattr(SAMPLE.chain, name).copy())})
        return replace(SAMPLE, chain=chain)
    one = SAMPLE.lists[0]
    inner = getattr(one, part)
    listed = replace(
        one,
        **{
            part: inner._replace(**{name: change(getattr(inner, name).copy())})
            if hasattr(inner, "_replace")
            else replace(inner, **{name: change(getattr(inner, name).copy())})
        },
    )
    return replace(SAMPLE, lists=(listed, *SAMPLE.lists[1:]))


def put(value: float) -> Callable[[np.ndarray[Any, Any]], np.ndarray[Any, Any]]:
    def change(column: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        column[column.size // 2] = value
        return column

    return change


def sound(sample: Any) -> bool:
    try:
        check(sample, len(FIXTURE.sensors), TABLES)
    except DamagedError:
        return False
    return True


def test_the_unchanged_sample_is_valid() -> None:
    assert sound(SAMPLE)
    assert SAMPLE.chain.cell.size > 2
    assert SAMPLE.lists[0].edges.state.size > 2


@pytest.mark.parametrize(("part", "name", "low", "end"), LIMITS)
def test_an_index_beyond_the_last_entry_is_refused(part: str, name: str, low: int, end: int) -> None:
    assert not sound(changed(part, name, put(low - 1)))
    assert not sound(changed(part, name, put(end)))
    assert sound(changed(part, name, put(low)))
    assert sound(changed(part, name, put(end - 1)))


@pytest.mark.parametrize("part", ["chain", "edges"])
def test_counts_below_one_are_refused(part: str) -> None:
    assert not sound(changed(part, "count", put(0)))
    assert sound(changed(part, "count", put(1)))


@pytest.mark.parametrize(("part", "name"), [("chain", "reward"), ("visits", "reward"), ("visits", "scaled")])
@pytest.mark.parametrize("value", [np.inf, np.nan])
def test_infinite_sums_are_refused(part: str, name: str, value: float) -> None:
    assert not sound(changed(part, name, put(value)))


@pytest.mark.parametrize(
    ("part", "name"),
    [
        ("chain", "next_cell"),
        ("chain", "count"),
        ("chain", "reward"),
        ("visits", "scaled"),
        ("visits", "reward_squared"),
    ],
)
def test_columns_of_unequal_length_are_refused(part: str, name: str) -> None:
    assert not sound(changed(part, name, lambda column: column[:-1]))


@pytest.mark.parametrize(
    "wrong",
    [
        {"seeds": (SAMPLE.seeds[0],) * SAMPLE.episodes},
        {"cells": SAMPLE.cells[::-1]},
        {"cells": (SAMPLE.cells[1], SAMPLE.cells[0], *SAMPLE.cells[2:])},
        {"cells": (SAMPLE.cells[0], SAMPLE.cells[0], *SAMPLE.cells[2:])},
        {"cells": tuple((*cell, 0) for cell in SAMPLE.cells)},
        {"total": SAMPLE.total * np.inf},
        {"steps": SAMPLE.steps - 10**6},
        {"passed": SAMPLE.passed.astype(int)},
        {"part_names": (*SAMPLE.part_names, "more")},
    ],
    ids=lambda wrong: next(iter(wrong)),
)
def test_unexpected_number_of_episodes_or_cells_is_refused(
    wrong: dict[str, Any],
) -> None:
    assert not sound(replace(SAMPLE, **wrong))


def test_tables_need_a_row_per_cell() -> None:
    with pytest.raises(DamagedError):
        check(SAMPLE, len(FIXTURE.sensors), [TABLES[0][:-1], *TABLES[1:]])
