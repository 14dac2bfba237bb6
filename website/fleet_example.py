"""Write the files for the example in docs/howto/fleet-logs.md: logs, a recording, and a fleet's data set.

    python -m website.fleet_example FOLDER && cd FOLDER && tarl fleet fleet --by site --since 2026-08-01

Two of 32 robots drift from their 32nd mission on. At the second site, all robots earn less from their 41st mission on,
and half of them run a repair in their last 15 missions.
"""

from __future__ import annotations

import sys
from datetime import datetime, timezone
from pathlib import Path

from pytest_tarl.commands.cli import main
from tests.plugin.monitoring.missions import fixture, log, walks

BEGAN = datetime(2026, 9, 7, 8, 26, tzinfo=timezone.utc).timestamp()
APART = 7.5 * 3600  # seconds between two missions of a robot
ROBOTS, DRIFTED = 32, (4, 9)
SLIGHT = 0.4  # size of the drift at the second site, relative to that of the two drifting robots


def write(folder: Path) -> None:
    """Write all files below a new folder."""
    folder.mkdir(parents=True)
    fixture(folder / "walk.npz", walks(120, 1))
    for robot in range(ROBOTS):
        south, alone = robot >= ROBOTS // 2, float(robot in DRIFTED)
        repaired = south and robot % 2 == 0
        late = SLIGHT if south else alone
        before = walks(31, 100 + robot) + walks(9, 200 + robot, alone) + walks(5, 300 + robot, late)
        last = walks(15, 400 + robot, 0.0 if repaired else late)
        name, site, first = f"r{robot:02}.log", "south" if south else "north", BEGAN + robot
        if repaired:
            ingest(folder, log(folder / "logs" / name, before, first, APART), site)
            ingest(
                folder,
                log(folder / "new" / name, last, first + 45 * APART, APART),
                site,
                "--repair",
                "guard-1",
            )
        else:
            ingest(folder, log(folder / "logs" / name, before + last, first, APART), site)


def ingest(folder: Path, path: Path, site: str, *more: str) -> None:
    """Add a log to the data set."""
    into = ("--to", str(folder / "fleet"), "--fixture", str(folder / "walk.npz"), "--robot", "{file}")
    if main(["ingest", str(path), *into, "--version", "1.4", "--site", site, *more]):
        raise SystemExit(1)


if __name__ == "__main__":
    write(Path(sys.argv[1]))
