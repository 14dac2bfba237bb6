"""Commands for fleets: `tarl merge`, `tarl ingest` and `tarl fleet`."""

from __future__ import annotations

import argparse
import sys
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

from pytest_tarl import processors
from pytest_tarl.commands.parser import Parser
from pytest_tarl.errors import SettingsError
from pytest_tarl.files import advice_on
from pytest_tarl.printable import printable, printable_line
from tarl_lint.files import write_atomically

if TYPE_CHECKING:
    from pytest_tarl.workers.replays import Replays


def add_merge(commands: argparse._SubParsersAction[Parser]) -> None:
    """Declare `tarl merge`."""
    merge = commands.add_parser(
        "merge", help="merge recordings of a test and logs of robots into one recording"
    )
    flag = merge.add_argument
    flag("files", type=Path, nargs="+", metavar="FILE", help="recordings (.npz) and logs of `tarl observe`")
    flag("--to", type=Path, required=True, metavar="FILE", help="recording to write")
    flag(
        "--fixture",
        type=Path,
        metavar="FILE",
        help="recording that gives the sensors and statements; its episodes are not merged (default: the first FILE)",
    )
    merge.set_defaults(run=_merge)


def _merge(arguments: argparse.Namespace) -> int:
    from pytest_tarl.fleet import merged
    from pytest_tarl.learning import fixture as fixtures

    fixtures.prepare(arguments.to)
    recording, parts = merged.merged(arguments.files, arguments.fixture)
    fixtures.save(recording, arguments.to)
    for line in merged.lines(arguments.to, recording, parts):
        print(printable_line(line))
    return 0


def add_ingest(commands: argparse._SubParsersAction[Parser]) -> None:
    """Declare `tarl ingest`."""
    ingest = commands.add_parser(
        "ingest", help="add the missions of logs and bags to the data set of a fleet"
    )
    flag = ingest.add_argument
    flag(
        "logs",
        type=Path,
        nargs="+",
        metavar="LOG",
        help="logs of `tarl observe`, or bags with one mission each (.bag, .mcap, .db3, a ROS 2 bag's folder)",
    )
    flag("--to", required=True, metavar="DIR", help="data set: a folder, or a URL such as s3://bucket/folder")
    flag(
        "--fixture",
        type=Path,
        required=True,
        metavar="FILE",
        help="the recording that `tarl observe` used on the robots",
    )
    flag(
        "--robot",
        required=True,
        metavar="NAME",
        help="robot that wrote the log; {folder} and {file} stand for the folder and the name of each log",
    )
    flag("--version", default="unknown", metavar="NAME", help="version of the robots' software")
    flag("--site", default="unknown", metavar="NAME", help="where the robots work")
    flag(
        "--repair",
        default="",
        metavar="NAME",
        help="repair that the robots' software contains: a name, or a patch file of .tarl/patches (default: none)",
    )
    flag(
        "--hash-robots", default="", metavar="SALT", help="store keyed digests in place of the robots' names"
    )
    flag(
        "--project",
        type=Path,
        metavar="DIR",
        help=(
            "project folder of the recorded test, whose nodes replay the bags (default: the folder whose .tarl "
            "holds the recording, otherwise the current folder)"
        ),
    )
    ingest.set_defaults(run=_ingest)


def _ingest(arguments: argparse.Namespace) -> int:
    from pytest_tarl.fleet.bag_missions import is_bag

    if not any(map(is_bag, arguments.logs)):
        return _ingested(arguments, None)
    from pytest_tarl.learning.fixture import load
    from pytest_tarl.workers.replays import Replays

    replays = Replays(load(arguments.fixture), _project(arguments))
    try:
        return _ingested(arguments, replays)
    finally:
        replays.close()


def _project(arguments: argparse.Namespace) -> Path:
    """Return the folder of the recorded test."""
    if arguments.project is not None:
        return Path(arguments.project).resolve()
    folder = arguments.fixture.resolve().parent
    return folder.parent.parent if folder.parts[-2:] == (".tarl", "utility") else Path.cwd()


