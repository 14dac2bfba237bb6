"""Check that the columns of a recording are consistent, once, when it is read."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.archive import DamagedError
from pytest_tarl.learning.tables import END, START, Chain, Floats, ListSample, Sample


def check(sample: Sample, sensors: int, tables: Sequence[Floats]) -> None:
    """Raise DamagedError if columns refer to missing episodes, cells or states, or have invalid values.

    `sensors` is the number of sensors in a cell. `tables` has one learned table per taint list, shape (cells, sites).
    """
    if not sample.episodes or len(set(sample.seeds)) < sample.episodes:
        raise DamagedError("it does not have one seed per episode")
    whole = all(type(bin_) is int for cell in sample.cells for bin_ in cell)
    if not whole or any(len(cell) != sensors for cell in sample.cells) or not _rising(sample.cells):
        raise DamagedError("its cells do not match its sensors")
    _same_length("episodes", sample.episodes, sample.passed, sample.total, sample.steps)
    kinds = (sample.passed.dtype, sample.total.dtype)
    if (
        kinds != (np.dtype(bool), np.dtype(np.float64))
        or not np.isfinite(sample.total).all()
        or (sample.steps < 0).any()
    ):
        raise DamagedError("its episodes have no result, no total or no steps")
    _check_judgements(sample)
    _check_chain(sample.chain, sample)
    for one, table in zip(sample.lists, tables, strict=True):
        _check_list(one, sample)
        if table.shape != (len(sample.cells), one.width):
            raise DamagedError("a learned table does not match its cells and sites")


def _check_judgements(sample: Sample) -> None:
    judged = sample.judgements
    if judged is None:
        return
    shape = sample.episodes, len(judged.formulas)
    for column in (judged.robustness, judged.lost):
        if column.shape != shape or column.dtype != np.float64 or np.isinf(column).any():
            raise DamagedError("the results of its formulas do not match its episodes")
    if len(set(judged.formulas)) < len(judged.formulas):
        raise DamagedError("it names a formula twice")


def _check_chain(chain: Chain, sample: Sample) -> None:
    size = chain.episode.size
    _same_length("transitions", size, chain.cell, chain.next_cell, chain.count, chain.reward, chain.parts)
    _within("transitions", chain.episode, 0, sample.episodes)
    _within("transitions", chain.cell, 0, len(sample.cells))
    _within("transitions", chain.next_cell, END, len(sample.cells))
    _counted(chain.count)
    if chain.parts.shape[1] != len(sample.part_names):
        raise DamagedError("its rewards have other parts than its header names")
    if not (np.isfinite(chain.reward).all() and np.isfinite(chain.parts).all()):
        raise DamagedError("its rewards are not finite")


def _check_list(one: ListSample, sample: Sample) -> None:
    states = 1 + len(sample.cells) * one.width
    edges, visits = one.edges, one.visits
    _within("edges", edges.episode, 0, sample.episodes)
    _within("edges", edges.state, START, states)
    _within("edges", edges.next_state, END, states)
    _counted(edges.count)
    sums = (visits.reward, visits.scaled, visits.reward_squared, visits.scaled_squared)
    _same_length("visits", visits.count.size, *sums)
    if one.flow.shape != (sample.episodes, one.width) or not np.isfinite(one.flow).all():
        raise DamagedError("its flows do not match its episodes and sites")
    if not all(np.isfinite(column).all() for column in sums[:2]):
        raise DamagedError("its sums are not finite")


def _within(what: str, column: NDArray[Any], low: int, high: int) -> None:
    if column.size and not low <= column.min() <= column.max() < high:
        raise DamagedError(f"its {what} refer to missing entries")


def _counted(column: NDArray[Any]) -> None:
    if column.size and column.min() < 1:
        raise DamagedError("it has counts below 1")


def _same_length(what: str, size: int, *columns: NDArray[Any]) -> None:
    if any(len(column) != size for column in columns):
        raise DamagedError(f"its columns of {what} differ in length")


def _rising(cells: Sequence[tuple[int, ...]]) -> bool:
    return all(first < second for first, second in pairwise(cells))
