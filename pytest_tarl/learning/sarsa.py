"""The paper's way to the utility: SARSA, event by event."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pytest_tarl.learning.sequences import EventSequence
from pytest_tarl.learning.tables import END, START, Floats, Ints
from pytest_tarl.learning.utility import GAMMA_EVENT
from pytest_tarl.sensors import Cell

ALPHA = 0.1


class Sarsa:
    """Learn q(c) ← q(c) + α[ρ + γq(c') - q(c)] for one taint list, from one episode after the other.

    The rule is linear in ρ = r·[last event of its step] + r·|f|/F: a table for either term is learned, and F, which is
    known after the last episode only, is asked for when they are added up. So no episode has to be kept.
    """

    def __init__(self, sites: int, gamma: float = GAMMA_EVENT, alpha: float = ALPHA) -> None:
        self.sites = sites
        self.gamma = gamma
        self.alpha = alpha
        self._row: dict[Cell, int] = {}
        self._full = [0.0]  # by state, the start first
        self._scaled = [0.0]
        self._seen = set[int]()

    def learn(self, sequence: EventSequence, cells: Sequence[Cell]) -> None:
        """Follow one sequence whose states count the given cells."""
        states = self._numbered(sequence.state, cells).tolist()
        self._seen.update(states)
        full, scaled, alpha, gamma = self._full, self._scaled, self.alpha, self.gamma
        signals = zip(sequence.reward.tolist(), sequence.scaled.tolist(), strict=True)
        for now, then, (rho, rho_scaled) in zip(states, [*states[1:], END], signals, strict=True):
            ahead, ahead_scaled = (full[then], scaled[then]) if then != END else (0.0, 0.0)
            full[now] += alpha * (rho + gamma * ahead - full[now])
            scaled[now] += alpha * (rho_scaled + gamma * ahead_scaled - scaled[now])

    def table(self, cells: Sequence[Cell], scale: float) -> Floats:
        """Return q(x, n), shape (cells, sites); NaN where never visited. `scale` is F; infinite: no flow term."""
        q = np.array(self._full) + np.array(self._scaled) / scale
        q[[state for state in range(q.size) if state not in self._seen]] = np.nan
        by_row = q[START + 1 :].reshape(len(self._row), self.sites)
        table = np.full((len(cells), self.sites), np.nan)
        known = [i for i, cell in enumerate(cells) if cell in self._row]
        table[known] = by_row[[self._row[cells[i]] for i in known]]
        return table

    def _numbered(self, state: Ints, cells: Sequence[Cell]) -> Ints:
        """Number states by the order in which their cells were first met."""
        row = np.array([self._row.setdefault(cell, len(self._row)) for cell in cells], dtype=np.int64)
        more = [0.0] * (1 + len(self._row) * self.sites - len(self._full))
        self._full += more
        self._scaled += more
        if not row.size:
            return state
        cell, site = np.divmod(np.maximum(state - 1, 0), max(self.sites, 1))
        return np.where(state > START, 1 + row[cell] * self.sites + site, state)