def _ingested(arguments: argparse.Namespace, replays: Replays | None) -> int:
    from pytest_tarl.fleet.ingest import Order, ingest

    order = Order(
        logs=tuple(arguments.logs),
        to=arguments.to,
        fixture=arguments.fixture,
        robot=arguments.robot,
        version=arguments.version,
        site=arguments.site,
        salt=arguments.hash_robots,
        repair=arguments.repair,
        replay=replays,
    )
    found, refused = 0, 0
    for one in ingest(order):
        if one.problem:
            refused += 1
            print(printable(f"tarl: {one.problem}"), file=sys.stderr)
            continue
        found += one.missions
        known = f", {one.known} were already in the data set" if one.known else ""
        unjudged = f", {one.unjudged} not judged by every formula" if one.unjudged else ""
        print(printable_line(f"  {one.log}: {one.missions} missions of {one.robot}{known}{unjudged}"))
        for note in one.notes:
            print(printable_line(f"    note: {note}"))
    print(printable_line(f"{order.to}: {found} missions added"))
    return 2 if refused else 0


def add_fleet(commands: argparse._SubParsersAction[Parser]) -> None:
    """Declare `tarl fleet`."""
    fleet = commands.add_parser(
        "fleet", help="judge the missions of a fleet's data set, by group and by robot"
    )
    flag = fleet.add_argument
    flag("data", metavar="DIR", help="data set of `tarl ingest`: a folder or a URL")
    flag(
        "--fixture",
        type=Path,
        metavar="FILE",
        help="recording to compare with (default: the one that the missions were ingested with)",
    )
    flag(
        "--by",
        default="version,site",
        metavar="NAMES",
        help="divide missions by version, site, robot, repair, month or week (default version,site)",
    )
    flag("--since", metavar="DATE", help="only missions from this day on (UTC), such as 2026-10-01")
    flag(
        "--robot",
        default="",
        metavar="NAME",
        help="judge only missions of this robot, and list those with the lowest reward",
    )
    flag(
        "--alpha",
        type=float,
        default=0.05,
        metavar="P",
        help="error rate of the verdicts, and false discovery rate of the robots named (default 0.05)",
    )
    flag(
        "--tolerance",
        type=float,
        metavar="R",
        help="tolerated loss of reward per mission (default 5 %% of the recorded reward)",
    )
    flag(
        "--cluster",
        default="",
        metavar="ADDRESS",
        help="judge on the workers of this Dask scheduler, such as tcp://192.0.2.1:8786; they read the data set",
    )
    flag(
        "--workers",
        type=int,
        metavar="N",
        help="number of threads on this machine that judge missions (default: one for each core)",
    )
    flag("--json", type=Path, metavar="FILE", help="write the result to this file; - for standard output")
    flag(
        "--html", type=Path, metavar="FILE", help="write an HTML page to this file; the page needs no network"
    )
    flag(
        "--fail-if",
        action="append",
        default=[],
        choices=("degraded", "drifted", "changed", "robot"),
        help="exit with 1 if a group is degraded (degraded), if a group is degraded or drifted (drifted), if a group "
        "changed over time (changed), or if a robot is named as worse than others (robot); repeatable",
    )
    fleet.set_defaults(run=_fleet)


def _fleet(arguments: argparse.Namespace) -> int:
    from pytest_tarl.fleet import json_result, words
    from pytest_tarl.fleet.question import Question, answer

    question = Question(
        data=arguments.data,
        fixture=arguments.fixture,
        by=tuple(one.strip() for one in arguments.by.split(",") if one.strip()),
        since=_day(arguments.since),
        robot=arguments.robot,
        alpha=arguments.alpha,
        tolerance=arguments.tolerance,
        cluster=arguments.cluster,
        workers=processors.available() if arguments.workers is None else arguments.workers,
    )
    found = answer(question)
    if arguments.html is not None:
        from pytest_tarl.fleet import html

        html.write(found, arguments.html)
    if arguments.json == Path("-"):
        sys.stdout.write(printable(json_result.text(found)))
    else:
        if arguments.json is not None:
            _write(arguments.json, json_result.text(found))
        for line in words.lines(found):
            print(printable_line(line))
    return int(any(found.meets(rule) for rule in arguments.fail_if))


def _day(text: str | None) -> date | None:
    try:
        return None if text is None else date.fromisoformat(text)
    except ValueError:
        raise SettingsError(f"--since must be a day such as 2026-10-01, got {text}.") from None


def _write(path: Path, text: str) -> None:
    try:
        write_atomically(path, text.encode(), parents=True)
    except OSError as problem:
        raise SettingsError(f"{path} cannot be written ({problem.strerror}): {advice_on(problem)}") from None
