"""Adapter for any optimiser with an ask/tell interface: ask for factors, tell their gain."""

from __future__ import annotations

import importlib
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any, Protocol

from pytest_tarl.errors import RepairError, SearchError, SettingsError
from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.searching.confirming import confirmed
from pytest_tarl.searching.search import (
    BudgetSpentError,
    Candidate,
    Goal,
    Mutate,
    Pair,
    Trials,
    operand_effect,
)
from tarl_lint.model import Operand

UNMOVED = 0.02  # a factor that differs from 1 by at most this amount leaves the constant unchanged
MOST_IDLE = 200  # the search ends after this number of consecutive proposals without a new episode
MOST_AT_ONCE = 1000


@dataclass(frozen=True, slots=True)
class Constant:
    """A use of a constant for the optimiser; `value` is None if it is known only at run time."""

    path: str
    line: int
    code: str
    value: float | bool | None


class Optimiser(Protocol):
    """Interface of a plug-in optimiser.

    The optional attribute `batch` is the number of proposals to request at once. Episodes of a batch run in parallel
    under `--tarl-workers`; the number of workers never changes the batch.
    """

    def ask(self) -> Sequence[float]:
        """Return a factor for every constant; raise StopIteration to end the search.

        A factor of 1 leaves the constant unchanged; a negative factor flips its sign, or flips a boolean. A constant
        that is zero becomes `factor - 1` for factors above 1 and `1 - 1 / factor` for factors below 1.
        """

    def tell(self, factors: Sequence[float], gain: float) -> None:
        """Receive the gain of these factors over the unmutated run of the same seed."""


Factory = Callable[[Sequence[Constant], int], Optimiser]


def factory(name: str, folders: Sequence[Path]) -> Factory:
    """Import `module:factory` and return the factory; look for the module in `folders` first. Raise SettingsError."""
    module, _, attribute = name.partition(":")
    where = f"--tarl-search={name}"
    try:
        with _importing_from(folders):
            found = getattr(importlib.import_module(module), attribute, None)
    except ModuleNotFoundError as missing:
        raise SettingsError(
            f"{where}: {missing}; TARL searches for modules in {folders[0]} and on Python's path."
        ) from None
    except Exception as problem:
        raise SettingsError(f"{where}: {module} cannot be imported: {_told(problem)}.") from problem
    if not callable(found):
        what = "has no" if found is None else "can be imported, but it is not a function or a class:"
        raise SettingsError(
            f"{where}: {module} {what} {attribute!r}; name a function of (constants, seed) that returns an object with "
            "ask() and tell(factors, gain)."
        )
    return found  # type: ignore[no-any-return]


