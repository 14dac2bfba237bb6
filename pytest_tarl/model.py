"""The values that the stages of the plugin hand on: frozen, no pytest, no numpy at import."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Literal, NamedTuple

from pytest_tarl.sensors import Cell, Sensor

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Vector = NDArray[np.float64]
    Matrix = NDArray[np.float64]

Result = Literal["degraded", "drifted", "no difference"]
Reason = Literal[
    "",
    "no operand helps",
    "gain too small",
    "nominal gets worse",
    "budget",
    "time",
    "interrupted",
    "not confirmed",
    "worse than unrepaired",
    "another test gets worse",
    "not at its definition",
    "not over the whole range",
    "fails too often",
    "not shown",
    "cannot be written",
    "never tested",
    "a smaller step breaks it",
]


@dataclass(frozen=True, slots=True)
class SitePlace:
    """A site where it stands now: `id` is `str(tarl_lint.model.SiteId)`; lines count from 1."""

    id: str
    path: str
    line: int
    code: str
    dependence: str
    role: str
    qualname: str = ""


@dataclass(frozen=True, slots=True)
class TaintList:
    """The sites of one (source topic, sink topic) pair in order; a site's index is its *n* in this list."""

    source: str
    sink: str
    sites: tuple[SitePlace, ...]

    @property
    def name(self) -> str:
        """Name the list for people: `/odom → /cmd_vel`."""
        return f"{self.source} → {self.sink}"


@dataclass(frozen=True, slots=True)
class Conjunct:
    """One condition of a guard: `low <= sensor <= high`. Either end may be infinite; equal ends test a category."""

    sensor: Sensor
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Guard:
    """When a mutation holds: all conjuncts, at most two; none means always."""

    conjuncts: tuple[Conjunct, ...] = ()


@dataclass(frozen=True, slots=True)
class Region:
    """Where the on-line world differs: cells that on-line episodes were in, and among them those never seen off-line.

    `left` are cells of which on-line episodes differ by not being there. Where all on-line cells are new, `without` are
    the sensors, by place, that were left out so that something could be compared.
    """

    cells: tuple[Cell, ...] = ()
    novel: tuple[Cell, ...] = ()
    left: tuple[Cell, ...] = ()
    without: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Bound:
    """One-sided bounds of a quantity, each at the confidence; infinite where too little was seen.

    `exact` tells whether they hold at least as often as stated, whatever the distribution (learning/bounds.py).
    """

    low: float
    high: float
    confidence: float
    method: str
    exact: bool
    episodes: int


@dataclass(frozen=True, slots=True)
class Guarantee:
    """What is stated of the next episodes of a world, from `episodes` of which `passed` did; each bound by itself.

    At least 1 - `share` of the episodes earn `quantile` or more; it is None where they are too few, of the `needed`
    ones, and where their number was decided by what they showed (`needed` is 0). Where none of them differ from each
    other they have not `varied`, and tell of one world only.
    """

    episodes: int
    passed: int
    success: Bound
    average: float
    mean: Bound
    share: float
    quantile: float | None
    needed: int
    varied: bool
    declared: tuple[float, float] | None = None  # between which every total lies, where the marker says so


class LossInterval(NamedTuple):
    """The losses per episode that what was seen leaves possible; infinite ends where too little was seen."""

    low: float
    high: float
    confidence: float
    exact: bool = False


@dataclass(frozen=True, slots=True)
class Verdict:
    """What the comparison concludes. `loss` and `detectable_loss` are rewards per episode."""

    result: Result
    p_drift: float
    p_loss: float
    loss: float
    detectable_loss: float
    tolerance: float
    interval: LossInterval | None = None


@dataclass(frozen=True, slots=True)
class Slice:
    """Eq. 2 at one site: utility summed over the region, off-line and on-line."""

    site: SitePlace
    list_name: str
    offline: float
    online: float

    @property
    def difference(self) -> float:
        """Return on-line minus off-line; negative where the site is worth less than designed."""
        return self.online - self.offline


@dataclass(frozen=True, slots=True)
class OperandEffect:
    """What simulation found out about one operand: its best value and the reward it gains per episode."""

    code: str
    value: float | None
    best: float
    effect: float
    factor: bool = False  # `best` multiplies the use instead of replacing it


@dataclass(frozen=True, slots=True)
class Culprit:
    """A ranked site. `method` is `slices` where nothing was simulated for it."""

    site: SitePlace
    score: float
    method: str
    operands: tuple[OperandEffect, ...] = ()


@dataclass(frozen=True, slots=True)
class Edit:
    """One repaired operand: where, its text, and the value it takes under the guard, or the factor on it."""

    path: str
    line: int
    code: str
    value: float
    factor: bool = False
    what: str = ""  # what a change of structure does, in words


