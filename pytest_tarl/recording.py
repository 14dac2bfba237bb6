"""`--tarl-record`: run the test in its designed world, and record the utility of its software."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from math import isfinite
from pathlib import Path

import numpy as np

from pytest_tarl.design import adopted, adopting
from pytest_tarl.designation import Designation
from pytest_tarl.errors import FixtureError, RecordingError
from pytest_tarl.formulas.signals import stored_signal
from pytest_tarl.instrumentation.sites import Plan
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning import fixture as fixtures
from pytest_tarl.learning.bounds import POWER, detectable_loss
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.footprint import Footprint
from pytest_tarl.learning.judgements import accounts, judgements, never_judged
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.sarsa import LEARNERS, Learner
from pytest_tarl.learning.sequences import event_sequences
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Floats, Sample
from pytest_tarl.model import Guarantee
from pytest_tarl.modules_of_tests import Digests
from pytest_tarl.options import Options
from pytest_tarl.report.amounts import amount
from pytest_tarl.report.guarantee_words import percent
from pytest_tarl.report.words import SIGNIFICANT
from pytest_tarl.rollout import EpisodePlan, EpisodeRun, Rollout, in_order
from pytest_tarl.seeds import episode_seeds
from pytest_tarl.sensors import stored
from pytest_tarl.settling import Settling, guarantee

Progress = Callable[[int, int, str], None]
Tell = Callable[[str], None]
Members = Sequence[Sequence[int]]

PILOTS = 20  # number of episodes for learning bins

SILENT = 5  # it is an error if a sensor or node is silent in each of this many first episodes
FEW = 30  # below this number of episodes, a note gives the detectable loss
NOT_REPRODUCIBLE = (
    "not reproducible: two runs with the same seed differ. Draw all random numbers from tarl.rng(name) and read no "
    "wall clock, or comparisons will report spurious differences."
)


@dataclass(frozen=True)
class Recorded:
    """The episodes of a world: the first trace, the statistics of all, and message types by sensor topic.

    `sarsa` has a learner per taint list, updated in the order of the seeds; `learner` names the learning rule.
    """

    first: Trace
    sample: Sample
    sarsa: tuple[Learner, ...]
    topics: dict[str, str]
    failures: tuple[str, ...]
    learner: str = "sarsa"
    notes: tuple[str, ...] = ()
    simulator: bool = False  # whether the world was an external simulator
    # numbers that nodes got as parameters in the first episode, by absolute name
    parameters: Mapping[str, bool | int | float] = field(default_factory=dict)

    @property
    def success(self) -> float:
        """Return the share of episodes that passed."""
        return float(self.sample.passed.mean())


@dataclass(frozen=True)
class RecordResult:
    """The result of `--tarl-record`; if `problem` is not empty, nothing was written."""

    line: str
    problem: str = ""
    notes: tuple[str, ...] = ()
    stated: Guarantee | None = None


def record(
    rollout: Rollout,
    test: str,
    designation: Designation,
    options: Options,
    plan: Plan,
    path: Path,
    progress: Progress,
    tell: Tell,
    drift: str | None = None,
    world: Digests | None = None,
) -> RecordResult:
    """Run the episodes and write the recording, unless too many episodes fail.

    `world` has the hashes of the test's modules. A `drift`, which must be permanent, becomes part of the design. If the
    previous recording cannot be read, this is reported first. Raise FixtureError before the first episode if the file
    cannot be written.
    """
    old, broken = _previous(path)
    for note in broken:
        tell(note)
    fixtures.prepare(path)
    settling = Settling(designation, options.episodes or designation.episodes)
    seeds = episode_seeds(options.seed, "offline", settling.most)
    learner = options.learner or "sarsa"
    footprint = Footprint(settling.asked, tell)
    recorded = run_episodes(rollout, seeds, drift, plan.members, progress, learner, settling, footprint)
    notes = [
        *broken,
        *recorded.notes,
        *repeated(rollout, EpisodePlan(seeds[0], drift, record=True), recorded),
    ]
    refused = _refused(settling, recorded)
    if refused:
        return RecordResult("", refused, tuple(notes))
    notes = [*accounts(recorded.sample.judgements), *notes, *_silent_lists(recorded.sample, plan)]
    notes += detectable(recorded.sample.total)
    new = Fixture(
        test=test,
        seed=options.seed,
        sensors=tuple(map(stored, designation.sensors)),
        lists=plan.lists,
        topics=recorded.topics,
        sample=recorded.sample,
        sarsa=sarsa_tables(recorded, mean_flows(recorded.sample)),
        learner=recorded.learner,
        signals=tuple(map(stored_signal, designation.requirements.signals)),
        design=adopting(adopted(path), drift, designation.drifts),
        stated=guarantee(recorded.sample, designation),
        world=world or {},
    )
    fixtures.save(new, path)
    return RecordResult(_summary(new.sample, old), "", tuple(notes), new.stated)


def repeated(rollout: Rollout, plan: EpisodePlan, recorded: Recorded) -> list[str]:
    """Repeat the first episode; if the result differs, return a note (with both rewards for a simulator)."""
    again = sound(rollout(plan))
    if identical(recorded.first, again.trace):
        return []
    if not recorded.simulator:
        return [NOT_REPRODUCIBLE]
    once, twice = float(recorded.first.reward.sum()), float(again.trace.reward.sum())
    between = f"{recorded.sample.total.std(ddof=1):.3g}" if recorded.sample.episodes > 1 else "unknown"
    note = (
        f"the simulator is not reproducible: two episodes with the same seed earned {once:.4g} and {twice:.4g}, "
        f"{abs(once - twice):.3g} apart; the standard deviation over all episodes is {between}. This "
        "standard deviation includes the noise, so verdicts and bounds remain valid, but a smaller loss "
        "needs more episodes."
    )
    return [note]


def detectable(totals: Floats) -> list[str]:
    """Return a note on the loss that a comparison can detect, if there are fewer than FEW episodes.

    `totals` has the reward of each episode, shape (episodes,).
    """
    if totals.size >= FEW:
        return []
    loss = detectable_loss(totals, totals, SIGNIFICANT)
    if not isfinite(loss):
        return [
            (
                f"{totals.size} episodes are too few: a comparison with so few episodes cannot show any loss. "
                "Record at least 4."
            )
        ]
    if not np.ptp(totals):  # all totals are equal, so a comparison shows even the smallest loss
        return []
    note = (
        f"{totals.size} episodes: a comparison with the same number shows a loss of {amount(loss)} per episode in "
        f"{100 * POWER:.0f} % of runs; to show half that loss, record and compare {4 * totals.size}"
    )
    return [note]


def _refused(settling: Settling, recorded: Recorded) -> str:
    """Return why the recording must not be written, or an empty text."""
    if settling.failing:
        return _unfinished(settling.failing, recorded.failures, recorded.sample.episodes)
    unjudged = never_judged(recorded.sample.judgements)
    return _unjudged(unjudged[0], recorded.sample) if unjudged else ""


def read_values(
    rollout: Rollout, seed: int, progress: Progress, drift: str | None = None
) -> dict[str, list[float]]:
    """Run PILOTS separate episodes; return the values of the sensors whose bins are learned, by sensor name."""
    read: dict[str, list[float]] = {}
    plans = [EpisodePlan(each, drift) for each in episode_seeds(seed, "bins", PILOTS)]
    silent = Silent()
    for done, episode in enumerate(in_order(rollout, plans)):
        progress(done, PILOTS, "bins")
        run = sound(episode.result())
        silent.add(run)
        for name, values in run.values.items():
            read.setdefault(name, []).extend(values)
    return read


def run_episodes(
    rollout: Rollout,
    seeds: Sequence[int],
    drift: str | None,
    members: Members,
    progress: Progress,
    learner: str = "sarsa",
    enough: Callable[[Sequence[Sample]], bool] | None = None,
    footprint: Footprint | None = None,
) -> Recorded:
    """Run an instrumented episode per seed, until `enough` returns true.

    Raises:
        RecordingError: the test itself is broken, the node never waits, a sensor or the node is silent in all missions,
            or memory does not suffice for the episodes.
    """
    footprint = footprint or Footprint(len(seeds))
    learners = tuple(LEARNERS[learner](len(chosen)) for chosen in members)
    first: Trace | None = None
    simulator = False
    parameters: Mapping[str, bool | int | float] = {}
    samples: list[Sample] = []
    failures: list[str] = []
    notes: dict[str, None] = {}
    silent = Silent()
    topics: dict[str, str] = {}
    plans = (EpisodePlan(seed, drift, record=True) for seed in seeds)
    for done, (seed, episode) in enumerate(zip(seeds, in_order(rollout, plans), strict=True)):
        progress(done, len(seeds), drift or "episodes")
        run = sound(episode.result())
        if first is None:
            first, parameters = run.trace, run.parameters
        simulator = run.simulator
        silent.add(run)
        counted = sample(run.trace, seed, run.passed, members)
        samples.append(replace(counted, judgements=judgements(run.judged)))
        footprint.add(samples[-1])
        for one, chosen in zip(learners, members, strict=True):
            for sequence in event_sequences(run.trace, chosen):
                one.learn(sequence, run.trace.cells)
        failures += [] if run.passed else [run.failure]
        topics.update(run.topics)
        notes |= dict.fromkeys(run.notes)
        if enough is not None and enough(samples):
            break
    if first is None:
        raise RecordingError("There is nothing to learn from: 0 episodes were requested.")
    silent.check()
    notes |= dict.fromkeys([*silent.notes(), *([footprint.warning] if footprint.warning else [])])
    return Recorded(
        first, merge(samples), learners, topics, tuple(failures), learner, tuple(notes), simulator, parameters
    )


@dataclass
class Silent:
    """Missions in which a sensor or the node was silent: an error if these are all missions, otherwise a note."""

    episodes: int = 0
    found: list[str] = field(default_factory=list)

    def add(self, run: EpisodeRun) -> None:
        """Add a mission. Raise RecordingError if the first `SILENT` missions were all silent."""
        self.episodes += 1
        self.found += [run.silent] if run.silent else []
        if self.episodes == SILENT:
            self.check()

    def check(self) -> None:
        """Raise RecordingError if all missions so far were silent."""
        if self.found and len(self.found) == self.episodes:
            raise RecordingError(self.found[0])

    def notes(self) -> list[str]:
        """Return a note for each kind of silence; silent missions count like all others."""
        return [
            f"in {self.found.count(told)} of {self.episodes} missions, which count like the others: {told}"
            for told in dict.fromkeys(self.found)
        ]


def sound(run: EpisodeRun) -> EpisodeRun:
    """Return the run. Raise RecordingError if its node never waited, or if an error occurred outside the mission."""
    if run.stuck:
        raise RecordingError(f"Stopped at an episode (seed {run.plan.seed}) that did not end: {run.failure}")
    if run.broken:
        raise RecordingError(f"An episode (seed {run.plan.seed}) failed outside the mission:\n{run.broken}")
    return run


def sarsa_tables(recorded: Recorded, scales: Sequence[float]) -> tuple[Floats, ...]:
    """Return the learned table of each taint list, shape (cells, sites); `scales` has each list's mean flow F."""
    cells = recorded.sample.cells
    return tuple(one.table(cells, scale) for one, scale in zip(recorded.sarsa, scales, strict=True))


