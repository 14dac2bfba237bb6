"""Tables of recorded episodes: one row per (episode, transition) or (episode, state).

A cell is a combination of sensor bins; a site is a statement of a taint list. In a taint list with `width` sites, state
0 is the start of an episode, and state 1 + cell·width + n is site n in a cell. `END` is the state after an episode's
last event.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.sensors import Cell

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

START = 0
END = -1


@dataclass(frozen=True)
class Chain:
    """Transitions between sensor cells, one per simulation step.

    Columns have shape (rows,), except `parts`: (rows, parts).
    """

    episode: Ints
    cell: Ints
    next_cell: Ints
    count: Ints
    reward: Floats
    parts: Floats


@dataclass(frozen=True)
class Edges:
    """Transitions between states of one taint list; columns have shape (rows,)."""

    episode: Ints
    state: Ints
    next_state: Ints
    count: Ints


@dataclass(frozen=True)
class Visits:
    """The sums of r, of r·|f|, and of their squares for each state of a taint list; columns have shape (rows,)."""

    episode: Ints
    state: Ints
    count: Ints
    reward: Floats
    scaled: Floats
    reward_squared: Floats
    scaled_squared: Floats


@dataclass(frozen=True)
class ListSample:
    """The statistics of a taint list with `width` sites; `flow` is the sum of |f|, shape (episodes, sites)."""

    width: int
    edges: Edges
    visits: Visits
    flow: Floats

    @property
    def mean_flow(self) -> float:
        """Return F, the mean |f| per event, or 1 if it is zero."""
        events = self.visits.count[self.visits.state != START].sum()
        mean = float(self.flow.sum()) / events if events else 0.0
        return mean or 1.0


@dataclass(frozen=True)
class Judgements:
    """The results of formulas; columns have shape (episodes, formulas).

    Robustness is NaN if a formula was not judged. `lost` is the time of the violation in s; NaN if there is none.
    """

    formulas: tuple[str, ...]  # texts of the formulas, sorted
    robustness: Floats
    lost: Floats


@dataclass(frozen=True)
class Sample:
    """Episodes in the order of their seeds, with sorted cells; `total`, `passed`, `steps` have shape (episodes,)."""

    cells: tuple[Cell, ...]
    seeds: tuple[int, ...]
    passed: NDArray[np.bool_]
    total: Floats
    steps: Ints
    part_names: tuple[str, ...]
    chain: Chain
    lists: tuple[ListSample, ...]
    judgements: Judgements | None = None  # None if the test has no formulas

    @property
    def episodes(self) -> int:
        """Return the number of episodes."""
        return len(self.seeds)


def sum_by(index: Ints, weights: Floats | Ints, size: int) -> Floats:
    """Return the sum of the weights at each index, shape (size,)."""
    return np.bincount(index, weights=weights, minlength=size).astype(np.float64, copy=False)
