"""Reproduce the paper's figures over many seeds and print one table.

    python benchmarks/paper.py [--seeds 20] [--workers 2]

For every seed, the shuttle's transit is recorded as designed (200 episodes), compared in mud (40 episodes), compared in
the unchanged world (40 episodes), and repaired. Two variants of the transit are also recorded and compared in mud: one
with two lines of the node swapped, and one with other units for the gain and the wheels (a gain of 0.5 instead of 5,
which gives the same motion). The true extent of the mud comes from the world, not from a sensor. The line follower is
also recorded, compared at dusk and repaired.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from statistics import fmean
from typing import Any

import numpy as np
import pytest

from pytest_tarl import seeds
from pytest_tarl.comparing import run_online
from pytest_tarl.designation import Designation
from pytest_tarl.instrumentation.sites import Plan, plan
from pytest_tarl.item_episode import Instruments, designated
from pytest_tarl.learning import localize
from pytest_tarl.learning.drift import compare
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.merging import aligned
from pytest_tarl.learning.utility import batch
from pytest_tarl.model import Region
from pytest_tarl.options import Options
from pytest_tarl.recording import Recorded, mean_flows, run_episodes, sarsa_tables
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.repair import repair
from pytest_tarl.repairing.request import Order
from pytest_tarl.repeating import ItemRollout, finish
from pytest_tarl.rollout import EpisodePlan
from pytest_tarl.searching import candidates
from pytest_tarl.searching.search import Candidate
from pytest_tarl.sensors import Cell
from tarl_lint.api import Analysis, analyse

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
OFFLINE, ONLINE = 200, 40
UTILITIES = ("batch", "SARSA", "batch, no flow term", "SARSA, no flow term")
RESTORED = 0.95


@dataclass(frozen=True)
class Variant:
    """An example, unchanged or with replacements in its files: (file, old, new)."""

    test: str
    edits: tuple[tuple[str, str, str], ...] = ()
    repaired: bool = False
    mud: bool = False
    example: str = "shuttle"


VARIANTS = {
    "Figure 4(a)": Variant("test_shuttle.py::test_delivers", repaired=True, mud=True),
    "Figure 4(b), lines swapped": Variant("test_swapped.py::test_delivers_swapped"),
    "gain 0.5": Variant(
        "test_shuttle.py::test_delivers",
        (
            ("traveller.py", "5 * delta", "0.5 * delta"),
            ("world.py", "WHEEL_RADIUS = 0.08", "WHEEL_RADIUS = 0.8"),
            ("world.py", "TOP_SPEED = 55.0", "TOP_SPEED = 5.5"),
        ),
    ),
    "line follower": Variant(
        "test_line_follower.py::test_follows_the_line", repaired=True, example="line_follower"
    ),
}


@dataclass
class Study:
    """A pytest plugin that runs a test's episodes in both worlds, and stores the results."""

    seed: int
    variant: Variant
    found: dict[str, Any] = field(default_factory=dict)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Function, nextitem: pytest.Item | None) -> bool:
        """Run the experiments on the test instead of running it once."""
        marked = designated(item)
        assert marked is not None
        root = item.config.rootpath
        analysis = analyse([item.path.parent / node for node in marked.nodes], root=root)
        sites = plan(analysis)
        instruments = Instruments({root / p: at for p, at in sites.positions.items()}, sites.publishes)
        self._study(ItemRollout(item, marked, instruments), marked, analysis, sites, root)
        finish(item, nextitem)
        return True

    def _study(
        self, rollout: ItemRollout, marked: Designation, analysis: Analysis, sites: Plan, root: Path
    ) -> None:
        (drift,) = marked.drifts
        mud = _watched_mud() if self.variant.mud else []
        offline = self._run(rollout, sites, "offline", OFFLINE, None)
        online = self._run(rollout, sites, "online", ONLINE, drift)
        worlds = {"offline": offline, "online": online}
        self.found["atr"] = {name: float(world.sample.total.mean()) for name, world in worlds.items()}
        region = self._judged(offline, online).region
        self.found["peaks"] = _peaks(offline, online, sites, region)
        if self.variant.mud:
            self.found["muddy"] = _in_mud(rollout, online, drift, mud)
            self.found["region"] = sorted(map(list, (*region.cells, *region.novel)))
        if self.variant.repaired:
            same = self._run(rollout, sites, "online", ONLINE, None)
            self.found["null"] = self._judged(offline, same).verdict.result
            self._repaired(rollout, marked, analysis, sites, root, offline, mud)

    def _run(self, rollout: ItemRollout, sites: Plan, stream: str, count: int, drift: str | None) -> Recorded:
        chosen = seeds.episode_seeds(self.seed, stream, count)
        return run_episodes(rollout, chosen, drift, sites.members, _quiet)

    def _judged(self, offline: Recorded, online: Recorded) -> Any:
        draws = seeds.generator(self.seed, "compare")
        return compare(offline.sample, online.sample, alpha=0.05, tolerance=None, generator=draws)

    def _repaired(
        self,
        rollout: ItemRollout,
        marked: Designation,
        analysis: Analysis,
        sites: Plan,
        root: Path,
        offline: Recorded,
        mud: list[bool],
    ) -> None:
        (drift,) = marked.drifts
        tables = sarsa_tables(offline, mean_flows(offline.sample))
        fixture = Fixture(
            "paper", self.seed, marked.sensors, sites.lists, offline.topics, offline.sample, tables
        )
        options = Options(mode="repair", seed=self.seed)
        online = run_online(rollout, fixture, marked, options, sites, drift, _quiet)
        patches = root / ".tarl" / "patches"
        order = Order(rollout, analysis, root, fixture, online, options, _quiet, patches)
        outcome = repair(order)
        comparison = outcome.comparison
        fixed = comparison.repair
        self.found["repair"] = {
            "accepted": fixed is not None and fixed.accepted,
            "guard": fixed.guard if fixed else "",
            "edits": [f"{edit.code} → {edit.value:g}" for edit in fixed.edits] if fixed else [],
            "episodes": dict(outcome.episodes),
            "verdict": comparison.verdict.result,
            "culprit": comparison.culprits[0].site.code,
            **{name: fmean(totals) for name, totals in comparison.totals.items()},
        }
        if outcome.accepted is not None and self.variant.mud:
            self.found["guard"] = _guard_hits(order, outcome.accepted.candidate, mud)


