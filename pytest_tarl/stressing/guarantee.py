"""The guarantee of a recording, and what episodes under a drift show about it.

The guarantee has two parts: a minimum success rate, and a maximum loss of mean reward.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import takewhile
from math import ceil, sqrt
from statistics import fmean, stdev
from typing import Literal

from pytest_tarl.designation import Designation
from pytest_tarl.errors import RecordingError
from pytest_tarl.learning.bounds import Range, loss_between, mean_of, rate
from pytest_tarl.learning.drift import tolerated
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.guarantees import CONFIDENCE
from pytest_tarl.rollout import EpisodeRun

LOWEST = -1.5  # lower limit of margins: a lower margin says little about where the boundary is
# minimum number of episodes for the result "holds"; if 1 in 12 episodes fails, 8 episodes still pass in half of all
# cases
LEAST = 8
HOPEFUL = 0.84  # one-sided confidence of the bound "mean plus one standard error"
# approximate error probability of each decision of the search; only tests on fresh seeds are exact
SEARCH_RISK = 0.05

Answer = Literal["fails", "holds", "open"]
Part = Literal["rate", "loss", "both"]  # the part of the guarantee that is tested


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of one episode."""

    passed: bool
    total: float


@dataclass(frozen=True, slots=True)
class Evidence:
    """What episodes under a drift show about the guarantee.

    `margin` is 1 for the recorded performance, and 0 where the guarantee is only just met.
    """

    result: Answer
    margin: float
    episodes: int
    passed: int
    loss: float  # mean loss of reward per episode, compared with the nominal episode of the same seed
    spread: float  # standard deviation of the loss of an episode

    @property
    def failing(self) -> bool:
        """Return whether the guarantee seems to fail, according to the evidence so far."""
        return self.result == "fails" or (self.result == "open" and self.margin < 0.0)


@dataclass(frozen=True)
class Guarantee:
    """The guaranteed success rate and the tolerated loss of reward per episode.

    `totals` are the total rewards of the recorded episodes.
    """

    rate: float
    tolerance: float
    totals: tuple[float, ...]
    share: float  # share of recorded episodes that passed
    declared: Range | None = None

    def margin(self, passed: float, loss: float) -> float:
        """Return how far a pass rate and a mean loss are from breaking the guarantee.

        The margin is 1 for the recorded performance, and 0 where the guarantee is only just met.
        """
        room = max(self.share - self.rate, 1e-9)
        of_rate = (passed - self.rate) / room
        of_loss = 1.0 - loss / self.tolerance if self.tolerance > 0 else (1.0 if loss <= 0.0 else -1.0)
        return min(of_rate, of_loss, 1.0)


def guarantee(fixture: Fixture, designation: Designation) -> Guarantee:
    """Return the guarantee of a recording.

    The guaranteed success rate is the recording's lower confidence bound, but at most `min_success`. The tolerated loss
    follows from the marker's tolerance.
    """
    sample = fixture.sample
    outcomes = [
        Outcome(bool(passed), float(total)) for passed, total in zip(sample.passed, sample.total, strict=True)
    ]
    return guaranteed(outcomes, tolerated(sample, designation.tolerance), designation)


def guaranteed(outcomes: Sequence[Outcome], tolerance: float, designation: Designation) -> Guarantee:
    """Return the guarantee that follows from recorded outcomes and a tolerated loss."""
    passed, episodes = sum(one.passed for one in outcomes), len(outcomes)
    return Guarantee(
        rate=min(designation.min_success, rate(passed, episodes, CONFIDENCE).low),
        tolerance=tolerance,
        totals=tuple(one.total for one in outcomes),
        share=passed / episodes,
        declared=Range(*designation.total_range) if designation.total_range else None,
    )


def outcome(run: EpisodeRun) -> Outcome:
    """Return the outcome of an episode; it has failed if a node never yields.

    Raise RecordingError if the test itself is broken.
    """
    if run.broken and not run.stuck:
        where = ", ".join(f"{name}={number:g}" for name, number in (run.plan.point or {}).items())
        raise RecordingError(
            f"An episode at {where} (seed {run.plan.seed}) failed outside the mission:\n{run.broken}"
        )
    return Outcome(run.passed and not run.stuck, float(run.trace.reward.sum()))


def examined(given: Guarantee, outcomes: Sequence[Outcome], nominal: Sequence[Outcome]) -> Evidence:
    """Return the evidence from outcomes that are paired with nominal ones by seed.

    The evidence is approximate, which is enough to guide the search.
    """
    count, passed = len(outcomes), sum(one.passed for one in outcomes)
    losses = _losses(outcomes, nominal)
    loss = fmean(losses)
    bound = mean_of(losses, 1.0 - SEARCH_RISK)
    failing = _too_few_pass(given, outcomes, SEARCH_RISK) or bound.low > given.tolerance
    holding = count >= LEAST and passed / count >= given.rate and bound.high < given.tolerance
    answer: Answer = "fails" if failing else "holds" if holding else "open"
    spread = stdev(losses) if count > 1 else 0.0
    return Evidence(answer, given.margin(passed / count, loss), count, passed, loss, spread)


def margin_of_one(given: Guarantee, outcome: Outcome, nominal: Outcome) -> float:
    """Return the margin of a single episode, paired with the nominal episode of the same seed."""
    return given.margin(float(outcome.passed), nominal.total - outcome.total)


