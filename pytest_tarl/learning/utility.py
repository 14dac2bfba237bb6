"""From statistics to utility: what it is worth, in the long run, to be at a site in a cell.

The learning signal is ρ = r·[last event of its step] + r·|f|/F (the reward-scaled flow value of Lyons &
Zahra 2020); F is the mean |f| of the off-line recording. `batch` gives the fixed point that SARSA converges
to, q = (I - γP)⁻¹ρ̄, straight from the counts.
"""

from __future__ import annotations

import numpy as np

from pytest_tarl.learning.tables import START, Chain, Floats, Ints, ListSample, sum_by

GAMMA_EVENT = 0.95
GAMMA_STEP = 0.97
DENSE = 1500  # states up to which the equations are solved at once
PRECISE = 1e-12  # of the largest utility: the change in one sweep at which solving by sweeps ends


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
    start, end, mean = place[state[inside]], place[next_state[inside]], visits[seen]
    weight = gamma * count[inside] / mean[start]
    solve = _solved if gamma >= 1.0 or seen.size <= DENSE else _swept
    utility = np.full(states, np.nan)
    utility[seen] = solve(start, end, weight, reward[seen] / mean)
    return utility


def _solved(start: Ints, end: Ints, weight: Floats, mean: Floats) -> Floats:
    """Solve q = ρ̄ + Wq at once, W being the sum of the weights of the transitions."""
    system = np.eye(mean.size)
    np.subtract.at(system, (start, end), weight)
    return np.linalg.solve(system, mean).astype(np.float64, copy=False)


def _swept(start: Ints, end: Ints, weight: Floats, mean: Floats) -> Floats:
    """Solve the same by sweeps, which contract by γ each: memory for the transitions only, not for all pairs."""
    utility: Floats = mean.copy()
    change = np.inf
    while change > PRECISE * np.abs(utility).max():
        swept: Floats = mean + sum_by(start, weight * utility[end], mean.size)
        change, utility = float(np.abs(swept - utility).max()), swept
    return utility


def batch(recorded: ListSample, cells: int, scale: float, gamma: float = GAMMA_EVENT) -> Floats:
    """Return q(x, n), shape (cells, sites); NaN where never visited. `scale` is F; infinite: no flow term."""
    edges, visits = recorded.edges, recorded.visits
    states = 1 + cells * recorded.width
    signal = visits.reward + visits.scaled / scale
    reward = sum_by(visits.state, signal, states)
    solved = fixed_point(edges.state, edges.next_state, edges.count, reward, gamma)
    return solved[START + 1 :].reshape(cells, recorded.width)


def chain_utility(chain: Chain, cells: int, gamma: float = GAMMA_STEP) -> Floats:
    """Return U(x) on the chain of sensor cells, shape (cells,); NaN where never visited."""
    reward = sum_by(chain.cell, chain.reward, cells)
    return fixed_point(chain.cell, chain.next_cell, chain.count, reward, gamma)