def _quiet(done: int, total: int, what: str) -> None:
    """Show no progress."""


def _watched_mud() -> list[bool]:
    """Make the world record, at the start of each step, whether the robot is on the mud."""
    world = sys.modules["world"].World
    seen: list[bool] = []
    publish = world.publish

    def noted(self: Any, bus: Any) -> None:
        seen.append(self.on_patch)
        publish(self, bus)

    world.publish = noted
    return seen


def _in_mud(rollout: ItemRollout, online: Recorded, drift: str, mud: list[bool]) -> list[list[int]]:
    """Return the muddy cells: those with at least half of their steps, and at least 5 % of all steps, in mud."""
    counts: dict[Cell, list[bool]] = {}
    for seed in online.sample.seeds:
        mud.clear()
        trace = rollout(EpisodePlan(seed, drift)).trace
        for cell, wet in zip(trace.step_cell, mud, strict=True):
            if cell >= 0:
                counts.setdefault(trace.cells[cell], []).append(wet)
    muddy = sum(map(sum, counts.values()))
    return sorted(
        list(cell) for cell, wet in counts.items() if fmean(wet) >= 0.5 and sum(wet) >= 0.05 * muddy
    )


def _guard_hits(order: Order, candidate: Candidate, mud: list[bool]) -> dict[str, float]:
    """Return the share of steps in mud for which the guard is true, and of other steps for which it is false."""
    hits: dict[bool, list[bool]] = {True: [], False: []}
    patched = Mutants(order).source(candidate)
    for seed in seeds.episode_seeds(order.options.seed, "guard", ONLINE):
        mud.clear()
        trace = order.rollout(EpisodePlan(seed, order.drift, patched)).trace
        for cell, wet in zip(trace.step_cell, mud, strict=True):
            on = cell >= 0 and candidates.holds(candidate.guard, trace.cells[cell], order.comparison.sensors)
            hits[wet].append(on == wet)
    return {"in mud": fmean(hits[True]), "elsewhere": fmean(hits[False])}


def _peaks(offline: Recorded, online: Recorded, sites: Plan, region: Region) -> dict[str, str]:
    """For each way of learning the utility, return the code of the site whose slices differ most."""
    before, after = aligned(offline.sample, online.sample)
    chosen = {*region.cells, *region.novel}
    rows = np.array([i for i, cell in enumerate(before.cells) if cell in chosen], dtype=np.int64)
    peaks = {}
    for name in UTILITIES:
        flow = mean_flows(before)[0] if "no flow" not in name else np.inf
        if name.startswith("batch"):
            tables = [batch(world.lists[0], len(before.cells), flow) for world in (before, after)]
        else:
            tables = [world.sarsa[0].table(before.cells, flow) for world in (offline, online)]
        found = localize.slices(sites.lists[0], tables[0], tables[1], rows)
        peak = max(found, key=lambda one: abs(one.difference))
        peaks[name] = "publish" if peak.site.role == "publish" else peak.site.code
    return peaks


