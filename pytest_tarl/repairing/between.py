"""Bisect between the original value, which gains too little, and a changed value that does harm elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import log

from pytest_tarl.model import Reason
from pytest_tarl.patching.charts import step_to
from pytest_tarl.patching.mutate import Mutation, step_of, to_step
from pytest_tarl.searching.search import Candidate
from tarl_lint.model import Operand

STEPS = 4
WEAK: tuple[Reason, ...] = (
    "gain too small",
    "fails too often",
    "worse than unrepaired",
    "not over the whole range",
)
STRONG: tuple[Reason, ...] = ("nominal gets worse", "breaks other missions")
WEAKEST = 0.25  # parameters of structural changes are reduced at most to this share of their value
FINEST = 1.05  # the bisection stops when the ratio of its two factors is below this limit


class Between:
    """A bisection on a log scale that moves all operands of a candidate together.

    It ends at once if an operand is a boolean or changes its sign. Parameters of structural changes have no original
    value, so the bisection goes down to `WEAKEST` times their value.
    """

    def __init__(self, candidate: Candidate, mutate: Callable[[Operand, float], Mutation | None]) -> None:
        self.candidate = candidate
        self.mutate = mutate
        self.weak, self.strong = 0.0, 1.0  # exponents of the candidate's factors
        self.steps = 0
        self._scales = [_scale(mutation) for mutation in candidate.mutations]

    def beyond(self, known: Candidate) -> None:
        """Start from a candidate of the same operands that is known to gain too little."""
        if further(self.candidate, known):
            strong, weak = common_factor(self.candidate), common_factor(known)
            if strong is not None and weak is not None:
                self.weak = max(self.weak, log(weak) / log(strong))

    def middle(self) -> Candidate | None:
        """Return the candidate with the exponent `share`, or None if the bisection is over."""
        scales = [one for one in self._scales if one is not None]
        if self.steps >= STEPS or len(scales) < len(self._scales):
            return None
        span = self.strong - self.weak
        if all(max(by, 1 / by) ** span < FINEST for _, by in scales):
            return None
        self.steps += 1
        return self.at(self.share)

    @property
    def share(self) -> float:
        """Return the exponent halfway between the weak and the strong one."""
        return (self.weak + self.strong) / 2

    def at(self, share: float) -> Candidate | None:
        """Return the candidate whose factors are raised to an exponent, or None if that changes nothing."""
        scales = [one for one in self._scales if one is not None]
        tried = (
            to_step(mutation, weakest * by**share, self.mutate)
            for mutation, (weakest, by) in zip(self.candidate.mutations, scales, strict=True)
        )
        moved = tuple(mutation for mutation in tried if mutation is not None)
        return replace(self.candidate, mutations=moved) if moved else None

    def told(self, reason: Reason) -> bool:
        """Store the result of the last candidate; return whether the result shows on which side to continue."""
        share = self.share
        if reason in WEAK:
            self.weak = share
        elif reason in STRONG:
            self.strong = share
        else:
            return False
        return True


def _scale(mutation: Mutation) -> tuple[float, float] | None:
    """Return the weakest step of a mutation, and by what factor the mutation's own step exceeds it.

    Return None if the mutation cannot be bisected.
    """
    if mutation.form is not None:
        step = None if on_grid(mutation) else searched_step(mutation)
        return (step * WEAKEST, 1.0 / WEAKEST) if step else None
    by = factor(mutation)
    return (1.0, by) if by is not None else None


def stronger(
    candidate: Candidate, power: float, mutate: Callable[[Operand, float], Mutation | None]
) -> Candidate | None:
    """Return a candidate with its factors raised to a power, or None if that is impossible."""
    moved: list[Mutation] = []
    for mutation in candidate.mutations:
        by = searched_step(mutation)
        if by is None or by <= 0.0 or by == 1.0 or on_grid(mutation):
            return None
        made = to_step(mutation, by**power, mutate)
        if made is None:
            return None
        moved.append(made)
    return replace(candidate, mutations=tuple(moved))


def further(candidate: Candidate, other: Candidate) -> bool:
    """Return whether a candidate moves the same operands as `other` in the same direction, at least as far."""
    mine, its = ({m.operand: factor(m) for m in one.mutations} for one in (candidate, other))
    if mine.keys() != its.keys():
        return False
    pairs = [(mine[operand], its[operand]) for operand in mine]
    return all(one is not None and two is not None and _beyond(one, two) for one, two in pairs)


def _beyond(one: float, other: float) -> bool:
    return one >= other > 1.0 or one <= other < 1.0


def searched_step(mutation: Mutation) -> float | None:
    """Return the factor on a constant or on a structural repair's parameter, or None if there is none."""
    searched = mutation.form is not None and mutation.form.parameter
    return float(mutation.value) if searched else factor(mutation)


def on_grid(mutation: Mutation) -> bool:
    """Return whether a structural repair's parameter can only be a multiple of a given number."""
    form = mutation.form
    return form is not None and any(
        one.name == form.parameter and one.grid for one in form.template.parameters
    )


def common_factor(candidate: Candidate) -> float | None:
    """Return a candidate's only factor (or step) if it changes one constant, else None."""
    found = {factor(mutation) for mutation in candidate.mutations}
    constants = {mutation.operand.definition for mutation in candidate.mutations}
    several = len(candidate.mutations) > 1 and (len(constants) > 1 or None in constants)
    return found.pop() if len(found) == 1 and not several else None


def factor(mutation: Mutation) -> float | None:
    """Return the positive factor (or step on a chart) by which a mutation moves its operand, or None."""
    operand, value = mutation.operand, mutation.value
    if mutation.form is not None or isinstance(operand.value, bool) or isinstance(value, bool):
        return None
    if mutation.chart is not None:
        return step_of(mutation)
    if operand.value == 0:
        return step_to(value)
    moved = float(value) / operand.value if operand.literal and operand.value is not None else float(value)
    return moved if moved > 0.0 else None