def margin_of(
    given: Guarantee, outcomes: Sequence[Outcome], nominal: Sequence[Outcome]
) -> tuple[float, float]:
    """Return the margin of outcomes, cut off at LOWEST, and its approximate standard deviation.

    If some episodes failed, the deviation is half the width of the margin's 80 % interval. If all passed, it is the
    standard error of the mean loss. The losses of a few episodes may be equal by chance, so the error is computed with
    two more losses, which differ from the mean by a third of the tolerance.
    """
    count, passed = len(outcomes), sum(one.passed for one in outcomes)
    losses = _losses(outcomes, nominal)
    mean = fmean(losses)
    margin = max(given.margin(passed / count, mean), LOWEST)
    if passed < count:
        bounds = rate(passed, count, 0.9)
        high, low = (max(given.margin(share, 0.0), LOWEST) for share in (bounds.high, bounds.low))
        return margin, max((high - low) / 2, 0.1)
    prior = (given.tolerance / 3) ** 2
    variance = (sum((one - mean) ** 2 for one in losses) + 2 * prior) / (count + 1)
    return margin, sqrt(variance / count) / given.tolerance if given.tolerance > 0.0 else 1.0


def refuted(
    given: Guarantee,
    outcomes: Sequence[Outcome],
    nominal: Sequence[Outcome],
    risk: float,
    part: Part = "both",
) -> bool:
    """Return whether fresh episodes show that the guarantee fails, with error probability `risk`.

    The guarantee fails if too few episodes pass or too much reward is lost; `part` restricts the test to one of the
    two. Losses are paired with nominal episodes by seed. The bound on the loss is exact if the marker declares
    total_range; otherwise it is Student's approximation.
    """
    share = risk / 2 if part == "both" else risk
    if part != "loss" and _too_few_pass(given, outcomes, share):
        return True
    if part == "rate":
        return False
    return mean_of(_losses(outcomes, nominal), 1.0 - share, _differences(given)).low > given.tolerance


def recorded_mean(given: Guarantee, risk: float) -> float:
    """Return a lower bound on the nominal mean reward from the recorded rewards, with error probability `risk`.

    The bound is exact if the marker declares total_range; otherwise it is Student's.
    """
    return mean_of(given.totals, 1.0 - risk, given.declared).low


def most_passed(given: Guarantee, count: int, risk: float, part: Part = "both") -> int:
    """Return the largest number of passes in `count` episodes that refutes the guarantee, or -1."""
    return _most_passed(given.rate, count, risk / 2 if part == "both" else risk)


@cache
def _most_passed(least: float, count: int, risk: float) -> int:
    refuting = takewhile(lambda n: rate(n, count, 1.0 - risk).high < least, range(count + 1))
    return max(refuting, default=-1)


def hopeless(
    given: Guarantee,
    outcomes: Sequence[Outcome],
    nominal: Sequence[Outcome],
    most: int,
    risk: float,
    part: Part = "both",
    *,
    strict: bool = False,
) -> bool:
    """Return whether, after the first episodes, `most` episodes are unlikely to refute the guarantee.

    About one standard error is added to the loss and to the number of failures. If the guarantee still holds, a
    refutation is unlikely. With `strict`, a refutation also counts as unlikely if the remaining episodes could not
    refute the guarantee with this increased loss. `part` is as in `refuted`.
    """
    if part != "loss":
        count, failed = len(outcomes), sum(not one.passed for one in outcomes)
        if hopeful(failed, count) * most >= most - most_passed(given, most, risk, part):
            return False
    if part == "rate":
        return True
    losses = _losses(outcomes, nominal)
    high = mean_of(losses, HOPEFUL).high
    if high <= given.tolerance or not strict:
        return high <= given.tolerance
    further = (high - fmean(losses)) * (1.0 - len(losses) / most)
    repeated = (losses * ceil(most / len(losses)))[:most]
    confidence = 1.0 - (risk / 2 if part == "both" else risk)
    return mean_of(repeated, confidence, _differences(given)).low + further <= given.tolerance


def hopeful(failed: float, count: int) -> float:
    """Return the failure rate of `count` episodes, increased by about one standard error."""
    return (failed + sqrt(failed + 1.0)) / count


def enough_pass(given: Guarantee, outcomes: Sequence[Outcome], risk: float) -> bool:
    """Return whether fresh episodes show the guaranteed success rate, with error probability `risk`."""
    count, passed = len(outcomes), sum(one.passed for one in outcomes)
    return rate(passed, count, 1.0 - risk).low >= given.rate


def little_lost(
    given: Guarantee, outcomes: Sequence[Outcome], nominal: Sequence[Outcome], risk: float
) -> bool:
    """Return whether fresh episodes show that the loss is tolerated, with error probability `risk`.

    The bound on the loss is computed as in `refuted`.
    """
    return mean_of(_losses(outcomes, nominal), 1.0 - risk, _differences(given)).high <= given.tolerance


def unlike_recorded(given: Guarantee, outcomes: Sequence[Outcome], risk: float) -> bool:
    """Return whether episodes break the guarantee compared with the recorded rewards, with error probability `risk`."""
    if _too_few_pass(given, outcomes, risk / 2):
        return True
    totals = [one.total for one in outcomes]
    return loss_between(given.totals, totals, 1.0 - risk / 2, given.declared).low > given.tolerance


def _too_few_pass(given: Guarantee, outcomes: Sequence[Outcome], risk: float) -> bool:
    """Return whether the success rate's upper Clopper-Pearson bound, at `risk`, is below the guarantee."""
    passed = sum(one.passed for one in outcomes)
    return rate(passed, len(outcomes), 1.0 - risk).high < given.rate


def _differences(given: Guarantee) -> Range | None:
    """Return the range of possible losses, or None if the marker declares no total_range."""
    ends = given.declared
    return None if ends is None else Range(ends.low - ends.high, ends.high - ends.low)


def _losses(outcomes: Sequence[Outcome], nominal: Sequence[Outcome]) -> list[float]:
    return [before.total - after.total for before, after in zip(nominal, outcomes, strict=True)]
