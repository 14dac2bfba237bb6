"""Measure `tarl ingest` and `tarl fleet` on a simulated fleet whose changes are known.

    python benchmarks/fleet.py [--robots 1000] [--missions 100] [--logs 20] [--seed 0]
    python benchmarks/fleet.py --robots 10000 --data DIR     # only write the data set and its recording

Robots drive past ten places, dry or wet, at 40 sites. There are four differences from the recorded world:

- 1 % of the robots drift: from a random mission on, a place costs reward, and some missions fail there.
- The last release, which 4 sites get after two thirds of the missions, costs reward at another place.
- A season: at 2 other sites, steps at wet places cost reward in the last fifth of the missions.
- A repair of the release: in the last sixth of the missions, every other robot at the 4 sites gets it. It undoes the
  loss at three of the sites, and has no effect at the fourth.

Groups are formed by version and site, by site, and by site and week; the season does not show in the first grouping.
For comparison, the z-score of each robot's and group's mean reward against the recorded episodes is computed; |z| > 3
is an alarm.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

import numpy as np

from pytest_tarl.fleet.data_folder import Store, store
from pytest_tarl.fleet.mission_rows import Row, files
from pytest_tarl.fleet.schema import TABLES, Origin, origin, partition
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning.fixture import Fixture, load, save
from pytest_tarl.learning.guarantees import stated
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Sample
from pytest_tarl.observing.log_format import LogFile
from pytest_tarl.observing.writer import packed
from pytest_tarl.seeds import episode_seed, generator
from pytest_tarl.sensors import Sensor, binning_digest

PLACES, SITES = 10, 40
RECORDED = 400
TEST = "test_fleet.py::test_drives"
SENSORS = (
    Sensor("place", topic="/place", field="data", low=0, high=PLACES, bins=PLACES),
    Sensor("wet", topic="/wet", field="data"),
)
BEGAN, APART = 1.76e9, 21_600.0  # time of the first mission, and time between a robot's missions (s)
ALARM = 3.0  # minimum |z| of an alarm
REPAIR, IDLE = "guard-1", 3  # name of the repair, and the site where it has no effect


@dataclass(frozen=True)
class World:
    """How a mission differs from the recorded world."""

    drift: bool = False
    release: bool = False
    season: bool = False
    repaired: bool = False


@dataclass(frozen=True)
class Robot:
    """A robot, and the missions at which it truly changes (counted from 0; -1 means never)."""

    number: int
    site: int
    onset: int
    released: int
    season: int
    repaired: int = -1

    @property
    def name(self) -> str:
        """Return the robot's name in the data set."""
        return f"r{self.number:05}"

    @property
    def first(self) -> int:
        """Return the robot's first mission that differs from the recorded world, or -1."""
        return min((one for one in (self.onset, self.released, self.season) if one >= 0), default=-1)

    def world(self, mission: int) -> World:
        """Return how a mission differs from the recorded world."""
        drift, release, season, repaired = (
            0 <= one <= mission for one in (self.onset, self.released, self.season, self.repaired)
        )
        helped = repaired and self.site != IDLE
        return World(drift, release and not helped, season, repaired)

    def version(self, mission: int, missions: int) -> str:
        """Return the software version of a mission."""
        if 0 <= self.released <= mission:
            return "1.2"
        return "1.0" if mission < missions // 3 else "1.1"


