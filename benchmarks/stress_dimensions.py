"""Search four directions for the nearest failing drift, by a stress run and by other searches of equal cost.

    python benchmarks/stress_peers/install.sh                       # once: Ψ-TaLiRo and STGEM, an environment each
    python benchmarks/stress_dimensions.py --harmless 100           # false failures
    python benchmarks/stress_dimensions.py quiet_tank quiet_quadrotor --harmless 100
    python benchmarks/stress_dimensions.py quiet_gripper quiet_dish --harmless 100
    python benchmarks/stress_dimensions.py [TASK ...] [--seeds 20] [--methods ours confirmed random …]

The worlds of stress_worlds.py and stress_worlds_2.py are formulas. Those of stress_worlds_3.py to stress_worlds_14.py
are small simulations, written without knowledge of the search. From stress_worlds_5.py on, drifts have units, and the
nominal value can be anywhere in its range. Each task of benchmarks/drift has four directions: its own drift, from the
nominal value to the task's, and three faults on the topic of its first numeric sensor (bias, latency, dropout), of the
same relative size in every task.

Each method may run BUDGET episodes. The other methods, the peers, get a cost for each drift that they propose. If the
guarantee fails on PROBES common seeds, the cost is the distance from nominal, as a share of the largest distance.
Otherwise it is 1 plus the margin by which the guarantee holds.

A failure counts only if fresh seeds confirm it; episodes on these seeds are not part of BUDGET. Each method may offer
its OFFERS nearest failing drifts, the k-th of which is tested at level RISK / k(k + 1). A stress run offers the drifts
that it confirmed within its budget, and those that it only expects to fail. The method `confirmed` offers only the
confirmed drifts of the same run. A cell of the table counts the seeds for which `ours` and `confirmed` find a failure
that is at least as near as the peer's.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from select import select
from statistics import fmean, median
from subprocess import DEVNULL, PIPE, Popen
from time import monotonic
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "drift"), str(HERE)]

from drift_sizes import nominal_of  # noqa: E402
from peers import Cma  # noqa: E402
from stage import TASKS, Stage, visit  # noqa: E402
from stress_machines import Machine  # noqa: E402
from stress_worlds import TOLERANCE, WORLDS, Formula, World, harmless  # noqa: E402
from stress_worlds import space as world_space  # noqa: E402
from stress_worlds_2 import FRESH_WORLDS  # noqa: E402
from stress_worlds_3 import NEW_WORLDS  # noqa: E402
from stress_worlds_4 import FOURTH_WORLDS, QUIET_WORLDS  # noqa: E402
from stress_worlds_5 import MACHINES as FIFTH_MACHINES  # noqa: E402
from stress_worlds_6 import QUIET_MACHINES, SIXTH_MACHINES  # noqa: E402
from stress_worlds_7 import SEVENTH_MACHINES  # noqa: E402
from stress_worlds_8 import EIGHTH_MACHINES  # noqa: E402
from stress_worlds_9 import NINTH_MACHINES  # noqa: E402
from stress_worlds_10 import TENTH_MACHINES  # noqa: E402
from stress_worlds_11 import ELEVENTH_MACHINES  # noqa: E402
from stress_worlds_12 import TWELFTH_MACHINES, TWELFTH_QUIET  # noqa: E402
from stress_worlds_13 import THIRTEENTH_MACHINES, THIRTEENTH_QUIET  # noqa: E402
from stress_worlds_14 import FOURTEENTH_MACHINES  # noqa: E402

from pytest_tarl import faults  # noqa: E402
from pytest_tarl.designation import Designation  # noqa: E402
from pytest_tarl.drifts import Drift  # noqa: E402
from pytest_tarl.rollout import EpisodePlan, Rollout  # noqa: E402
from pytest_tarl.seeds import episode_seeds, generator  # noqa: E402
from pytest_tarl.spaces import Choice, Point, Space, Span, nominal  # noqa: E402
from pytest_tarl.stressing.combinations import Together  # noqa: E402
from pytest_tarl.stressing.evaluating import BudgetSpentError, Evaluator  # noqa: E402
from pytest_tarl.stressing.findings import Curve, confirmed, farther  # noqa: E402
from pytest_tarl.stressing.guarantee import Guarantee, guaranteed, outcome  # noqa: E402
from pytest_tarl.stressing.rays import distance, rays  # noqa: E402
from pytest_tarl.stressing.stress_run import divided, explore  # noqa: E402

FORMULAS = {**WORLDS, **FRESH_WORLDS, **NEW_WORLDS, **FOURTH_WORLDS}
MACHINES = {
    **FIFTH_MACHINES,
    **SIXTH_MACHINES,
    **SEVENTH_MACHINES,
    **EIGHTH_MACHINES,
    **NINTH_MACHINES,
    **TENTH_MACHINES,
    **ELEVENTH_MACHINES,
    **TWELFTH_MACHINES,
    **THIRTEENTH_MACHINES,
    **FOURTEENTH_MACHINES,
}
HARMLESS: Mapping[str, World | Machine] = {  # worlds in which no point of the space breaks the guarantee
    "harmless": harmless,
    **QUIET_WORLDS,
    **QUIET_MACHINES,
    **TWELFTH_QUIET,
    **THIRTEENTH_QUIET,
}
BUDGET = 600  # maximum number of episodes per run
PROBES = 4  # episodes at each drift that a peer proposes
OFFERS = 10  # maximum number of a method's failing drifts to test on fresh seeds
RECORDED = 100
RISK = 0.05  # risk of the test on fresh seeds
SIZES = (16, 32, 64)  # numbers of fresh episodes after which the test may end with success
SIZE = "size"
SCENARIO = "stress"
LARGEST = 2.0  # upper limit of distances; in four directions, no drift is farther from nominal
FORMULA = Designation(
    (), (), min_success=0.95, tolerance=TOLERANCE
)  # marker arguments of the worlds that are formulas
# the results of a stress run: all failing drifts, and only the confirmed ones
OWN = ("ours", "confirmed")
PEERS = {"Ψ-TaLiRo": "psy_taliro_peer.py", "STGEM": "stgem_peer.py"}


class Numbered(Space):
    """A space for a test whose drift is a single number, as in benchmarks/drift."""

    def world(self, point: Point) -> Any:
        """Return the value of the task's own drift."""
        extent = self.directions[SIZE]
        assert isinstance(extent, Span)
        return point[SIZE]


