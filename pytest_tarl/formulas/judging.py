"""Evaluate the formulas of one episode: robustness, violations, and rewards of steps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from pytest_tarl.errors import RecordingError
from pytest_tarl.formulas.parsing import Formula, formula
from pytest_tarl.formulas.said import NOTHING_SAID, Said
from pytest_tarl.formulas.signals import NANOSECONDS, Timeline

if TYPE_CHECKING:
    from pytest_tarl.formulas.robustness import Course

LARGEST = 1e9  # robustness is clipped to ± this value, because inputs (such as laser ranges) may be infinite
NEGLIGIBLE = 1e-12  # smaller margins are shown as 0


class Judged(NamedTuple):
    """The result of a formula in an episode: its robustness, and when (s) it became impossible to satisfy.

    Robustness is above 0 if the formula holds, and NaN if the episode was too short to judge it. `lost` is NaN unless
    the formula was violated.
    """

    formula: str
    robustness: float
    lost: float = math.nan

    @property
    def violated(self) -> bool:
        """Return whether the formula was judged and does not hold."""
        return self.robustness <= 0


class Judge:
    """Record the signals of an episode, and evaluate its formulas at the end."""

    def __init__(self, names: Sequence[str], formulas: Sequence[Formula], said: Said = NOTHING_SAID) -> None:
        self.names = tuple(names)
        self.said = said
        self.timeline = Timeline(names)
        self.formulas = list(formulas)
        self.steps: list[int] = []  # end of each step (ns since the episode began)
        self._courses: dict[str, Course] = {}

    def give(self, name: str, value: Any, time: int) -> None:
        """Set a signal from a given time on. Raise SettingsError if the value is not a number."""
        self.timeline.give(name, value, time)

    def require(self, text: str) -> None:
        """Add a formula. Raise SettingsError if the text is not a formula."""
        added = formula("tarl.require", text, self.names, self.said)
        if added not in self.formulas:
            self.formulas.append(added)

    def conclude(self, end: int) -> tuple[Judged, ...]:
        """Judge all formulas. Raise RecordingError if a signal never had a value or no time has passed."""
        self._check(end)
        return tuple(self._judged(one, end) for one in self.formulas)

    def unjudged(self, end: int) -> str:
        """Return a sentence on a formula that the episode was too short for, or an empty text."""
        from pytest_tarl.formulas.reach import unjudged

        for one in self.formulas:
            problem = unjudged(one.tree, end)
            if problem:
                return (
                    f"The formula {one.text!r} can never be judged: {problem}, and the episode lasts "
                    f"{end / NANOSECONDS:g} s. Shorten its bounds, or run a longer episode."
                )
        return ""

    def rewards(self, end: int, cap: float) -> list[float]:
        """Return the reward of each step, shape (steps,): how much it changes the lowest robustness so far.

        Robustness is clipped to ±cap. The rewards sum to the lowest robustness at the end of the episode. An episode
        that ends before its signals are known earns -cap in total.
        """
        ends = [*self.steps[:-1], end] if self.steps else []
        if not ends:
            return []
        if not self.formulas or end == 0 or self._silent() is not None:
            return [0.0] * (len(ends) - 1) + [-cap]
        from pytest_tarl.formulas.robustness import running

        courses = [self._course(one) for one in self.formulas]
        least = [min(values) for values in zip(*(running(one, ends) for one in courses), strict=True)]
        capped = [max(-cap, min(cap, value)) for value in least]
        return [after - before for before, after in zip([0.0, *capped], capped, strict=False)]

    def violation(self, judged: Sequence[Judged]) -> str:
        """Describe the violated formulas, earliest violation first; empty if all formulas hold."""
        broken = sorted((one for one in judged if one.violated), key=lambda one: one.lost)
        return "\n".join(self._sentence(one) for one in broken)

    def _judged(self, one: Formula, end: int) -> Judged:
        from pytest_tarl.formulas.reach import unjudged
        from pytest_tarl.formulas.robustness import lost_at, robustness

        if unjudged(one.tree, end):
            return Judged(one.text, math.nan)
        course = self._course(one)
        value = max(-LARGEST, min(LARGEST, robustness(course, end)))
        if value > 0:
            return Judged(one.text, value)
        lost = lost_at(course, sorted({*self.timeline.instants(one.signals, end), *self.steps, end}))
        return Judged(one.text, value, (end if lost is None else lost) / NANOSECONDS)

    def _sentence(self, judged: Judged) -> str:
        names = next(one.signals for one in self.formulas if one.text == judged.formula)
        values = self.timeline.at(names, round(judged.lost * NANOSECONDS))
        told = ", ".join(f"{name} = {value:.6g}" for name, value in values.items())
        return (
            f"requirement violated at {judged.lost:g} s: {judged.formula} "
            f"(robustness {margin(judged.robustness)}; {told})"
        )

    def _course(self, one: Formula) -> Course:
        from pytest_tarl.formulas.robustness import course

        if one.text not in self._courses:
            self._courses[one.text] = course(one, self.timeline.samples(one.signals))
        return self._courses[one.text]

    def _silent(self) -> tuple[Formula, str] | None:
        for one in self.formulas:
            name = self.timeline.missing(one.signals)
            if name is not None:
                return one, name
        return None

    def _check(self, end: int) -> None:
        if self.formulas and end == 0:
            raise RecordingError(
                "No virtual time passed, so no formula can be judged: call tarl.step(dt) in each simulation step; "
                "bounds are seconds of virtual time."
            )
        silent = self._silent()
        if silent is not None:
            one, name = silent
            raise RecordingError(
                f"The formula {one.text!r} needs the signal {name!r}, which never had a value: call "
                f"tarl.observe({name}=…) in each step, or check its topic and field in the marker."
            )


def margin(robustness: float) -> str:
    """Format a robustness for display."""
    return f"{0.0 if abs(robustness) < NEGLIGIBLE else robustness:.4g}"