def mean_flows(offline: Sample) -> tuple[float, ...]:
    """Return the mean flow F of every taint list."""
    return tuple(one.mean_flow for one in offline.lists)


def identical(first: Trace, second: Trace) -> bool:
    """Return whether two traces are identical to the last bit."""
    pairs = [(getattr(first, f.name), getattr(second, f.name)) for f in fields(first)]
    return all(
        np.array_equal(a, b, equal_nan=True)
        if isinstance(a, np.ndarray) or isinstance(b, np.ndarray)
        else _plain(a) == _plain(b)
        for a, b in pairs
    )


def _plain(value: object) -> object:
    return {k: v.tolist() for k, v in value.items()} if isinstance(value, dict) else value


def _unfinished(failing: str, failures: Sequence[str], episodes: int) -> str:
    first = f" The first failure: {failures[0].rstrip('.')}." if failures else ""
    lower = ", or lower min_success on the marker" if len(failures) < episodes else ""
    return (
        f"{failing}, so the software does not yet work as designed, and no recording was written.{first} Fix the "
        f"node or the test{lower}."
    )


def _unjudged(formula: str, recorded: Sample) -> str:
    return (
        f"The formula {formula!r} can never be judged: its time bounds exceed the length of all {recorded.episodes} "
        "episodes, so no recording was written. Shorten its bounds, or run longer episodes."
    )


