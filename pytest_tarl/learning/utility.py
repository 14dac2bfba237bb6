"""From statistics to utility: what it is worth, in the long run, to be at a site in a cell.

The learning signal is ρ = r·[last event of its step] + r·|f|/F (the reward-scaled flow value of Lyons &
Zahra 2020); F is the mean |f| of the off-line recording. `batch` gives the fixed point that SARSA converges
to, q = (I - γP)⁻¹ρ̄, straight from the counts.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.statistics import END, START, Chain, EventSequence, ListSample, sum_by

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

GAMMA_EVENT = 0.95
GAMMA_STEP = 0.97
ALPHA = 0.1


def fixed_point(state: Ints, next_state: Ints, count: Ints, reward: Floats, gamma: float) -> Floats:
    """Solve q = ρ̄ + γPq from transition counts, shape (states,); NaN where a state was never left.

    `reward` is the summed reward per state, shape (states,). Transitions to `END` end the episode.
    """
    states = reward.size
    visits = sum_by(state, count, states)
    seen = np.flatnonzero(visits)
    place = np.full(states + 1, -1, dtype=np.int64)
    place[seen] = np.arange(seen.size)
    inside = place[next_state] >= 0  # END indexes the last entry, which stays -1
    moves = np.zeros((seen.size, seen.size))
    np.add.at(moves, (place[state[inside]], place[next_state[inside]]), count[inside])
    mean = visits[seen]
    solved = np.linalg.solve(np.eye(seen.size) - gamma * moves / mean[:, None], reward[seen] / mean)
    utility = np.full(states, np.nan)
    utility[seen] = solved
    return utility


def batch(recorded: ListSample, cells: int, scale: float, gamma: float = GAMMA_EVENT) -> Floats:
    """Return q(x, n), shape (cells, sites); NaN where never visited. `scale` is F; infinite: no flow term."""
    edges, visits = recorded.edges, recorded.visits
    states = 1 + cells * recorded.width
    signal = visits.reward + visits.scaled / scale
    reward = sum_by(visits.state, signal, states)
    return _by_cell(fixed_point(edges.state, edges.next_state, edges.count, reward, gamma), cells)


def sarsa(
    sequences: Iterable[EventSequence],
    cells: int,
    sites: int,
    scale: float,
    gamma: float = GAMMA_EVENT,
    alpha: float = ALPHA,
) -> Floats:
    """Learn q(x, n) event by event as in the paper, q(c) ← q(c) + α[ρ + γq(c') - q(c)]; shape (cells, sites)."""
    q = [0.0] * (1 + cells * sites)
    seen = set[int]()
    for sequence in sequences:
        states = sequence.state.tolist()
        signal = (sequence.reward + sequence.scaled / scale).tolist()
        seen.update(states)
        for now, then, rho in zip(states, [*states[1:], END], signal, strict=True):
            following = q[then] if then != END else 0.0
            q[now] += alpha * (rho + gamma * following - q[now])
    table = np.array(q)
    table[[s for s in range(table.size) if s not in seen]] = np.nan
    return _by_cell(table, cells)


def chain_utility(chain: Chain, cells: int, gamma: float = GAMMA_STEP) -> Floats:
    """Return U(x) on the chain of sensor cells, shape (cells,); NaN where never visited."""
    reward = sum_by(chain.cell, chain.reward, cells)
    return fixed_point(chain.cell, chain.next_cell, chain.count, reward, gamma)


def _by_cell(states: Floats, cells: int) -> Floats:
    return states[START + 1 :].reshape(cells, -1) if cells else states[1:].reshape(0, 0)