@dataclass(frozen=True)
class Arena:
    """A task in four directions, with its recording's guarantee."""

    task: str
    rollout: Rollout
    space: Space
    given: Guarantee

    def evaluator(self, seed: int, budget: int) -> Evaluator:
        """Return an evaluator that may run `budget` episodes."""
        return Evaluator(self.rollout, self.space, SCENARIO, self.given, seed, budget, lambda *_: None)


def space_of(stage: Stage) -> Numbered:
    """Return a task's four directions."""
    usual, far = float(nominal_of(stage)), float(stage.marked.drifts[stage.drift].value)
    sensor = next(one for one in stage.marked.sensors if one.low is not None)
    assert sensor.low is not None
    assert sensor.high is not None
    assert sensor.topic is not None
    assert isinstance(sensor.field, str)
    size = 0.1 * (sensor.high - sensor.low)
    parts: dict[str, Any] = {
        "bias": faults.bias(sensor.topic, sensor.field, -size, size),
        "late": faults.latency(sensor.topic, 0.5),
        "lost": faults.dropout(sensor.topic, 0.5),
    }
    return Numbered({SIZE: Span(min(usual, far), max(usual, far), usual)}, parts)


def arena(stage: Stage) -> Arena:
    """Return a task in four directions, after recording it."""
    space = space_of(stage)
    marked = replace(stage.marked, drifts={SCENARIO: Drift(space)})
    return recorded(stage.task, replace(stage.rollout, designation=marked), space, marked)


def recorded(task: str, rollout: Rollout, space: Space, marked: Designation) -> Arena:
    """Return an arena with the guarantee of RECORDED nominal episodes."""
    plans = (
        EpisodePlan(seed, SCENARIO, point=space.nominal) for seed in episode_seeds(11, "offline", RECORDED)
    )
    runs = [outcome(rollout(plan)) for plan in plans]
    tolerance = max(0.05 * abs(fmean(one.total for one in runs)), marked.tolerance or 0.0)
    return Arena(task, rollout, space, guaranteed(runs, tolerance, marked))


def formula(name: str) -> Arena:
    """Return a world of stress_worlds.py or the later sets, or a harmless one."""
    every: dict[str, World | Machine] = {**FORMULAS, **MACHINES, **HARMLESS}
    world = every[name]
    if isinstance(world, Machine):
        return recorded(name, world, world.space, world.marked)
    return recorded(name, Formula(world), world_space(), FORMULA)


def ours(one: Arena, reported: Sequence[Point], together: Together) -> list[Point]:
    """Return the failing drifts of a stress run, confirmed or only expected, nearest first."""
    expected = [failure.point for failure in together.expected]
    unique = {tuple(point.values()): point for point in [*reported, *expected]}
    return sorted(unique.values(), key=lambda point: distance(one.space, point))


