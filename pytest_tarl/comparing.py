"""`--tarl-online`: run the test in the deployed world and compare it with the recording."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from math import ceil

import numpy as np

from pytest_tarl import remarks, seeds
from pytest_tarl.bagged import bagged
from pytest_tarl.designation import Designation
from pytest_tarl.drifts import sizes as drawn_sizes
from pytest_tarl.errors import FixtureError
from pytest_tarl.instrumentation.sites import Plan
from pytest_tarl.learning import judgements, localize, reward_parts
from pytest_tarl.learning.bounds import Range
from pytest_tarl.learning.drift import Difference, compare, paper_region
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.footprint import Footprint
from pytest_tarl.learning.marginal import lent
from pytest_tarl.learning.merging import aligned, merge
from pytest_tarl.learning.packing import represented
from pytest_tarl.learning.permutation import permutations_for
from pytest_tarl.learning.sarsa import LEARNERS
from pytest_tarl.learning.sequential import Look, certain, concluded, planned
from pytest_tarl.learning.spending import Stage
from pytest_tarl.learning.tables import Floats, Ints, Sample
from pytest_tarl.learning.tiles import tiled, tiled_batch
from pytest_tarl.logged import read_log
from pytest_tarl.model import Comparison, FormulaRow, ListComparison, Region, Sizes, TaintList
from pytest_tarl.options import Options
from pytest_tarl.recording import Progress, Recorded, Tell, mean_flows, repeated, run_episodes, sarsa_tables
from pytest_tarl.rollout import EpisodePlan, Rollout
from pytest_tarl.seeds import episode_seeds
from pytest_tarl.sensors import Cell, Sensor
from pytest_tarl.settling import within

Tables = tuple[
    Floats, Floats
]  # a taint list's utilities in the designed and in the deployed world, each of shape (cells, sites)


@dataclass(frozen=True)
class Online:
    """The result of a comparison, the deployed world's sample, and its Sarsa tables."""

    comparison: Comparison
    recorded: Recorded
    sarsa: tuple[Floats, ...]
    # for each look at the verdict: number of episodes, and uncorrected p-value of a decrease
    looks: tuple[tuple[int, float], ...] = ()
    decided: bool = False  # whether the last look has made the verdict final


def run_online(
    rollout: Rollout,
    fixture: Fixture,
    designation: Designation,
    options: Options,
    plan: Plan,
    drift: str | None,
    progress: Progress,
    changeable: Collection[str] | None = None,
    tell: Tell | None = None,
    stage: Stage | None = None,
) -> Online:
    """Run a scenario's episodes, or read the missions of a log, and compare them with the recording.

    `changeable` has the IDs of the sites with an operand that a repair can change, if known; these rank before all
    others. If `stage` is given, the comparison stops after it, and a later call may continue.
    """
    learner = _learner(fixture, options)
    side = _side(rollout, fixture, designation, options, plan, stage)
    looks = stage.looks if stage else planned(len(side.seeds), side.looks)
    rarest = ceil(1 / looks[0].share) if stage else options.comparisons
    watch = _Watch(fixture.sample, designation, options, looks, permutations_for(options.alpha, rarest))
    footprint = Footprint(len(side.seeds), tell) if tell else None
    members = current_members(fixture, plan)
    recorded = run_episodes(side.rollout, side.seeds, drift, members, progress, learner, watch, footprint)
    comparison, learned = _comparison(
        side, fixture, designation, options, plan, drift, changeable, recorded, watch
    )
    pairs = tuple((look.episodes, found.verdict.p_worse) for look, found in watch.seen)
    return Online(comparison, recorded, learned, pairs, certain(watch.seen[-1][1]))


