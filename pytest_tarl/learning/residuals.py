"""Compute the Bellman residual of each step, in two parts: the move to the next cell, and the reward.

A residual is the difference between what a step earns and what the designed utility predicts. Its expectation is zero
in every cell where the world has not changed since the fit. Residuals therefore locate the change itself, and not the
cells that a robot visits before it (performance-difference lemma, Kakade & Langford 2002).

A residual smaller than its error is set to 0. With a constant reward, such residuals come only from rounding
(packing.py) and from the order of summation.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass

import numpy as np

from pytest_tarl.learning.packing import ROUNDING
from pytest_tarl.learning.permutation import ARITHMETIC
from pytest_tarl.learning.tables import END, Chain, Floats, Sample, sum_by
from pytest_tarl.learning.tiles import Tiles, expected, tiled_chain
from pytest_tarl.learning.utility import GAMMA_STEP


@dataclass(frozen=True)
class Residuals:
    """Both parts of the Bellman residual, and the visits to novel cells; each of shape (episodes, cells).

    The errors are limits for the rounding error of each residual. The error of a sum is the sum of the errors.
    """

    move: Floats
    reward: Floats
    novel: Floats
    move_error: Floats
    reward_error: Floats


def in_fit(seed: int) -> bool:
    """Return whether a recorded episode is used for the fit; the others are used for the comparison."""
    return zlib.crc32(str(seed).encode()) % 2 == 0


@dataclass(frozen=True)
class Model:
    """The expected move and reward of a designed step by cell, shape (cells,); NaN if unknown."""

    utility: Floats
    move: Floats  # mean of γU(x')-U(x) over all steps but the last of an episode
    reward: Floats
    size: Floats  # mean |Σr| per step, to which the rounding error of `reward` is proportional


def fitted(chain: Chain, cells: int, tiles: Tiles | None = None) -> Model:
    """Fit the model to recorded transitions."""
    utility = tiled_chain(chain, cells, tiles)
    inside = chain.next_cell != END
    gained = _gain(chain, utility) * chain.count
    move = expected(chain.cell[inside], chain.count[inside], gained[inside], cells, tiles)
    reward = expected(chain.cell, chain.count, chain.reward, cells, tiles)
    size = expected(chain.cell, chain.count, np.abs(chain.reward), cells, tiles)
    return Model(utility, move, reward, size)


def residuals(compared: Sample, model: Model) -> Residuals:
    """Return each episode's residuals by cell, minus the designed mean per visit.

    Without a drift, both parts then have the expectation zero, however often a cell is visited. An episode's last step
    has no move. Transitions from or to a cell of unknown utility are skipped.
    """
    chain, shape = compared.chain, (compared.episodes, len(compared.cells))
    known = ~np.isnan(model.utility)
    move = (_gain(chain, model.utility) - model.move[chain.cell]) * chain.count
    move = np.where((chain.next_cell != END) & ~np.isnan(move), move, 0.0)
    reward = chain.reward - model.reward[chain.cell] * chain.count
    rounding = ROUNDING * (np.abs(chain.reward) + np.abs(model.size[chain.cell]) * chain.count)
    height = np.abs(model.utility).max(initial=0.0, where=known)
    move_error = _by_episode(chain, ARITHMETIC * height * chain.count, shape)
    reward_error = _by_episode(chain, np.where(known[chain.cell], rounding, 0.0), shape)
    return Residuals(
        move=beyond(_by_episode(chain, move, shape), move_error),
        reward=beyond(_by_episode(chain, np.where(known[chain.cell], reward, 0.0), shape), reward_error),
        novel=_by_episode(chain, np.where(known[chain.cell], 0.0, chain.count), shape),
        move_error=move_error,
        reward_error=reward_error,
    )


def beyond(values: Floats, error: Floats) -> Floats:
    """Return the values, with 0 for each value that does not exceed its error."""
    return np.where(np.abs(values) > error, values, 0.0)


def _gain(chain: Chain, utility: Floats) -> Floats:
    """Return γU(x')-U(x) for each transition: 0 at the end, NaN if unknown."""
    inside = chain.next_cell != END
    return np.where(
        inside, GAMMA_STEP * utility[np.where(inside, chain.next_cell, 0)] - utility[chain.cell], 0.0
    )


def _by_episode(chain: Chain, weights: Floats, shape: tuple[int, int]) -> Floats:
    """Return the sums of the weights by episode and cell, shape (episodes, cells)."""
    return sum_by(chain.episode * shape[1] + chain.cell, weights, shape[0] * shape[1]).reshape(shape)