def fleet(robots: int, missions: int, seed: int) -> list[Robot]:
    """Draw each robot's true changes."""
    rng = generator(seed, "fleet/truth")
    drifted = set(rng.choice(robots, max(1, robots // 100), replace=False).tolist())
    onsets = rng.integers(int(0.3 * missions), int(0.7 * missions), robots).tolist()
    return [
        Robot(
            number=n,
            site=n % SITES,
            onset=onsets[n] if n in drifted else -1,
            released=2 * missions // 3 if n % SITES < 4 else -1,
            season=4 * missions // 5 if n % SITES in (10, 11) else -1,
            repaired=5 * missions // 6 if n % SITES < 4 and n // SITES % 2 else -1,
        )
        for n in range(robots)
    ]


def drive(rng: np.random.Generator, world: World) -> tuple[Trace, bool]:
    """Return a mission's trace, and whether it passed."""
    wet = int(rng.random() < 0.3)
    stays = 1 + (rng.random(PLACES) < 0.5)
    place = np.repeat(np.arange(PLACES), stays)
    reward = rng.normal(1.0, 0.3, place.size)
    reward -= 0.5 * world.drift * (place == 6) + 0.5 * world.release * (place == 3) + 0.3 * world.season * wet
    passed = rng.random() >= 0.002 + 0.15 * world.drift
    none = np.empty(0, np.int32)
    cells = tuple((n, wet) for n in range(PLACES))
    return Trace(cells, none, np.empty(0), none, none, place.astype(np.int32), reward, {}), bool(passed)


def recording(path: Path, seed: int) -> Fixture:
    """Save and load a recording."""
    rng = generator(seed, "fleet/recording")
    samples = [
        sample(trace, episode_seed(seed, "fleet", n), passed, ())
        for n, (trace, passed) in enumerate(drive(rng, World()) for _ in range(RECORDED))
    ]
    whole = merge(samples)
    save(
        Fixture(
            TEST, seed, SENSORS, (), {}, whole, (), stated=stated(whole.passed.tolist(), whole.total.tolist())
        ),
        path,
    )
    return load(path)


def rows(robots: list[Robot], missions: int, seed: int) -> Iterator[tuple[str, Row]]:
    """Yield the version and row of every mission."""
    for robot in robots:
        rng = generator(seed, f"fleet/{robot.name}")
        for n in range(missions):
            trace, passed = drive(rng, robot.world(n))
            one = sample(trace, episode_seed(seed, robot.name, n), passed, ())
            yield (
                robot.version(n, missions),
                Row(
                    robot.name,
                    f"s{robot.site:02}",
                    BEGAN + n * APART,
                    one,
                    REPAIR if robot.world(n).repaired else "",
                ),
            )


def stored(to: Store, robots: list[Robot], missions: int, seed: int, where: Origin) -> tuple[int, float]:
    """Write the data set as `tarl ingest` does, a few robots at a time; return its bytes and the CPU seconds."""
    size, spent = 0, 0.0
    for begin in range(0, len(robots), 200):
        parts: dict[tuple[str, str], list[Row]] = {}
        for version, row in rows(robots[begin : begin + 200], missions, seed):
            parts.setdefault((version, row.date), []).append(row)
        before = process_time()
        for (version, day), some in sorted(parts.items()):
            name, contents = files(some, where, ())
            for table in TABLES:
                size += len(contents[table])
                to.write(f"{table}/{partition(where, version, day)}/{name}.parquet", contents[table])
        spent += process_time() - before
    return size, spent


def written_alone(folder: Path, robots: int, missions: int, seed: int) -> None:
    """Write a fleet's data set and its recording, `test.npz`."""
    folder.mkdir(parents=True, exist_ok=True)
    path, to = folder / "test.npz", store(str(folder))
    recording(path, seed)
    about = origin(load(path), path.read_bytes())
    used, spent = stored(to, fleet(robots, missions, seed), missions, seed, about)
    to.write(f"recordings/{about.recording}.npz", path.read_bytes())
    count = robots * missions
    print(
        f"{count:,} missions: {used / count:.0f} bytes a mission, {count / spent:,.0f} a CPU second to write"
    )


def logs(folder: Path, robots: list[Robot], missions: int, seed: int) -> list[Path]:
    """Write the logs of some robots as `tarl observe` does."""
    none = packed(np.empty(0, np.int32))
    found = []
    for robot in robots:
        rng = generator(seed, f"fleet/{robot.name}")
        found.append(folder / robot.name / "missions.log")
        file = LogFile(found[-1])
        about = {"sensors": [one.name for one in SENSORS], "bins": binning_digest(SENSORS), "test": TEST}
        file.append(
            {
                "kind": "start",
                "format": 1,
                "time": BEGAN,
                "node": "drive.py",
                "sites": [],
                "judged": False,
                **about,
            }
        )
        for n in range(missions):
            trace, passed = drive(rng, robot.world(n))
            file.append({"kind": "mission", "time": BEGAN + n * APART})
            steps: dict[str, Any] = {
                "cells": [list(cell) for cell in trace.cells],
                "readings": [],
                "dropped": 0,
            }
            steps |= dict.fromkeys(("site", "cell", "step", "thread"), none) | {"flow": packed(np.empty(0))}
            file.append(
                {
                    "kind": "steps",
                    **steps,
                    "step_cell": packed(trace.step_cell),
                    "reward": packed(trace.reward),
                }
            )
            file.append({"kind": "end", "passed": passed, "failure": "", "time": BEGAN + n * APART + 60})
        file.close()
    return found


def command(*arguments: object) -> tuple[float, str]:
    """Run `tarl`; return its CPU seconds and its output."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    told = subprocess.run(
        [sys.executable, "-m", "pytest_tarl", *map(str, arguments)],
        stdout=subprocess.PIPE,
        check=True,
        text=True,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, told.stdout


def peak() -> float:
    """Return the peak memory of all commands so far, in MB."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024


def found_robots(told: dict[str, Any], robots: list[Robot], z: dict[str, float]) -> None:
    """Print the robots that TARL reported, and those with an alarming z-score."""
    truth = {one.name: one for one in robots}
    named = {"e-BH, missions differ": {*told["drifted"]}, "e-BH, below a bound": {*told["below"]}}
    named["e-BH, either"] = named["e-BH, missions differ"] | named["e-BH, below a bound"]
    named["z-score, |z| > 3"] = {name for name, one in z.items() if abs(one) > ALARM}
    kinds = {
        "drifted": {one.name for one in robots if one.onset >= 0},
        "bad release": {one.name for one in robots if one.onset < 0 and one.released >= 0},
        "season": {one.name for one in robots if one.onset < 0 and one.season >= 0},
        "as recorded": {one.name for one in robots if one.first < 0},
    }
    print(
        "| named by | "
        + " | ".join(f"{kind} (of {len(some)})" for kind, some in kinds.items())
        + " | false |"
    )
    print("|---|" + "---|" * (len(kinds) + 1))
    for method, some in named.items():
        counts = [len(some & each) for each in kinds.values()]
        share = 100 * counts[-1] / max(1, len(some))
        print(f"| {method} | " + " | ".join(map(str, counts)) + f" | {share:.1f} % |")
    away = [
        abs(one[since]["mission"] - 1 - truth[one["robot"]].onset)
        for one in told["robots"]
        for since in ["bound_since" if one["robot"] in told["below"] else "world_since"]
        if one["robot"] in named["e-BH, either"] and truth[one["robot"]].onset >= 0
    ]
    if away:
        print(
            f"error of the onset of named drifted robots: median {median(away):g} missions, at most {max(away)}"
        )


def key_of(by: str, robot: Robot, mission: int, missions: int) -> tuple[str, ...]:
    """Return a mission's group."""
    day = datetime.fromtimestamp(BEGAN + mission * APART, timezone.utc).date()
    values = {
        "version": robot.version(mission, missions),
        "site": f"s{robot.site:02}",
        "week": "{}-W{:02}".format(*day.isocalendar()[:2]),
    }
    return tuple(values[one] for one in by.split(","))


def changes(by: str, robots: list[Robot], missions: int) -> dict[tuple[str, ...], dict[str, float]]:
    """Return when each change happened, by group and kind of change."""
    found: dict[tuple[str, ...], dict[str, float]] = {}
    for robot in robots:
        for n in range(missions):
            here = found.setdefault(key_of(by, robot, n, missions), {})
            for kind in ("release", "season", "drift"):
                if getattr(robot.world(n), kind):
                    here[kind] = min(here.get(kind, BEGAN + n * APART), BEGAN + n * APART)
    return found


def found_groups(by: str, told: dict[str, Any], recorded: Sample, robots: list[Robot], missions: int) -> None:
    """Print how many changed groups verdict, onset and z-score find, and the error of the onsets."""
    truth = changes(by, robots, missions)
    mean, spread = float(recorded.total.mean()), float(recorded.total.std(ddof=1))
    named = {*told["groups_drifted"], *told["groups_below"]}
    counts: dict[str, list[int]] = {}
    away: dict[str, list[float]] = {}
    for one in told["groups"]:
        there = truth[tuple(one["values"])]
        kind = next((name for name in ("release", "season", "drift") if name in there), "as recorded")
        z = (one["reward"] - mean) / spread / np.sqrt(1 / one["missions"] + 1 / recorded.episodes)
        changed = " ".join(one["values"]) in named
        row = counts.setdefault(kind, [0, 0, 0, 0])
        row[0] += 1
        row[1] += one["result"] in ("drifted", "degraded")
        row[2] += changed
        row[3] += abs(z) > ALARM
        since = one["evidence"].get("world_since") or one["evidence"].get("bound_since")
        if changed and kind != "as recorded" and since is not None:
            away.setdefault(kind, []).append(abs(since["time"] - there[kind]) / APART)
    print(f"| groups by {by} | number | verdict | onset, e-BH | z-score |\n|---|---|---|---|---|")
    for kind, row in sorted(counts.items()):
        print(f"| {kind} | " + " | ".join(map(str, row)) + " |")
    for kind, some in sorted(away.items()):
        print(
            f"error of the onset of {kind}: median {median(some):.1f} missions of a robot, at most {max(some):.1f}"
        )


def found_rest(told: dict[str, Any], robots: list[Robot]) -> None:
    """Print the clusters, the variance components and the repair's effects."""
    drifted = {one.name for one in robots if one.onset >= 0}
    for one in told["clusters"]:
        inside = len(drifted & {*one["robots"]})
        print(f"cluster of {len(one['robots'])} robots, {inside} of them drifted: cells {one['cells']}")
    for one in told["components"]["rows"]:
        known = (
            number if number is None else round(number, 4)
            for number in map(one.get, ("variance", "low", "high"))
        )
        print("variance, {}: {} ({} to {})".format(one["of"], *known))
    for one in told["repairs"]:
        bound = one["reward_bound"]
        ends = "" if bound["low"] is None else f" ({bound['low']:+.3f} to {bound['high']:+.3f})"
        print(f"repair at {' '.join(one['values'])}: {one['verdict']}, {one['reward'] or 0.0:+.3f}{ends}")


def scores(told: dict[str, Any], recorded: Sample, data: Path) -> dict[str, float]:
    """Return the z-score of each robot's mean reward."""
    import duckdb

    query = (
        f"SELECT robot, avg(total), count(*) FROM read_parquet('{data}/missions/**/*.parquet') GROUP BY robot"  # noqa: S608
    )
    mean, spread = float(recorded.total.mean()), float(recorded.total.std(ddof=1))
    assert told["missions"]
    return {
        name: (average - mean) / spread / np.sqrt(1 / count + 1 / recorded.episodes)
        for name, average, count in duckdb.connect().execute(query).fetchall()
    }


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--robots", type=int, default=1000)
    parser.add_argument("--missions", type=int, default=100, help="of each robot")
    parser.add_argument("--logs", type=int, default=20, help="robots whose logs are ingested by the command")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--data", type=Path, metavar="DIR", help="write the data set to this folder and stop")
    order = parser.parse_args()
    if order.data is not None:
        written_alone(order.data, order.robots, order.missions, order.seed)
        return
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = folder / "test.npz"
        fixture = recording(path, order.seed)
        robots = fleet(order.robots, order.missions, order.seed)
        some = robots[: order.logs]
        written = logs(folder, some, order.missions, order.seed)
        arguments = ("ingest", *written, "--to", folder / "logs", "--fixture", path, "--robot", "{folder}")
        start, _ = command("ingest", "--help")
        first, _ = command(*arguments)
        again, _ = command(*arguments)
        count = len(some) * order.missions
        print(
            f"ingest of {count:,} missions in {len(some)} logs: {count / (first - start):,.0f} missions per CPU second"
        )
        print(f"the same logs again: {count / (again - start):,.0f}; peak {peak():.0f} MB")
        about = origin(fixture, path.read_bytes())
        for size in (order.robots // 4, order.robots):
            data = folder / f"data{size}"
            to = store(str(data))
            used, spent = stored(to, robots[:size], order.missions, order.seed, about)
            to.write(f"recordings/{about.recording}.npz", path.read_bytes())
            missions = size * order.missions
            query, out = command("fleet", data, "--json", "-", "--html", folder / "fleet.html")
            print(
                f"{missions:,} missions: {used / missions:.0f} bytes a mission, writing {missions / spent:,.0f} "
                f"missions a CPU second, query {query:.1f} CPU seconds, peak {peak():.0f} MB"
            )
        told = json.loads(out)
        print(f"named at a false discovery rate of at most {100 * told['false_discovery_rate']:g} %:")
        found_robots(told, robots, scores(told, fixture.sample, data))
        found_groups("version,site", told, fixture.sample, robots, order.missions)
        for by in ("site", "site,week"):
            told = json.loads(command("fleet", data, "--json", "-", "--by", by)[1])
            found_groups(by, told, fixture.sample, robots, order.missions)
            if by == "site":
                found_rest(told, robots)
        print(f"page: {(folder / 'fleet.html').stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