def one(name: str, seed: int) -> dict[str, Any]:
    """Study one variant with one seed, in this process."""
    variant = VARIANTS[name]
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / variant.example
        shutil.copytree(
            EXAMPLES / variant.example,
            copy,
            ignore=shutil.ignore_patterns(".tarl", "__pycache__", ".pytest_cache"),
        )
        for file, old, new in variant.edits:
            text = (copy / file).read_text()
            assert old in text, f"{file} no longer contains {old!r}: update VARIANTS"
            (copy / file).write_text(text.replace(old, new))
        study = Study(seed, variant)
        code = pytest.main(
            ["-q", "-p", "no:cacheprovider", "--rootdir", str(copy), str(copy / variant.test)], [study]
        )
    assert code == pytest.ExitCode.NO_TESTS_COLLECTED or code == 0, code
    return study.found


def table(results: dict[str, list[dict[str, Any]]]) -> str:
    """Return the results over all seeds as a Markdown table."""
    rows = []
    for name, found in results.items():
        if VARIANTS[name].example == "shuttle":
            for utility in UTILITIES:
                peaks = _counted([seen["peaks"][utility] for seen in found])
                rows.append((f"{name}: peak of the slice difference, {utility}", peaks))
    for name, found in results.items():
        rows += _mud_rows(found) if VARIANTS[name].mud else []
        rows += _repair_rows(VARIANTS[name].example, found) if VARIANTS[name].repaired else []
    return "\n".join(["| what | seen |", "|---|---|", *(f"| {what} | {seen} |" for what, seen in rows)])


def _mud_rows(found: list[dict[str, Any]]) -> list[tuple[str, str]]:
    hit = [seen["guard"] for seen in found if "guard" in seen]
    return [
        (
            "shuttle: region holds the muddy cells",
            _share(all(c in s["region"] for c in s["muddy"]) for s in found),
        ),
        (
            "shuttle: guard true on ≥ 90 % of the steps in mud, false on ≥ 90 % of the others",
            _share(h["in mud"] >= 0.9 and h["elsewhere"] >= 0.9 for h in hit),
        ),
    ]


def _repair_rows(example: str, found: list[dict[str, Any]]) -> list[tuple[str, str]]:
    fixed = [seen["repair"] for seen in found]
    kept = [one for one in fixed if one["accepted"]]
    episodes = [f"{fmean(one['episodes'][kind] for one in fixed):.0f}" for kind in ("search", "acceptance")]
    rows = [
        (
            "ATR as designed / in the changed world",
            f"{_mean(found, 'offline'):.2f} / {_mean(found, 'online'):.2f}",
        ),
        (
            "changed world below half of the designed one",
            _share(s["atr"]["online"] < s["atr"]["offline"] / 2 for s in found),
        ),
        ("degraded under the drift", _share(one["verdict"] == "degraded" for one in fixed)),
        ("not degraded in the designed world again", _share(seen["null"] != "degraded" for seen in found)),
        ("first culprit", _counted([one["culprit"] for one in fixed])),
        ("repair accepted", _share(one["accepted"] for one in fixed)),
        ("repaired ≥ 95 % of the designed world", _share(_restored(one) for one in fixed)),
        (
            "nominal world not worse",
            _share(one["nominal_repaired"] >= RESTORED * one["offline"] for one in kept),
        ),
        ("guards", _counted([one["guard"] or "none" for one in kept])),
        ("edits", _counted([", ".join(one["edits"]) for one in kept])),
        ("episodes of search / acceptance, mean", " / ".join(episodes)),
    ]
    return [(f"{example}: {what}", seen) for what, seen in rows]


def _counted(values: list[str]) -> str:
    distinct = sorted(set(values), key=lambda value: -values.count(value))
    return ", ".join(f"`{value}` {values.count(value)}/{len(values)}" for value in distinct)


def _share(values: Any) -> str:
    kept = list(values)
    return f"{sum(kept)}/{len(kept)}"


def _mean(found: list[dict[str, Any]], world: str) -> float:
    return fmean(seen["atr"][world] for seen in found)


def _restored(fixed: dict[str, Any]) -> bool:
    return bool(fixed["accepted"]) and fixed["repaired"] >= RESTORED * fixed["offline"]


def main() -> None:
    """Study all variants with all seeds, each in its own process."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--one", nargs=2, metavar=("VARIANT", "SEED"), help="print one study as JSON")
    arguments = parser.parse_args()
    if arguments.one:
        print("\n" + json.dumps(one(arguments.one[0], int(arguments.one[1]))))
        return

    def study(job: tuple[str, int]) -> dict[str, Any]:
        command = [sys.executable, __file__, "--one", job[0], str(job[1])]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(f"{job[0]}, seed {job[1]} failed:\n{done.stdout}\n{done.stderr}")
        print(f"{job[0]}, seed {job[1]}", file=sys.stderr)
        found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
        return found

    jobs = [(name, seed) for name in VARIANTS for seed in range(arguments.seeds)]
    with ThreadPoolExecutor(arguments.workers) as pool:
        found = dict(zip(jobs, pool.map(study, jobs), strict=True))
    print(table({name: [found[name, seed] for seed in range(arguments.seeds)] for name in VARIANTS}))


if __name__ == "__main__":
    main()
