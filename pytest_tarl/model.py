"""The values passed between the plugin's stages, as frozen dataclasses; this module needs no pytest or numpy."""

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
Decreased = Literal["reward", "success"]
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
    """A site, which is a statement to record; `id` is `str(tarl_lint.model.SiteId)`, and lines count from 1."""

    id: str
    path: str
    line: int
    code: str
    dependence: str
    role: str
    qualname: str = ""


@dataclass(frozen=True, slots=True)
class TaintList:
    """The sites between a source and a sink topic, in order; a site's index is its *n* in the paper."""

    source: str
    sink: str
    sites: tuple[SitePlace, ...]

    @property
    def name(self) -> str:
        """Return the list's name as displayed, such as `/odom → /cmd_vel`."""
        return f"{_end(self.source)} → {_end(self.sink)}"


def _end(topic: str) -> str:
    """Return a topic; an unknown one is named after its call, `(call at path:line)`."""
    call, separator, place = topic.removesuffix(")").partition(" at ")
    return f"unknown topic at {place.rpartition('/')[2]}" if separator and call.startswith("(") else topic


@dataclass(frozen=True, slots=True)
class Conjunct:
    """A condition of a guard: `low <= sensor <= high`. Ends may be infinite; equal ends select one category."""

    sensor: Sensor
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Guard:
    """The condition for a mutation: up to two conditions joined by `and`; without any, always true."""

    conjuncts: tuple[Conjunct, ...] = ()


@dataclass(frozen=True, slots=True)
class Region:
    """The cells in which the worlds differ.

    Deployed episodes visited `cells`, which are in the recording, and `novel`, which are not. They avoid the recorded
    cells in `left`.

    If all deployed cells are new, the comparison ignores some sensors, so that deployed cells match recorded ones;
    `without` has the indices of these sensors.
    """

    cells: tuple[Cell, ...] = ()
    novel: tuple[Cell, ...] = ()
    left: tuple[Cell, ...] = ()
    without: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Bound:
    """A lower and an upper bound, each at the stated confidence; infinite if there are too few episodes.

    `exact` means that the confidence holds for every distribution (learning/bounds.py).
    """

    low: float
    high: float
    confidence: float
    method: str
    exact: bool
    episodes: int


@dataclass(frozen=True, slots=True)
class Guarantee:
    """Bounds for future episodes of a world, given `passed` successes in `episodes` episodes.

    The confidence is that of each single bound. At least 1 - `share` of the future episodes earn `quantile` or more.
    `quantile` is None if there are fewer than `needed` episodes. It is also None if the number of episodes depended on
    their results; `needed` is then 0. `varied` is false if all episodes are equal, because they then show only a single
    world.
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
    declared: tuple[float, float] | None = None  # the marker's limits for every total, if given


class LossInterval(NamedTuple):
    """Confidence interval of the loss per episode; infinite if there are too few episodes."""

    low: float
    high: float
    confidence: float
    exact: bool = False


@dataclass(frozen=True, slots=True)
class Verdict:
    """The verdict of a comparison; `loss` and `detectable_loss` are rewards per episode.

    `success` has the success rates in the recording and in the deployed world, and `p_failures` is the p-value of its
    decrease. `because` says what is worse if the result is "degraded".
    """

    result: Result
    p_drift: float
    p_loss: float
    loss: float
    detectable_loss: float
    tolerance: float
    interval: LossInterval | None = None
    p_failures: float = 1.0
    success: tuple[float, float] = (1.0, 1.0)
    because: tuple[Decreased, ...] = ()

    @property
    def p_worse(self) -> float:
        """Return the p-value for the deployed world being no worse, in reward and in success."""
        return min(self.p_loss, self.p_failures)

    @property
    def failures_only(self) -> bool:
        """Return whether more missions fail, although no loss of reward was found."""
        return self.because == ("success",)


@dataclass(frozen=True, slots=True)
class Slice:
    """Eq. 2 at a site: its utility summed over the region, in the designed and in the deployed world."""

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
    """The simulated effect of an operand: its best value, and the reward gained per episode."""

    code: str
    value: float | None
    best: float
    effect: float
    factor: bool = False  # whether `best` is a factor for the operand instead of its new value
    # description of an operand that follows a sensor or a variable, for which `best` is the exponent; otherwise ""
    what: str = ""


@dataclass(frozen=True, slots=True)
class Culprit:
    """A ranked site. `method` is `slices` if none of its operands was changed in simulation."""

    site: SitePlace
    score: float
    method: str
    operands: tuple[OperandEffect, ...] = ()


@dataclass(frozen=True, slots=True)
class Edit:
    """A repaired operand. While the guard holds, `value` replaces it or, with `factor`, multiplies it."""

    path: str
    line: int
    code: str
    value: float
    factor: bool = False
    what: str = ""  # description if the edit changes the structure instead of an operand


@dataclass(frozen=True, slots=True)
class Attempt:
    """A promising candidate and its outcome; `reason` says why it was rejected, and is empty if it was not.

    `mean` is its mean reward in `episodes` episodes. `fresh` is true if these episodes were not used to choose it.
    """

    what: str
    reason: Reason
    mean: float
    episodes: int
    fresh: bool


@dataclass(frozen=True, slots=True)
class Partial:
    """A helpful change that was not accepted. `gain` is the reward that it gains per episode, on fresh seeds.

    `low` and `designed_low` are lower bounds of the gain in the two worlds; `patch` is a path below the root.
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
    """The result of a repair search. `guard` is the patch's Python condition; `diff` is empty without a repair.

    `mean` is the rejected candidate's mean reward in `episodes` episodes; `history` lists the attempts in order.
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
    partial: Partial | None = None  # None if a repair was accepted


@dataclass(frozen=True, slots=True)
class Band:
    """An interval of a drift's range. `part` is the key of the range in a dictionary of drifts, or empty."""

    part: str
    low: float
    high: float

    def __str__(self) -> str:
        """Return the displayed text, such as `mud 0.1 to 0.27`."""
        return f"{self.part or 'sizes'} {self.low:.3g} to {self.high:.3g}"


