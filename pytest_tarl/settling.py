"""How many episodes a recording takes: as many as asked for, or until `min_success` is settled at a confidence."""

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

ENOUGH_FAILURES = 5  # that settle a recording whose min_success can no longer be reached
MOST = 20_000  # episodes that a confidence may take


@dataclass
class Settling:
    """Asked after every off-line episode whether they are enough; `asked` are run at least, unless too many fail."""

    designation: Designation
    asked: int
    episodes: int = 0
    passed: int = 0

    @property
    def most(self) -> int:
        """Return how many episodes to run at most."""
        return self.asked if self.designation.confidence is None else max(MOST, self.asked)

    def __call__(self, samples: Sequence[Sample]) -> bool:
        """Take the newest sample. Raises RecordingError where its total is not one of the declared range."""
        within(samples[-1], self.designation.total_range)
        self.episodes, self.passed = len(samples), self.passed + int(samples[-1].passed.all())
        if self.designation.confidence is None:
            return self.episodes - self.passed >= max(self._bearable + 1, ENOUGH_FAILURES)
        return self._refuted or (self.episodes >= self.asked and self._shown)

    @property
    def failing(self) -> str:
        """Say that too many episodes failed, and at what; empty where they did not."""
        least, failed = self.designation.min_success, self.episodes - self.passed
        if self.designation.confidence is None:
            stopped = (
                f"; the other {self.asked - self.episodes} were not run" if self.episodes < self.asked else ""
            )
            ran = f"the first {self.episodes} episodes" if stopped else f"{self.episodes} episodes"
            share = self.passed / self.episodes
            told = f"{failed} of {ran} failed (success {share:.1%}, min_success {least:.1%}{stopped})"
            return told if failed > self._bearable else ""
        sure = f"{self.designation.confidence:.5g}"
        if self._refuted:
            return (
                f"{failed} of {self.episodes} episodes failed: at confidence={sure}, fewer than {least:.4g} of "
                "all succeed"
            )
        if not self._shown:
            return (
                f"{self.passed} of {self.episodes} episodes succeeded, which is too near to min_success="
                f"{least:.4g} to be told from it at confidence={sure}"
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
    """Raise RecordingError where a total lies outside of the range that the marker declares."""
    if declared is None:
        return
    for seed, total in zip(sample.seeds, sample.total.tolist(), strict=True):
        if not declared[0] <= total <= declared[1]:
            raise RecordingError(
                f"An episode (seed {seed}) earned {total:.6g}, outside of the marker's total_range={declared}: bounds "
                "on the mean hold only if no total ever is. Widen it to what an episode can earn at worst and at best, "
                "or leave it out."
            )


def guarantee(sample: Sample, designation: Designation) -> Guarantee:
    """Return what is stated of the recorded world."""
    return stated(
        sample.passed.tolist(),
        sample.total.tolist(),
        confidence=designation.confidence,
        declared=Range(*designation.total_range) if designation.total_range else None,
        anytime=designation.confidence is not None,
        varied=varies(sample),
    )