class Asking:
    """A search by plug-in optimisers, which take turns. Each guard has its own optimiser."""

    def __init__(
        self,
        name: str,
        make: Factory,
        operands: Sequence[Operand],
        mutate: Mutate,
        guards: Sequence[Guard],
        trials: Trials,
        goal: Goal,
        seed: int,
    ) -> None:
        self.name = name
        self.operands = operands
        self.mutate = mutate
        self.trials = trials
        self.goal = goal
        constants = [Constant(o.span.path, o.span.line, o.code, o.value) for o in operands]
        with self._heeding("its factory"):
            self._leads = [(guard, make(constants, seed + at)) for at, guard in enumerate(guards)]
        for _, lead in self._leads:
            self._check(lead)
        self._found: list[Candidate] = []

    def candidates(self) -> Iterator[Candidate]:
        """Yield confirmed candidates, reduced to the mutations that they need. Raise SearchError."""
        turn, idle, leads = 0, 0, list(self._leads)
        while self.operands and leads and idle < MOST_IDLE:
            guard, optimiser = leads[turn % len(leads)]
            pair = self.goal.pairs[turn // len(leads) % len(self.goal.pairs)]
            before, asked = self.trials.spent, self._asked(optimiser)
            if not asked:
                leads.remove((guard, optimiser))
            yield from self._tried(optimiser, asked, guard, pair)
            idle = 0 if self.trials.spent > before else idle + max(len(asked), 1)
            turn += 1

    def effects(self) -> dict[str, list[OperandEffect]]:
        """For each site, return the best gain that each of its operands has among the confirmed candidates."""
        best: dict[tuple[str, str], OperandEffect] = {}
        for candidate in self._found:
            gain = self.trials.gain(candidate, self.goal)
            for mutation in candidate.mutations:
                key = (str(mutation.operand.site), mutation.operand.code)
                if key not in best or gain > best[key].effect:
                    best[key] = operand_effect(mutation, gain)
        found: dict[str, list[OperandEffect]] = {}
        for (site, _), effect in best.items():
            found.setdefault(site, []).append(effect)
        return found

    def _asked(self, optimiser: Optimiser) -> list[list[float]]:
        """Ask for a batch of proposals. The batch is shorter if the optimiser has no more. Raise SearchError."""
        asked: list[list[float]] = []
        with self._heeding("ask()"):
            for _ in range(getattr(optimiser, "batch", 1)):
                try:
                    point = list(optimiser.ask())
                except StopIteration:
                    break
                asked.append([float(factor) for factor in point])
        for point in asked:
            if len(point) != len(self.operands) or not all(isfinite(factor) for factor in point):
                raise SearchError(
                    f"--tarl-search={self.name}: ask() returned {point!r}, but must return a finite factor for each "
                    f"of the {len(self.operands)} constants, in their order."
                )
        return asked

    def _tried(
        self, optimiser: Optimiser, asked: Sequence[Sequence[float]], guard: Guard, pair: Pair
    ) -> Iterator[Candidate]:
        candidates = [self._candidate(point, guard) for point in asked]
        for at, (point, candidate) in enumerate(zip(asked, candidates, strict=True)):
            self.trials.expect((one, pair.seed) for one in candidates[at:] if one.mutations)
            gain, near = self._gained(candidate, pair)
            with self._heeding("tell()"):
                optimiser.tell(point, gain)
            first = self.goal.pairs.index(pair)
            if near and confirmed(candidate, self.trials, self.goal, first):
                fewer = self._least(candidate, pair)
                kept = fewer if confirmed(fewer, self.trials, self.goal, first) else candidate
                self._found.append(kept)
                yield kept

    def _candidate(self, factors: Sequence[float], guard: Guard) -> Candidate:
        """Return the candidate that applies these factors. A boolean is flipped only by a negative factor."""
        moved = (
            self.mutate(operand, factor)
            for operand, factor in zip(self.operands, factors, strict=True)
            if (factor < 0.0 if isinstance(operand.value, bool) else abs(factor - 1.0) > UNMOVED)
        )
        return Candidate(tuple(mutation for mutation in moved if mutation is not None), guard)

    def _gained(self, candidate: Candidate, pair: Pair) -> tuple[float, bool]:
        """Run a candidate; return its gain and whether it reached the goal.

        A candidate that cannot be written into the source gets the total reward of the worst episode.
        """
        if not candidate.mutations:
            return 0.0, False
        try:
            outcome = self.trials(candidate, pair.seed)
        except RepairError:
            return min(one.total for one in self.goal.pairs) - pair.total, False
        return self.goal.gain(outcome, pair.total), self.goal.reached(outcome, pair.seed)

    def _least(self, candidate: Candidate, pair: Pair) -> Candidate:
        """Drop unneeded mutations one by one, because optimisers tend to move every constant a little."""
        for mutation in candidate.mutations:
            kept = tuple(one for one in candidate.mutations if one != mutation)
            fewer = Candidate(kept, candidate.guard)
            try:
                if kept and self.goal.reached(self.trials(fewer, pair.seed), pair.seed):
                    candidate = fewer
            except RepairError:
                continue
        return candidate

    def _check(self, optimiser: Any) -> None:
        """Raise SearchError if an object is not an optimiser."""
        missing = [name for name in ("ask", "tell") if not callable(getattr(optimiser, name, None))]
        if missing:
            raise SearchError(
                f"--tarl-search={self.name}: the factory returned {type(optimiser).__name__}, which has no method "
                f"{' and no '.join(missing)}; an optimiser needs ask() and tell(factors, gain)."
            )
        batch = getattr(optimiser, "batch", 1)
        if not isinstance(batch, int) or not 1 <= batch <= MOST_AT_ONCE:
            raise SearchError(
                f"--tarl-search={self.name}: batch must be a whole number from 1 to {MOST_AT_ONCE}, got {batch!r}."
            )

    @contextmanager
    def _heeding(self, what: str) -> Iterator[None]:
        """Turn an exception of the plug-in into a SearchError that names the plug-in."""
        try:
            yield
        except (BudgetSpentError, SearchError, KeyboardInterrupt):
            raise
        except Exception as problem:
            raise SearchError(f"--tarl-search={self.name}: {what} raised {_told(problem)}.") from problem


def _told(problem: BaseException) -> str:
    """Describe an exception and the line that raised it."""
    frames = traceback.extract_tb(problem.__traceback__)
    last = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
    return f"{type(problem).__name__}: {problem}{last}"


@contextmanager
def _importing_from(folders: Sequence[Path]) -> Iterator[None]:
    before = sys.path[:]
    sys.path[:0] = [str(folder) for folder in folders]
    try:
        yield
    finally:
        sys.path[:] = before
