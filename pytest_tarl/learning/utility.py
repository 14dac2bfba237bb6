"""Compute the utility from the statistics: the expected reward from a site in a cell onwards.

The learning signal is ρ = r·[last event of its step] + r·|f|/F, with the reward-scaled flow value of Lyons & Zahra
2020; F is the recording's mean |f|. `batch` computes the fixed point of SARSA, q = (I - γP)⁻¹ρ̄, directly from the
counts.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pytest_tarl.learning.tables import START, Chain, Floats, Ints, ListSample, sum_by

GAMMA_EVENT = 0.95
GAMMA_STEP = 0.97
DENSE = 150  # maximum number of states for a direct solution
PRECISE = 1e-12  # sweeps end when no utility changes by more than this share of the largest
STEPS = 300  # maximum number of biconjugate gradient steps, before sweeps improve the solution


def fixed_point(state: Ints, next_state: Ints, count: Ints, reward: Floats, gamma: float) -> Floats:
    """Solve q = ρ̄ + γPq from transition counts, shape (states,); NaN for states that were never left.

    `reward` is the sum of rewards by state, shape (states,). Transitions to `END` end the episode.
    """
    states = reward.size
    visits = sum_by(state, count, states)
    seen = np.flatnonzero(visits)
    place = np.full(states + 1, -1, dtype=np.int64)
    place[seen] = np.arange(seen.size)
    inside = place[next_state] >= 0  # END is -1 and so selects the last entry, which stays -1
    start, end, mean = place[state[inside]], place[next_state[inside]], visits[seen]
    weight = gamma * count[inside] / mean[start]
    solve = _solved if gamma >= 1.0 or seen.size <= DENSE else _approached
    utility = np.full(states, np.nan)
    utility[seen] = solve(*_united(start, end, weight), reward[seen] / mean)
    return utility


def _united(start: Ints, end: Ints, weight: Floats) -> tuple[Ints, Ints, Floats]:
    """Add the weights of equal transitions over all episodes."""
    span = int(end.max(initial=0)) + 1
    codes, place = np.unique(start * span + end, return_inverse=True)
    return codes // span, codes % span, sum_by(place, weight, codes.size)


def _solved(start: Ints, end: Ints, weight: Floats, mean: Floats) -> Floats:
    """Solve q = ρ̄ + Wq directly; W has the weights of the transitions."""
    system = np.eye(mean.size)
    np.subtract.at(system, (start, end), weight)
    return np.linalg.solve(system, mean).astype(np.float64, copy=False)


def _approached(start: Ints, end: Ints, weight: Floats, mean: Floats) -> Floats:
    """Solve q = ρ̄ + Wq by biconjugate gradients (van der Vorst 1992), then by sweeps q ← ρ̄ + Wq.

    This needs memory only for the transitions, not for all pairs of states. Each sweep reduces the error by the factor
    γ. If the gradients converged, one or two sweeps are enough; if they broke down, more are needed.
    """

    def ahead(values: Floats) -> Floats:
        return sum_by(start, weight * values[end], mean.size)

    utility = gradients(lambda values: values - ahead(values), mean)
    change = np.inf
    while change > PRECISE * np.abs(utility).max():
        swept: Floats = mean + ahead(utility)
        change, utility = float(np.abs(swept - utility).max()), swept
    return utility


def gradients(system: Callable[[Floats], Floats], right: Floats) -> Floats:
    """Return the best solution of system(x) = right found by biconjugate gradients, shape (states,)."""
    best = solution = right.copy()
    shadow = residual = right - system(solution)
    direction = residual.copy()
    nearest = scale = float(np.linalg.norm(residual))
    along = float(shadow @ residual)
    for _ in range(STEPS):
        moved = system(direction)
        overlap = float(shadow @ moved)
        if nearest <= PRECISE * scale or overlap == 0.0:
            break
        reach = along / overlap
        half = residual - reach * moved
        turned = system(half)
        size = float(turned @ turned)
        damping = float(turned @ half) / size if size else 0.0
        solution = solution + reach * direction + damping * half
        residual = half - damping * turned
        length = float(np.linalg.norm(residual))
        if length < nearest:
            nearest, best = length, solution
        before, along = along, float(shadow @ residual)
        if not np.isfinite(along) or damping == 0.0 or before == 0.0:
            break
        direction = residual + (along / before) * (reach / damping) * (direction - damping * moved)
    return best


def batch(recorded: ListSample, cells: int, scale: float, gamma: float = GAMMA_EVENT) -> Floats:
    """Return q(x, n), shape (cells, sites), NaN where unvisited.

    `scale` is F; infinity omits the flow term.
    """
    edges, visits = recorded.edges, recorded.visits
    states = 1 + cells * recorded.width
    signal = visits.reward + visits.scaled / scale
    reward = sum_by(visits.state, signal, states)
    solved = fixed_point(edges.state, edges.next_state, edges.count, reward, gamma)
    return solved[START + 1 :].reshape(cells, recorded.width)


def chain_utility(chain: Chain, cells: int, gamma: float = GAMMA_STEP) -> Floats:
    """Return U(x) on the chain of sensor cells, shape (cells,); NaN if a cell was never visited."""
    reward = sum_by(chain.cell, chain.reward, cells)
    return fixed_point(chain.cell, chain.next_cell, chain.count, reward, gamma)
