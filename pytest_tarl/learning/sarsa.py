"""Learn the utility event by event: by SARSA as in the paper, expected SARSA, or TD(λ).

An event is one execution of a site. A state c is a pair of cell and site; q(c) is the expected reward from that state
on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pytest_tarl.learning.sequences import EventSequence
from pytest_tarl.learning.tables import END, START, Floats, Ints
from pytest_tarl.learning.utility import GAMMA_EVENT
from pytest_tarl.sensors import Cell

ALPHA = 0.1
LAMBDA = 0.8


class Learner:
    """Learn q(c) of a taint list, episode by episode; subclasses implement the update rule.

    The learning signal is ρ = r·[last event of its step] + r·|f|/F, where f is the flow value and F the mean of |f|. F
    is known only after the last episode. As all rules are linear in ρ, the two terms are learned in separate tables,
    and the second table is divided by F at the end. This avoids storing the episodes.
    """

    def __init__(self, sites: int, gamma: float = GAMMA_EVENT, alpha: float = ALPHA) -> None:
        self.sites = sites
        self.gamma = gamma
        self.alpha = alpha
        self._row: dict[Cell, int] = {}
        self._full = [0.0]  # one number per state, beginning with START
        self._scaled = [0.0]
        self._seen = set[int]()

    def learn(self, sequence: EventSequence, cells: Sequence[Cell]) -> None:
        """Learn from one sequence of events; its states refer to rows of `cells`."""
        states = self._numbered(sequence.state, cells).tolist()
        self._seen.update(states)
        self._follow(states, sequence.reward.tolist(), self._full)
        self._follow(states, sequence.scaled.tolist(), self._scaled)
        self._passed(states)

    def table(self, cells: Sequence[Cell], scale: float) -> Floats:
        """Return q(x, n), shape (cells, sites), with NaN for unvisited entries.

        `scale` is F; infinity omits the flow term.
        """
        q = np.array(self._full) + np.array(self._scaled) / scale
        q[[state for state in range(q.size) if state not in self._seen]] = np.nan
        by_row = q[START + 1 :].reshape(len(self._row), self.sites)
        table = np.full((len(cells), self.sites), np.nan)
        known = [i for i, cell in enumerate(cells) if cell in self._row]
        table[known] = by_row[[self._row[cells[i]] for i in known]]
        return table

    def _follow(self, states: Sequence[int], rewards: Sequence[float], q: list[float]) -> None:
        """Update `q` in place with a sequence of states and their rewards."""
        raise NotImplementedError

    def _passed(self, states: Sequence[int]) -> None:
        """Update internal counts after a sequence."""

    def _numbered(self, state: Ints, cells: Sequence[Cell]) -> Ints:
        """Renumber states by the order in which their cells first occurred."""
        row = np.array([self._row.setdefault(cell, len(self._row)) for cell in cells], dtype=np.int64)
        more = [0.0] * (1 + len(self._row) * self.sites - len(self._full))
        self._full += more
        self._scaled += more
        if not row.size:
            return state
        cell, site = np.divmod(np.maximum(state - 1, 0), max(self.sites, 1))
        return np.where(state > START, 1 + row[cell] * self.sites + site, state)


class Sarsa(Learner):
    """SARSA as in the paper: q(c) ← q(c) + α[ρ + γq(c') - q(c)]."""

    def _follow(self, states: Sequence[int], rewards: Sequence[float], q: list[float]) -> None:
        alpha, gamma = self.alpha, self.gamma
        for now, then, reward in zip(states, [*states[1:], END], rewards, strict=True):
            ahead = q[then] if then != END else 0.0
            q[now] += alpha * (reward + gamma * ahead - q[now])


class ExpectedSarsa(Learner):
    """Expected SARSA: q(c) ← q(c) + α[ρ + γΣP(c'|c)q(c') - q(c)].

    P is estimated by the transition frequencies of all episodes so far. The rule is that of Sutton & Barto 2018, §6.6,
    except that the program and the world choose the next site and cell, instead of a policy.
    """

    def __init__(self, sites: int, gamma: float = GAMMA_EVENT, alpha: float = ALPHA) -> None:
        super().__init__(sites, gamma, alpha)
        self._followers: dict[int, dict[int, int]] = {}  # state → next state → number of transitions

    def _follow(self, states: Sequence[int], rewards: Sequence[float], q: list[float]) -> None:
        chances = {
            now: _shares(_added(self._followers.get(now, {}), counts))
            for now, counts in _transitions(states).items()
        }
        for now, reward in zip(states, rewards, strict=True):
            expected = sum(share * q[then] for then, share in chances[now])
            q[now] += self.alpha * (reward + self.gamma * expected - q[now])

    def _passed(self, states: Sequence[int]) -> None:
        for now, counts in _transitions(states).items():
            self._followers[now] = _added(self._followers.get(now, {}), counts)


class TDLambda(Learner):
    """TD(λ) with updates at the end of an episode: q(c) ← q(c) + α[G - q(c)], G = ρ + γ[(1 - λ)q(c') + λG'].

    This is the off-line λ-return algorithm of Sutton & Barto 2018, §12.1. λ = 0 is SARSA with a table that changes only
    at the end of an episode.
    """

    def __init__(
        self, sites: int, gamma: float = GAMMA_EVENT, alpha: float = ALPHA, trace: float = LAMBDA
    ) -> None:
        super().__init__(sites, gamma, alpha)
        self.trace = trace

    def _follow(self, states: Sequence[int], rewards: Sequence[float], q: list[float]) -> None:
        gamma, trace = self.gamma, self.trace
        returns, ahead, value = [], 0.0, 0.0
        for now, reward in zip(reversed(states), reversed(rewards), strict=True):
            value = reward + gamma * ((1 - trace) * ahead + trace * value)
            ahead = q[now]
            returns.append(value)
        for now, value in zip(states, reversed(returns), strict=True):
            q[now] += self.alpha * (value - q[now])


LEARNERS: Mapping[str, type[Learner]] = {
    "sarsa": Sarsa,
    "expected-sarsa": ExpectedSarsa,
    "td-lambda": TDLambda,
}


def _transitions(states: Sequence[int]) -> dict[int, dict[int, int]]:
    found: dict[int, dict[int, int]] = {}
    for now, then in zip(states, [*states[1:], END], strict=True):
        counts = found.setdefault(now, {})
        counts[then] = counts.get(then, 0) + 1
    return found


def _added(first: Mapping[int, int], second: Mapping[int, int]) -> dict[int, int]:
    return {then: first.get(then, 0) + second.get(then, 0) for then in {**first, **second}}


def _shares(counts: Mapping[int, int]) -> list[tuple[int, float]]:
    """Return the next states with their probabilities; END is omitted, because its utility is 0."""
    whole = sum(counts.values())
    return [(then, count / whole) for then, count in counts.items() if then != END]