def _comparison(
    side: _Side,
    fixture: Fixture,
    designation: Designation,
    options: Options,
    plan: Plan,
    drift: str | None,
    changeable: Collection[str] | None,
    recorded: Recorded,
    watch: _Watch,
) -> tuple[Comparison, tuple[Floats, ...]]:
    """Return the comparison of the deployed episodes with the recording, and their Sarsa tables."""
    difference = concluded(watch.seen, options.alpha)
    offline, online = aligned(fixture.sample, represented(recorded.sample))
    learned = sarsa_tables(recorded, mean_flows(fixture.sample))
    tables = _tables(fixture, options, recorded, learned, (offline, online), difference.region)
    near_half = _paper_cells(tables, offline.cells)
    lists = _compared(_current(fixture, plan), tables, _rows(difference.region, near_half, offline.cells))
    ranked = localize.prior((one.slices for one in lists), changeable)
    comparison = Comparison(
        test=fixture.test,
        drift=drift,
        seed=options.seed,
        sensors=fixture.sensors,
        cells=offline.cells,
        lists=lists,
        verdict=difference.verdict,
        region=difference.region,
        paper_region=near_half,
        totals={"offline": tuple(offline.total.tolist()), "online": tuple(online.total.tolist())},
        culprits=localize.culprits(ranked, {}, (), difference.verdict.loss),
        notes=(
            *_notes(side, drift, recorded, difference),
            *remarks.of_comparison(fixture, plan, offline, online, difference),
        ),
        parts=reward_parts.means(offline, online),
        lost=reward_parts.lost(offline, online, options.alpha, seeds.generator(options.seed, "parts")),
        changes=difference.changes,
        stated={"offline": fixture.stated} if fixture.stated is not None else {},
        formulas=_formulas(designation, offline, online),
        sizes=_sizes(designation, drift, recorded.sample.seeds),
        purpose=designation.purpose,
        permanent=drift is not None and designation.drifts[drift].permanent,
    )
    return comparison, learned


def _tables(
    fixture: Fixture,
    options: Options,
    recorded: Recorded,
    learned: Sequence[Floats],
    samples: tuple[Sample, Sample],
    region: Region,
) -> list[Tables]:
    """Return the utilities of each taint list in both worlds, learned or solved as the options say."""
    offline, online = samples
    if options.learner:
        tables = _learned_tables(fixture, recorded, learned, offline.cells)
    else:
        tables = _solved_tables(offline, online, fixture.sensors)
    return _lent(tables, offline, region.without) if region.without else tables


def _notes(side: _Side, drift: str | None, recorded: Recorded, difference: Difference) -> tuple[str, ...]:
    """Return what the user should know about the episodes."""
    again = EpisodePlan(side.seeds[0], drift, record=True)
    spread = repeated(side.rollout, again, recorded) if recorded.simulator else ()
    return (
        *remarks.failing(difference.verdict),
        *side.notes,
        *recorded.notes,
        *spread,
        *remarks.early(recorded.sample, len(side.seeds)),
    )


def _formulas(designation: Designation, offline: Sample, online: Sample) -> tuple[FormulaRow, ...]:
    """Return the results of the marker's formulas in both worlds."""
    texts = [one.text for one in designation.requirements.formulas]
    return judgements.rows(texts, {"offline": offline.judgements, "online": online.judgements})


def _lent(tables: Sequence[Tables], offline: Sample, without: Sequence[int]) -> list[Tables]:
    """Fill in unknown designed values from recorded cells that differ only in the sensors `without`."""
    return [
        (lent(before, one, offline.cells, without), after)
        for (before, after), one in zip(tables, offline.lists, strict=True)
    ]


def _sizes(designation: Designation, drift: str | None, drawn_by: Sequence[int]) -> dict[str, Sizes]:
    """Return each range of a drift, with the number that each episode drew from it; `drawn_by` has the seeds."""
    if drift is None:
        return {}
    whole = designation.drifts[drift]
    drawn = [drawn_sizes(whole, drift, seed) for seed in drawn_by]
    return {
        part: Sizes(part, span.low, span.high, {"online": tuple(one[part] for one in drawn)})
        for part, span in whole.spans.items()
    }


@dataclass(frozen=True)
class _Side:
    """Where the deployed episodes come from: seeds, maximum number of looks, and notes for the user."""

    rollout: Rollout
    seeds: Sequence[int]
    looks: int
    notes: tuple[str, ...] = ()


def _side(
    rollout: Rollout,
    fixture: Fixture,
    designation: Designation,
    options: Options,
    plan: Plan,
    stage: Stage | None,
) -> _Side:
    """Return where the episodes come from, according to the options: the test's own world, a log or bags."""
    if options.log is not None:
        logged = read_log(options.log, fixture, plan, designation.judge, designation.requirements)
        return _Side(logged, range(logged.count), 1, logged.notes)
    if options.bags:
        missions = bagged(rollout, fixture, designation, options)
        return _Side(missions, list(missions.bags), 1, missions.notes)
    count = stage.episodes if stage else options.episodes or options.ONLINE_EPISODES
    return _Side(rollout, episode_seeds(options.seed, "online", count), options.most_looks)