@dataclass(frozen=True, slots=True)
class Sizes:
    """A drift's range, and the numbers drawn from it in each world: one per episode, in the order of the totals."""

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
    """Learning curve of a search: `totals[i]` is the reward of its i-th episode, `labels[i]` the candidate."""

    method: str
    totals: tuple[float, ...]
    labels: tuple[str, ...] = ()


@dataclass(frozen=True)
class ListComparison:
    """A taint list in both worlds. Matrices have shape (cells, sites), with NaN for unvisited cells."""

    taint_list: TaintList
    offline: Matrix
    online: Matrix
    slices: tuple[Slice, ...]


@dataclass(frozen=True, slots=True)
class FormulaWorld:
    """A formula in one world: mean and lowest robustness, and numbers of judged and violated episodes.

    `first` is when the earliest violation occurred, in s from the start of its episode.
    """

    robustness: float
    least: float
    episodes: int
    violated: int
    first: float | None


@dataclass(frozen=True)
class FormulaRow:
    """The results of a formula, by world: offline, online, repaired, nominal_repaired."""

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
    totals: Mapping[str, tuple[float, ...]]  # rewards by episode: offline, online, repaired, nominal_repaired
    culprits: tuple[Culprit, ...] = ()
    searches: tuple[SearchTrace, ...] = ()
    repair: Repair | None = None
    notes: tuple[str, ...] = ()
    ranking: str = ""  # sentence on how certain the ranking of the culprits is
    parts: Mapping[str, tuple[float, float]] = field(
        default_factory=dict
    )  # part of the reward → its means in the designed and the deployed world
    lost: Mapping[str, tuple[Cell, ...]] = field(
        default_factory=dict
    )  # part of the reward → cells where it is lower in the deployed world
    target: str = ""  # the pytest argument that records this test
    # the pytest argument for this comparison, if the test has parameters other than the drift
    node: str = ""
    flags: tuple[str, ...] = ()  # non-default options of the run
    changes: Mapping[Cell, float] = field(default_factory=dict)  # cell → difference between the worlds
    stated: Mapping[str, Guarantee] = field(default_factory=dict)  # guarantees, by the worlds of `totals`
    formulas: tuple[FormulaRow, ...] = ()
    sizes: Mapping[str, Sizes] = field(
        default_factory=dict
    )  # key in a dictionary of drifts → sizes drawn from its range
    purpose: str = ""  # purpose and reward of the test: the first paragraph of its docstring
    permanent: bool = False  # whether the world has changed for good