@dataclass(frozen=True, slots=True)
class Attempt:
    """A candidate that came near, and what became of it; `reason` is empty for the one that was accepted.

    `mean` is its reward per episode over `episodes`, which were `fresh` where nothing had been chosen by them.
    """

    what: str
    reason: Reason
    mean: float
    episodes: int
    fresh: bool


@dataclass(frozen=True, slots=True)
class Partial:
    """A change that helps and is no repair: rewards an episode over the program as it is, on fresh seeds.

    `low` and `designed_low` are lower bounds; `patch` is a path below the root.
    """

    what: str
    gain: float
    low: float
    lost: float
    designed: float
    designed_low: float
    confidence: float
    diff: str
    patch: str


@dataclass(frozen=True, slots=True)
class Repair:
    """What the search ended with. `guard` is Python as written in the patch; `diff` is empty when not accepted.

    `mean` is the reward per episode of what was refused, in `episodes`; `history` is what was tried, in order.
    """

    accepted: bool
    guard: str
    edits: tuple[Edit, ...]
    diff: str = ""
    patch: str = ""  # path of the patch file, relative to the root
    reason: Reason = ""
    mean: float | None = None
    episodes: int = 0
    history: tuple[Attempt, ...] = ()
    partial: Partial | None = None  # where none was accepted


@dataclass(frozen=True, slots=True)
class Band:
    """A part of the range that a drift is drawn from; `part` names the range in a dictionary, else it is empty."""

    part: str
    low: float
    high: float

    def __str__(self) -> str:
        """Write it for people: `mud 0.1 to 0.27`."""
        return f"{self.part or 'sizes'} {self.low:.3g} to {self.high:.3g}"


@dataclass(frozen=True, slots=True)
class Sizes:
    """A range and what was drawn from it: by world, aligned with its totals."""

    part: str
    low: float
    high: float
    of: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    BANDS = 3

    @property
    def bands(self) -> tuple[Band, ...]:
        """Return the range in equal parts."""
        ends = [self.low + (self.high - self.low) * at / self.BANDS for at in range(self.BANDS)] + [self.high]
        return tuple(Band(self.part, low, high) for low, high in pairwise(ends))


@dataclass(frozen=True, slots=True)
class SearchTrace:
    """Average-total-reward curve of one search: `totals[i]` is the reward of its i-th episode, `labels[i]` what ran."""

    method: str
    totals: tuple[float, ...]
    labels: tuple[str, ...] = ()


@dataclass(frozen=True)
class ListComparison:
    """One taint list under both worlds. Arrays have shape (cells, sites); NaN where never visited."""

    taint_list: TaintList
    offline: Matrix
    online: Matrix
    slices: tuple[Slice, ...]


@dataclass(frozen=True, slots=True)
class FormulaWorld:
    """A formula in one world: mean and least robustness, in how many episodes it was judged and violated.

    `first` is the earliest time in an episode at which it was violated, in s.
    """

    robustness: float
    least: float
    episodes: int
    violated: int
    first: float | None


@dataclass(frozen=True)
class FormulaRow:
    """What a formula came to by world: offline, online, repaired, nominal_repaired."""

    formula: str
    worlds: Mapping[str, FormulaWorld]


@dataclass(frozen=True)
class Comparison:
    """Everything that an on-line run found: what terminal, JSON result and report page are made from."""

    test: str
    drift: str | None
    seed: int
    sensors: tuple[Sensor, ...]
    cells: tuple[Cell, ...]  # rows of the matrices below, sorted
    lists: tuple[ListComparison, ...]
    verdict: Verdict
    region: Region
    paper_region: tuple[Cell, ...]
    totals: Mapping[str, tuple[float, ...]]  # reward per episode: offline, online, repaired, nominal_repaired
    culprits: tuple[Culprit, ...] = ()
    searches: tuple[SearchTrace, ...] = ()
    repair: Repair | None = None
    notes: tuple[str, ...] = ()
    ranking: str = ""  # how certain the order of the culprits is
    parts: Mapping[str, tuple[float, float]] = field(default_factory=dict)  # part → mean off-line, on-line
    lost: Mapping[str, tuple[Cell, ...]] = field(default_factory=dict)  # part → where it earns less on-line
    target: str = ""  # the test as it is typed where pytest was started
    flags: tuple[str, ...] = ()  # options of the run that are not the default ones
    changes: Mapping[Cell, float] = field(default_factory=dict)  # how far on-line differs, by cell
    stated: Mapping[str, Guarantee] = field(default_factory=dict)  # of the worlds that `totals` names
    formulas: tuple[FormulaRow, ...] = ()
    sizes: Mapping[str, Sizes] = field(default_factory=dict)  # by part of the drift, where it has a range
    purpose: str = ""  # what the test is for and what earns reward: the first paragraph of its docstring
    permanent: bool = False  # whether the drift is for good, so that the designed world is the old one