def _learner(fixture: Fixture, options: Options) -> str:
    """Return the recording's learning rule. Raise FixtureError if it is unknown or not the chosen one."""
    if fixture.learner not in LEARNERS:
        raise FixtureError(
            f"The recording of {fixture.test} holds a utility learned by {fixture.learner!r}, which this version of "
            "tarl does not support: record it again with `pytest --tarl-record`."
        )
    if options.learner not in ("", fixture.learner):
        raise FixtureError(
            f"The recording of {fixture.test} holds a utility learned by {fixture.learner}, not by "
            f"{options.learner}: record it again with `--tarl-record --tarl-utility={options.learner}`."
        )
    return fixture.learner


@dataclass
class _Watch:
    """Stopping rule: compare the worlds at each planned look; stop once the verdict is final."""

    offline: Sample
    designation: Designation
    options: Options
    looks: Sequence[Look]
    permutations: int
    seen: list[tuple[Look, Difference]] = field(default_factory=list)

    def __call__(self, samples: Sequence[Sample]) -> bool:
        within(samples[-1], self.designation.total_range)
        look = next((one for one in self.looks if one.episodes == len(samples)), None)
        if look is None:
            return False
        difference = compare(
            self.offline,
            merge(samples),
            alpha=self.options.alpha * look.share,
            tolerance=self.designation.tolerance,
            declared=Range(*self.designation.total_range) if self.designation.total_range else None,
            sensors=self.designation.sensors,
            generator=seeds.generator(self.options.seed, "compare"),
            permutations=self.permutations,
        )
        self.seen.append((look, difference))
        return certain(difference)


def current_members(fixture: Fixture, plan: Plan) -> tuple[tuple[int, ...], ...]:
    """Return, for each taint list, the current number of each recorded site; -1 if it no longer exists."""
    number = {place.id: n for n, place in enumerate(plan.places)}
    return tuple(tuple(number.get(site.id, -1) for site in one.sites) for one in fixture.lists)


def _current(fixture: Fixture, plan: Plan) -> list[TaintList]:
    places = {place.id: place for place in plan.places}
    return [
        TaintList(one.source, one.sink, tuple(places.get(site.id, site) for site in one.sites))
        for one in fixture.lists
    ]


def _solved_tables(offline: Sample, online: Sample, sensors: Sequence[Sensor]) -> list[Tables]:
    """Return the batch solution for each taint list in both worlds, of shape (cells, sites).

    Both samples must have the same cells.
    """
    cells, tiles = len(offline.cells), tiled(offline.cells, sensors)
    return [
        (tiled_batch(before, cells, scale, tiles), tiled_batch(after, cells, scale, tiles))
        for before, after, scale in zip(offline.lists, online.lists, mean_flows(offline), strict=True)
    ]


def _learned_tables(
    fixture: Fixture, recorded: Recorded, learned: Sequence[Floats], cells: Sequence[Cell]
) -> list[Tables]:
    """Return the learned tables of each taint list in both worlds, shape (cells, sites), with rows for `cells`."""
    return [
        (_spread(before, fixture.sample.cells, cells), _spread(after, recorded.sample.cells, cells))
        for before, after in zip(fixture.sarsa, learned, strict=True)
    ]


def _compared(
    lists: Sequence[TaintList], tables: Sequence[tuple[Floats, Floats]], rows: Ints
) -> tuple[ListComparison, ...]:
    """Return all taint lists that still have sites, each with its tables and their sums over `rows`."""
    return tuple(
        ListComparison(one, before, after, localize.slices(one, before, after, rows))
        for one, (before, after) in zip(lists, tables, strict=True)
        if one.sites
    )


def _spread(table: Floats, rows: Sequence[Cell], cells: Sequence[Cell]) -> Floats:
    """Return a table with rows for `cells` instead of `rows`; missing cells are NaN."""
    place = {cell: i for i, cell in enumerate(cells)}
    wide = np.full((len(cells), table.shape[1]), np.nan)
    wide[[place[cell] for cell in rows]] = table
    return wide


def _paper_cells(tables: Sequence[tuple[Floats, Floats]], cells: Sequence[Cell]) -> tuple[Cell, ...]:
    """Return the paper's region: cells where a utility differs by at least half of its list's largest difference."""
    rows: set[int] = set()
    for before, after in tables:
        rows.update(paper_region(before, after).tolist())
    return tuple(cells[row] for row in sorted(rows))


def _rows(region: Region, otherwise: Sequence[Cell], cells: Sequence[Cell]) -> Ints:
    """Return the rows that Eq. 2 sums over: the region or, if it is empty, the paper's region."""
    chosen = {*region.cells, *region.novel} or set(otherwise)
    return np.array([i for i, cell in enumerate(cells) if cell in chosen], dtype=np.int64)
