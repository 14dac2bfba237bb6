"""Collect the signals of a running episode, and judge its formulas when the test body ends."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from pytest_tarl.errors import RequirementError, SettingsError, TarlError
from pytest_tarl.formulas.judging import Judge, Judged
from pytest_tarl.formulas.marker_arguments import Requirements, check_texts
from pytest_tarl.sensors import Sensor


class EpisodeFormulas:
    """The signals and requirements of one episode; `now` returns its virtual time in ns."""

    def __init__(self, requirements: Requirements, sensors: Sequence[Sensor], now: Callable[[], int]) -> None:
        self.judged: tuple[Judged, ...] = ()
        self._requirements = requirements
        self._sensors = sensors
        self._now = now
        followed = requirements.followed
        self._judge = (
            Judge(requirements.names, requirements.formulas, requirements.said) if followed else None
        )

    def give(self, name: str, value: object) -> None:
        """Set a signal from now on. Raise SettingsError if the value is not a number."""
        if self._judge is not None:
            self._judge.give(name, value, self._now())

    def require(self, formula: str, *, begun: bool) -> None:
        """Add a requirement; `begun` says whether the episode has started.

        Raise SettingsError if the formula cannot be used, or if the episode has started without recording signals.
        """
        check_texts("tarl.require", formula, self._sensors)
        if self._judge is None:
            if begun or self._now():
                raise SettingsError(
                    "tarl.require: the formula was added after the episode began, so its signals were not recorded so "
                    "far: call tarl.require before the first step, or put requires=[] into the marker."
                )
            self._judge = Judge(self._requirements.names, (), self._requirements.said)
        self._judge.require(formula)

    def stepped(self) -> bool:
        """Close a step; return whether formulas give its reward, which is then known only after the episode."""
        if self._judge is None:
            return False
        self._judge.steps.append(self._now())
        return self._requirements.rewarding

    def conclude(self, *, whole: bool, alone: bool) -> None:
        """Judge the formulas after the test body; only an episode that was not cut short (`whole`) can violate them.

        `alone` marks a plain run of one episode, which must be long enough for every formula. Raise RequirementError if
        a formula is violated.
        """
        if self._judge is None:
            return
        try:
            self.judged = self._judge.conclude(self._now())
        except TarlError:
            if whole:
                raise
            return
        if not whole:
            return
        too_short = self._judge.unjudged(self._now()) if alone else ""
        if too_short:
            raise SettingsError(too_short)
        violation = self._judge.violation(self.judged)
        if violation:
            raise RequirementError(violation)

    def rewards(self) -> list[float] | None:
        """Return each step's reward from the formulas, shape (steps,), or None if the test sets the rewards."""
        if not self._requirements.rewarding or self._judge is None:
            return None
        return self._judge.rewards(self._now(), self._requirements.cap)
