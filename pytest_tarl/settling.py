"""Decide when a recording ends: after a fixed number of episodes, or once it is clear whether `min_success` holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log

from pytest_tarl.designation import Designation
from pytest_tarl.errors import RecordingError
from pytest_tarl.learning.bounds import Range, evidence_above
from pytest_tarl.learning.guarantees import stated, varies
from pytest_tarl.learning.tables import Sample
from pytest_tarl.model import Guarantee
from pytest_tarl.report.guarantee_words import percent

ENOUGH_FAILURES = 5  # minimum number of failures to stop a recording early
MOST = 20_000  # maximum number of episodes if a confidence is required


@dataclass
class Settling:
    """Stopping rule, called after every episode. At least `asked` episodes run, unless too many fail."""

    designation: Designation
    asked: int
    episodes: int = 0
    passed: int = 0

    @property
    def most(self) -> int:
        """Return the maximum number of episodes."""
        return self.asked if self.designation.confidence is None else max(MOST, self.asked)

    def __call__(self, samples: Sequence[Sample]) -> bool:
        """Add the newest sample; return whether to stop.

        Raise RecordingError if the sample's total reward is out of range.
        """
        within(samples[-1], self.designation.total_range)
        self.episodes, self.passed = len(samples), self.passed + int(samples[-1].passed.all())
        if self.designation.confidence is None:
            return self.episodes - self.passed >= max(self._bearable + 1, ENOUGH_FAILURES)
        return self._refuted or (self.episodes >= self.asked and self._shown)

    @property
    def failing(self) -> str:
        """Return a sentence with the number of failed episodes if too many failed, or an empty text."""
        least, failed = self.designation.min_success, self.episodes - self.passed
        if self.designation.confidence is None:
            stopped = (
                f"; the other {self.asked - self.episodes} were not run" if self.episodes < self.asked else ""
            )
            ran = f"the first {self.episodes} episodes" if stopped else f"{self.episodes} episodes"
            share = self.passed / self.episodes
            told = (
                f"{failed} of {ran} failed (success {percent(share)}, min_success {percent(least)}{stopped})"
            )
            return told if failed > self._bearable else ""
        sure = f"{self.designation.confidence:.5g}"
        if self._refuted:
            return (
                f"{failed} of {self.episodes} episodes failed: at confidence={sure}, the success rate is below "
                f"{least:.4g}"
            )
        if not self._shown:
            return (
                f"{self.passed} of {self.episodes} episodes succeeded, which is too close to min_success={least:.4g} "
                f"to decide at confidence={sure}"
            )
        return ""

    @property
    def _bearable(self) -> int:
        return int(self.asked * (1 - self.designation.min_success) + 1e-9)

    @property
    def _shown(self) -> bool:
        return evidence_above(self.passed, self.episodes, self.designation.min_success) >= self._enough

    @property
    def _refuted(self) -> bool:
        failed = self.episodes - self.passed
        return evidence_above(failed, self.episodes, 1 - self.designation.min_success) >= self._enough

    @property
    def _enough(self) -> float:
        return -log(1 - (self.designation.confidence or 0.0))


def within(sample: Sample, declared: tuple[float, float] | None) -> None:
    """Raise RecordingError if an episode's total reward is outside the marker's `total_range`."""
    if declared is None:
        return
    for seed, total in zip(sample.seeds, sample.total.tolist(), strict=True):
        if not declared[0] <= total <= declared[1]:
            raise RecordingError(
                f"An episode (seed {seed}) earned {total:.6g}, outside the marker's "
                f"total_range={declared}: bounds on the mean are valid only if every total is inside. "
                "Widen it to the worst and best possible total, or remove it."
            )


def guarantee(sample: Sample, designation: Designation) -> Guarantee:
    """Return the bounds for future episodes of the recorded world."""
    return stated(
        sample.passed.tolist(),
        sample.total.tolist(),
        confidence=designation.confidence,
        declared=Range(*designation.total_range) if designation.total_range else None,
        anytime=designation.confidence is not None,
        varied=varies(sample),
    )