def searched(one: Arena, seed: int) -> tuple[list[Point], Together]:
    """Return the drifts that a stress run reports as failing, and its search in several directions."""
    evaluator = one.evaluator(seed, BUDGET)
    curves = [Curve(ray) for ray in rays(one.space, {})]
    risks = divided(RISK, len(curves))
    together = Together(risks.combinations, curves)
    explore(evaluator, together, risks.each)
    found = sorted(
        [*confirmed(curves), *together.found, *farther(curves)], key=lambda failure: failure.distance
    )
    return [failure.point for failure in found], together


class Uniform:
    """Draw every coordinate uniformly."""

    def __init__(self, size: int, draws: np.random.Generator) -> None:
        self.size, self.draws = size, draws

    def ask(self) -> Sequence[float]:
        """Return the next point."""
        drawn: list[float] = self.draws.uniform(-1.0, 1.0, self.size).tolist()
        return drawn

    def tell(self, point: Sequence[float], cost: float) -> None:
        """Do nothing: random points do not depend on costs."""


class Process:
    """A peer in its own process and environment.

    The peer writes a point and reads its cost, each as a line of JSON. If it ends with an error, the points that it
    wrote before still count.
    """

    def __init__(self, home: Path, script: str, size: int, seed: int, seconds: float) -> None:
        python = home / Path(script).stem.removesuffix("_peer") / "bin" / "python"
        budget = BUDGET // PROBES - 1
        words = [str(python), str(HERE / "stress_peers" / script), str(size), str(budget), str(seed)]
        self.process = Popen(words, stdin=PIPE, stdout=PIPE, stderr=DEVNULL, text=True)
        self.script = script
        self.until = monotonic() + seconds
        self.asked = 0

    def ask(self) -> Sequence[float] | None:
        """Return the next point; None after the last one, or when the time is up."""
        assert self.process.stdout is not None
        if not select([self.process.stdout], [], [], max(self.until - monotonic(), 0.0))[0]:
            print(f"{self.script} did not end in time", file=sys.stderr, flush=True)
            return None
        line = self.process.stdout.readline()
        if not line and self.process.wait() != 0:
            ended = f"{self.script} ended with status {self.process.returncode} after {self.asked} points"
            if not self.asked:
                raise SystemExit(ended)
            print(ended, file=sys.stderr, flush=True)
        self.asked += 1
        return json.loads(line) if line else None

    def tell(self, point: Sequence[float], cost: float) -> None:  # noqa: ARG002
        """Send the cost of the last point."""
        assert self.process.stdin is not None
        self.process.stdin.write(f"{cost!r}\n")
        self.process.stdin.flush()

    def close(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.wait()


@contextmanager
def optimiser(method: str, size: int, seed: int, home: Path, seconds: float) -> Iterator[Any]:
    """Yield the peer with this name."""
    if method in PEERS:
        peer = Process(home, PEERS[method], size, seed, seconds)
        try:
            yield peer
        finally:
            peer.close()
    else:
        draws = generator(seed, method)
        yield Uniform(size, draws) if method == "random" else Cma(size, draws)


def placed(space: Space, numbers: Sequence[float]) -> Point:
    """Convert coordinates from -1 to 1 (0 is nominal) to a point of the space."""
    found = {}
    for (name, extent), number in zip(space.extents.items(), numbers, strict=True):
        if isinstance(extent, Choice):
            found[name] = _option(extent, number)
            continue
        usual = nominal(extent)
        low, high = usual - extent.low, extent.high - usual
        # nominal is an end of the range: both signs of a coordinate lead into the range
        if low == 0.0 or high == 0.0:
            found[name] = usual + (high - low) * min(abs(number), 1.0)
        else:
            found[name] = usual + (high if number > 0 else low) * min(max(number, -1.0), 1.0)
    return found


def _option(extent: Choice, number: float) -> float:
    """Return the option at a coordinate; all options have equal parts, with the nominal one in the middle."""
    others = [index for index in range(len(extent.options)) if index != extent.usual]
    others.insert(len(others) // 2, extent.usual)
    return float(others[min(int((number + 1.0) / 2.0 * len(others)), len(others) - 1)])


def peer_run(one: Arena, seed: int, method: str, home: Path, seconds: float = 600.0) -> list[Point]:
    """Run a peer for at most `seconds`; return its failing drifts, nearest first."""
    evaluator = one.evaluator(seed, BUDGET)
    failing: dict[float, Point] = {}
    with optimiser(method, len(one.space.extents), seed, home, seconds) as peer:
        while (asked := peer.ask()) is not None:
            point = placed(one.space, asked)
            try:
                margin = evaluator.examine(point, PROBES).margin
            except BudgetSpentError:
                break
            away = distance(one.space, point)
            if margin < 0.0:
                failing[away] = point
            peer.tell(asked, away / LARGEST if margin < 0.0 else 1.0 + margin)
    return [failing[away] for away in sorted(failing)]


def verified(one: Arena, seed: int, points: Sequence[Point]) -> float | None:
    """Return the distance of the nearest point that fails on fresh seeds, or None."""
    judge = one.evaluator(10_000 + seed, 10**9)
    for k, point in enumerate(points[:OFFERS], 1):
        if judge.confirm(point, "judge", RISK / (k * (k + 1)), SIZES):
            return distance(one.space, point)
    return None


def at_least_as_near(own: float | None, other: float | None) -> bool:
    """Return whether our distance is at most the other; if both methods found nothing, they count as equal."""
    if own is None or other is None:
        return other is None
    return own <= other * (1 + 1e-9)


def offered(
    one: Arena, seed: int, method: str, run: tuple[list[Point], Together] | None, home: Path, seconds: float
) -> list[Point]:
    """Return a method's failing drifts, nearest first; `run` is the result of `searched`, if there is one."""
    if run is None or method not in OWN:
        return peer_run(one, seed, method, home, seconds)
    return run[0] if method == "confirmed" else ours(one, *run)


def compare(
    one: Arena, methods: Sequence[str], seeds: Sequence[int], home: Path, seconds: float
) -> dict[str, list[float | None]]:
    """Return each method's verified distance for each seed."""
    found: dict[str, list[float | None]] = {method: [] for method in methods}
    for seed in seeds:
        run = searched(one, seed) if set(OWN) & set(methods) else None
        for method in methods:
            found[method].append(verified(one, seed, offered(one, seed, method, run, home, seconds)))
        told = " ".join(f"{method} {_shown(found[method][-1])}" for method in methods)
        print(f"{one.task} {seed}: {told}", file=sys.stderr, flush=True)
    return found


def _shown(value: float | None) -> str:
    return "none" if value is None else f"{value:.3f}"


def harmless_runs(runs: int, name: str = "harmless") -> str:
    """Return how many runs report a failure although nothing in the space breaks the guarantee."""
    one = formula(name)
    false = expected = 0
    for number in range(1, runs + 1):
        reported, together = searched(one, number)
        false += bool(reported)
        expected += bool(together.expected)
        print(f"{false} of {number}, expected {expected}", file=sys.stderr, flush=True)
    told = f"{runs} {name.replace('_', ' ')} runs"
    return f"A failure was reported in {false} of {told}, and expected without confirmation in {expected}."


def row(task: str, found: Mapping[str, Sequence[float | None]]) -> str:
    """Return a task's line: each method's median distance, and how often a method of OWN is at least as near."""
    cells = []
    for method, values in found.items():
        known = [value for value in values if value is not None]
        cell = f"{_shown(median(known) if known else None)} ({len(known)})"
        if method not in OWN:
            counts = [str(sum(map(at_least_as_near, found[own], values))) for own in OWN if own in found]
            cell += f", {' / '.join(counts)} of {len(values)}" if counts else ""
        cells.append(cell)
    return f"| {task} | {' | '.join(cells)} |"


def main() -> None:
    """Print a line per task, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("tasks", nargs="*", metavar="TASK", help="default: all")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=0, help="the first seed (default: 0)")
    parser.add_argument("--methods", nargs="+", default=[*OWN, "random", "CMA-ES", *PEERS])
    parser.add_argument("--home", type=Path, default=Path.home() / ".cache" / "tarl-stress-peers")
    parser.add_argument(
        "--peer-seconds", type=float, default=600.0, help="time limit of a peer's process, in seconds"
    )
    parser.add_argument(
        "--harmless",
        type=int,
        default=0,
        help="do only this number of runs, in worlds where the guarantee always holds",
    )
    arguments = parser.parse_args()
    if arguments.harmless:
        for name in arguments.tasks or ["harmless"]:
            if name not in HARMLESS:
                parser.error(f"{name}: not a harmless world; choose from {', '.join(HARMLESS)}")
            print(harmless_runs(arguments.harmless, name), flush=True)
        return
    methods: list[str] = arguments.methods
    seeds = range(arguments.first, arguments.first + arguments.seeds)
    every: dict[str, list[float | None]] = {method: [] for method in methods}
    print(f"| task | {' | '.join(methods)} |\n|---|{'---|' * len(methods)}")
    for task in arguments.tasks or [*FORMULAS, *MACHINES, *TASKS]:

        def visitor(stage: Stage) -> dict[str, list[float | None]]:
            return compare(arena(stage), methods, seeds, arguments.home, arguments.peer_seconds)

        if task in FORMULAS or task in MACHINES:
            found = compare(formula(task), methods, seeds, arguments.home, arguments.peer_seconds)
        else:
            found = visit(task, visitor, None, HERE / "drift")
        print(row(task, found), flush=True)
        for method in methods:
            every[method] += found[method]
    print(row("all", every))


if __name__ == "__main__":
    main()
