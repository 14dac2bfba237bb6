"""The parametric utility: tile coding (Sutton & Barto 2018, §9.5.4), solved by least squares.

A sensor with `tilings=T` has T grids of tiles. A tile is T bins wide, and each grid is shifted by one bin. The utility
of a cell is the sum of the weights of the T tiles that contain it, one tile per grid. Neighbouring cells share tiles,
so they learn from each other. Sensors without tilings keep their bins. The weights are fitted to the same counts as the
table (least-squares temporal differences, Bradtke & Barto 1996).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pytest_tarl.learning.tables import END, START, Chain, Floats, Ints, ListSample, sum_by
from pytest_tarl.learning.utility import GAMMA_EVENT, GAMMA_STEP, batch, chain_utility, gradients
from pytest_tarl.sensors import Cell, Sensor

# ridge added to the diagonal, in mean numbers of visits; needed because tilings leave some weights undetermined
RIDGE = 1e-6
DENSE = 1500  # maximum number of weights for a direct solution


@dataclass(frozen=True)
class Tiles:
    """The tiles of every cell; `of`, of shape (cells, tilings), has tile numbers from 0 to `count` - 1."""

    of: Ints
    count: int


def tiled(cells: Sequence[Cell], sensors: Sequence[Sensor]) -> Tiles | None:
    """Return the tiles of the cells, or None if no sensor has tilings."""
    grids = max((sensor.tilings for sensor in sensors), default=0)
    if not grids or not cells:
        return None
    table = np.array(cells, dtype=np.int64)
    numbered = [_grid(table, sensors, grid) for grid in range(grids)]
    firsts = np.cumsum([0, *(int(one.max()) + 1 for one in numbered)])
    return Tiles(
        np.stack([one + first for one, first in zip(numbered, firsts, strict=False)], axis=1), int(firsts[-1])
    )


def _grid(table: Ints, sensors: Sequence[Sensor], grid: int) -> Ints:
    """Return the tile of each cell in one grid, shape (cells,).

    A sensor's shift is the grid's number times an odd number of bins. Each sensor has a different odd number, so that
    tile boundaries do not coincide.
    """
    columns = []
    for d, sensor in enumerate(sensors):
        column = table[:, d]
        if sensor.tilings:
            shifted = column + grid * (2 * d + 1) % sensor.tilings
            column = (shifted % sensor.bins if sensor.angle and sensor.bins else shifted) // sensor.tilings
        columns.append(column)
    return np.unique(np.stack(columns, axis=1), axis=0, return_inverse=True)[1].reshape(-1)


def tiled_chain(chain: Chain, cells: int, tiles: Tiles | None, gamma: float = GAMMA_STEP) -> Floats:
    """Return U(x) on the chain of sensor cells, shape (cells,); NaN if a tile was never visited."""
    if tiles is None:
        return chain_utility(chain, cells, gamma)
    reward = sum_by(chain.cell, chain.reward, cells)
    return _fitted(chain.cell, chain.next_cell, chain.count, reward, tiles.of, gamma)


def tiled_batch(
    recorded: ListSample, cells: int, scale: float, tiles: Tiles | None, gamma: float = GAMMA_EVENT
) -> Floats:
    """Return q(x, n), shape (cells, sites), NaN where unvisited; each site has its own tiles."""
    if tiles is None:
        return batch(recorded, cells, scale, gamma)
    edges, visits, width = recorded.edges, recorded.visits, recorded.width
    states = 1 + cells * width
    reward = sum_by(visits.state, visits.reward + visits.scaled / scale, states)
    site = np.arange(width) * tiles.count
    of = 1 + (tiles.of[:, None, :] + site[None, :, None]).reshape(cells * width, -1)
    of = np.concatenate((np.full((1, of.shape[1]), START), of))
    solved = _fitted(edges.state, edges.next_state, edges.count, reward, of, gamma)
    solved[sum_by(edges.state, edges.count, states) == 0] = np.nan  # only executed code has a utility
    return solved[START + 1 :].reshape(cells, width)


def expected(cell: Ints, count: Ints, brought: Floats, cells: int, tiles: Tiles | None) -> Floats:
    """Return a visit's mean contribution in each cell, shape (cells,); `brought` is a sum over `count` visits."""
    total, visits = sum_by(cell, brought, cells), sum_by(cell, count, cells)
    if tiles is None:
        with np.errstate(invalid="ignore", divide="ignore"):
            return total / visits
    return _fitted(cell, np.full(cell.size, END), count, total, tiles.of, 0.0)


def _fitted(state: Ints, next_state: Ints, count: Ints, reward: Floats, of: Ints, gamma: float) -> Floats:
    """Solve Σφ(c)[φ(c) - γφ(c')]w = Σφ(c)ρ and return φw; NaN if a state has an unvisited tile."""
    size, grids = int(of.max()) + 1, of.shape[1]
    visits = sum_by(state, count, reward.size)
    if not visits.any():
        return np.full(reward.size, np.nan)
    ridge = RIDGE * float(visits[visits > 0].mean())
    inside = next_state != END
    start, end, weight = state[inside], next_state[inside], gamma * count[inside]

    def spread(values: Floats) -> Floats:
        """Add the value of each state, shape (states,), to all its tiles; return shape (weights,)."""
        return sum_by(of.ravel(), np.repeat(values, grids), size)

    def system(weights: Floats) -> Floats:
        value = weights[of].sum(axis=1)
        return spread(visits * value - sum_by(start, weight * value[end], reward.size)) + ridge * weights

    right = spread(reward)
    if size <= DENSE:
        matrix = np.stack([system(unit) for unit in np.eye(size)], axis=1)
        weights = np.linalg.solve(matrix, right)
    else:
        weights = gradients(system, right)
    known = spread(visits)[of].min(axis=1) > 0
    return np.where(known, weights[of].sum(axis=1), np.nan)
