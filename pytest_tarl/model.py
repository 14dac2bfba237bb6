"""The values passed between the stages of the plugin: frozen, no pytest, no numpy at import."""

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
    "breaks other missions",
]


@dataclass(frozen=True, slots=True)
class SitePlace:
    """The current place of a site: `id` is `str(tarl_lint.model.SiteId)`; lines count from 1."""

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
        """Return the displayed name of the list: `/odom → /cmd_vel`."""
        return f"{self.source} → {self.sink}"


@dataclass(frozen=True, slots=True)
class Conjunct:
    """One condition of a guard: `low <= sensor <= high`. Either end may be infinite; equal ends select a category."""

    sensor: Sensor
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Guard:
    """The condition of a mutation: the conjunction of at most two conjuncts; always true if there are none."""

    conjuncts: tuple[Conjunct, ...] = ()


@dataclass(frozen=True, slots=True)
class Region:
    """The region of a difference: cells that deployed episodes visited, and which of them the recording lacks.

    `left` are recorded cells that deployed episodes avoid. If all deployed cells are new, `without` are the indices
    of the sensors left out so that cells can be compared.
    """

    cells: tuple[Cell, ...] = ()
    novel: tuple[Cell, ...] = ()
    left: tuple[Cell, ...] = ()
    without: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Bound:
    """One-sided bounds of a quantity, each at the stated confidence; infinite if there are too few episodes.

    `exact` is true if they have the stated coverage for every distribution (learning/bounds.py).
    """

    low: float
    high: float
    confidence: float
    method: str
    exact: bool
    episodes: int


@dataclass(frozen=True, slots=True)
class Guarantee:
    """Bounds on future episodes of a world, from `passed` successes in `episodes` episodes; each holds separately.

    At least 1 - `share` of the episodes earn `quantile` or more. It is None if there are fewer than `needed` episodes,
    or if their number depended on their results (`needed` is 0). `varied` is false if all episodes are equal: then
    they sample one world only.
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
    declared: tuple[float, float] | None = None  # the marker's bounds on every total, if given


class LossInterval(NamedTuple):
    """Confidence interval of the loss per episode; its ends are infinite if there are too few episodes."""

    low: float
    high: float
    confidence: float
    exact: bool = False


@dataclass(frozen=True, slots=True)
class Verdict:
    """The verdict of a comparison. `loss` and `detectable_loss` are rewards per episode."""

    result: Result
    p_drift: float
    p_loss: float
    loss: float
    detectable_loss: float
    tolerance: float
    interval: LossInterval | None = None


@dataclass(frozen=True, slots=True)
class Slice:
    """Eq. 2 at one site: utility summed over the region, in the designed and in the deployed world."""

    site: SitePlace
    list_name: str
    offline: float
    online: float

    @property
    def difference(self) -> float:
        """Return deployed minus designed utility; negative if the site is worth less than designed."""
        return self.online - self.offline


@dataclass(frozen=True, slots=True)
class OperandEffect:
    """The simulated effect of one operand: its best value and the reward it gains per episode."""

    code: str
    value: float | None
    best: float
    effect: float
    factor: bool = False  # `best` multiplies the use instead of replacing it


@dataclass(frozen=True, slots=True)
class Culprit:
    """A ranked site. `method` is `slices` if no operand of it was simulated."""

    site: SitePlace
    score: float
    method: str
    operands: tuple[OperandEffect, ...] = ()


@dataclass(frozen=True, slots=True)
class Edit:
    """One repaired operand: its place, its text, and the value that it takes under the guard, or the factor on it."""

    path: str
    line: int
    code: str
    value: float
    factor: bool = False
    what: str = ""  # description of a change of structure


@dataclass(frozen=True, slots=True)
class Attempt:
    """A promising candidate and its outcome; `reason` is empty for the accepted one.

    `mean` is its reward per episode over `episodes`; `fresh` ones were not used to choose it.
    """

    what: str
    reason: Reason
    mean: float
    episodes: int
    fresh: bool


@dataclass(frozen=True, slots=True)
class Partial:
    """A change that helps but is not a repair: reward gained per episode over the unchanged program, on fresh seeds.

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
    """The result of the search. `guard` is the Python condition of the patch; `diff` is empty unless accepted.

    `mean` is the reward per episode of the rejected candidate over `episodes`; `history` lists the attempts in order.
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
    partial: Partial | None = None  # set only if no repair was accepted


@dataclass(frozen=True, slots=True)
class Band:
    """An interval of a drift's range; `part` names the range in a dictionary, else it is empty."""

    part: str
    low: float
    high: float

    def __str__(self) -> str:
        """Return the displayed text: `mud 0.1 to 0.27`."""
        return f"{self.part or 'sizes'} {self.low:.3g} to {self.high:.3g}"


@dataclass(frozen=True, slots=True)
class Sizes:
    """A range and the numbers drawn from it, by world, aligned with the totals."""

    part: str
    low: float
    high: float
    of: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    BANDS = 3

    @property
    def bands(self) -> tuple[Band, ...]:
        """Divide the range into equal intervals."""
        ends = [self.low + (self.high - self.low) * at / self.BANDS for at in range(self.BANDS)] + [self.high]
        return tuple(Band(self.part, low, high) for low, high in pairwise(ends))


@dataclass(frozen=True, slots=True)
class SearchTrace:
    """Learning curve of one search: `totals[i]` is the total reward of its i-th episode, `labels[i]` its candidate."""

    method: str
    totals: tuple[float, ...]
    labels: tuple[str, ...] = ()


@dataclass(frozen=True)
class ListComparison:
    """One taint list in both worlds. Arrays have shape (cells, sites); NaN for cells never visited."""

    taint_list: TaintList
    offline: Matrix
    online: Matrix
    slices: tuple[Slice, ...]


@dataclass(frozen=True, slots=True)
class FormulaWorld:
    """A formula in one world: mean and least robustness, and the numbers of episodes that judged it and violated it.

    `first` is the earliest time of a violation in an episode, in s.
    """

    robustness: float
    least: float
    episodes: int
    violated: int
    first: float | None


@dataclass(frozen=True)
class FormulaRow:
    """The results of a formula by world: offline, online, repaired, nominal_repaired."""

    formula: str
    worlds: Mapping[str, FormulaWorld]


@dataclass(frozen=True)
class Comparison:
    """The result of a comparison, shown by the terminal, the JSON file and the report page."""

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
    ranking: str = ""  # confidence in the order of the culprits
    parts: Mapping[str, tuple[float, float]] = field(
        default_factory=dict
    )  # part → mean, designed and deployed
    lost: Mapping[str, tuple[Cell, ...]] = field(
        default_factory=dict
    )  # part → cells where deployed earns less
    target: str = ""  # the test as the argument of pytest that records it
    node: str = ""  # the same for a comparison, if the test has parameters besides its scenario
    flags: tuple[str, ...] = ()  # non-default options of the run
    changes: Mapping[Cell, float] = field(default_factory=dict)  # difference between the worlds, by cell
    stated: Mapping[str, Guarantee] = field(default_factory=dict)  # guarantees, by the worlds of `totals`
    formulas: tuple[FormulaRow, ...] = ()
    sizes: Mapping[str, Sizes] = field(default_factory=dict)  # sizes of a drift with ranges, by its parts
    purpose: str = ""  # purpose and reward of the test: the first paragraph of its docstring
    permanent: bool = False  # whether the drift is permanent, so that the designed world is the old one