def _silent_lists(recorded: Sample, plan: Plan) -> list[str]:
    """Return a note for every taint list without a reached site."""
    silent = [
        number
        for number, one in enumerate(recorded.lists)
        if not one.visits.state.any()  # state 0 is the start of an episode, not a site
    ]
    return [_silent(plan.lists[number].name, forwarded=number in plan.forwarded) for number in silent]


def _silent(name: str, *, forwarded: bool) -> str:
    if forwarded:
        return (
            f"no statement runs when a message passes {name}, since the callback is the publish call itself: to "
            "record or repair it, publish in a function of the node"
        )
    return f"no step of {name} was executed: does the test drive that part of the node?"


def _previous(path: Path) -> tuple[Sample | None, tuple[str, ...]]:
    """Return the previous recording or None, and why it cannot be read if it exists.

    A folder at this path gives no reason: `check_writable` rejects it, because it cannot be replaced.
    """
    if path.is_dir():
        return None, ()
    try:
        return (fixtures.load(path).sample if os.path.lexists(path) else None), ()
    except FixtureError as problem:
        return None, (f"{problem.what} The new recording replaces it.",)


def _summary(new: Sample, old: Sample | None) -> str:
    before = f"{old.total.mean():.3g} → " if old is not None else ""
    return (
        f"recorded ATR {before}{new.total.mean():.3g}, success {percent(new.passed.mean())}, "
        f"{new.episodes} episodes, {len(new.cells)} cells"
    )
