"""Run every node script of checked-out repositories in the in-process ROS, without any adaptation.

    python benchmarks/foreign_nodes.py FOLDER... [--only TEXT] [--names FILE] [--counted N --seed N]
                                       [--keep SCRATCH] [--json FILE]

Each FOLDER has checkouts, one folder per repository, which are copied to a scratch folder. Each script gets a minimal
simulation test, which starts it and then publishes messages on its subscribed topics for a few virtual seconds. Each
test runs in its own process, with a time limit and without access to programs, the network or files outside the scratch
folder. Some scripts are counted separately, with the reason: scripts in Python 2, tests, and scripts that need a GPU
library or a device's SDK that is not installed.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import foreign_closed
from foreign_reasons import set_apart, why
from foreign_scripts import Script, scripts

LIMIT = 60  # processor time of a test (s), which, unlike real time, does not depend on the machine's load
WAITING = 600  # real time of a test (s)
TEST = """
import json
import sys
sys.path.insert(0, {here!r})
import pytest
from foreign_messages import publish_to_all
from pytest_tarl import Sensor

@pytest.mark.tarl(nodes=[{node!r}], sensors=[Sensor("step", low=0, high=40, bins=8)])
def test_node(tarl):
    phase, heard = "start", set()
    try:
        tarl.start({node!r}{entry})
        tarl.step(0.2)
        phase = "hear"
        for step in range(30):
            publish_to_all(tarl, step)
            heard |= tarl.ros.subscribed
            tarl.step(0.1)
            tarl.observe(step=step)
        phase = "done"
    finally:
        with open({result!r}, "w") as file:
            json.dump({{"phase": phase, "heard": sorted(heard), "sent": dict(tarl.ros.published)}}, file)
"""


@dataclass(frozen=True)
class Outcome:
    """The result of a script."""

    name: str
    apart: str = ""
    starts: bool = False
    hears: tuple[str, ...] = ()
    publishes: dict[str, int] = field(default_factory=dict)
    fails: str = ""
    missing: str = ""

    @property
    def verdict(self) -> str:
        """Return the last stage that the script reached."""
        if self.apart:
            return "apart"
        if not self.starts:
            return "does not start"
        if self.fails:
            return "fails when messages arrive"
        return " and ".join(
            ["starts", *["receives"] * bool(self.hears), *["publishes"] * bool(self.publishes)]
        )


class Told:
    """A pytest plugin that stores why a test failed."""

    def __init__(self) -> None:
        self.text = ""

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Store the text of a failure."""
        if report.failed:
            self.text = str(report.longrepr)

    def pytest_collectreport(self, report: Any) -> None:
        """Store the error of a file that cannot be collected."""
        if report.failed:
            self.text = str(report.longrepr)


def run(script: Script, number: int) -> Outcome:
    """Write a test for a script into its package, run it, and return the result."""
    if script.apart:
        return Outcome(script.name, apart=script.apart)
    folder = script.package / "tarl_tests"
    folder.mkdir(exist_ok=True)
    result = folder / f"result_{number}.json"
    node = os.path.relpath(script.path, folder)
    entry = f", entry={script.entry!r}" if script.entry else ""
    here = str(Path(__file__).parent)
    test = folder / f"test_{number}.py"
    test.write_text(TEST.format(here=here, node=node, entry=entry, result=str(result)))
    said = folder / f"said_{number}.txt"
    child = multiprocessing.get_context("fork").Process(target=_child, args=(script, test, said))
    child.start()
    child.join(WAITING)
    waits = child.is_alive()
    if waits:
        child.kill()
        child.join()
    if waits or child.exitcode in (-signal.SIGXCPU, -signal.SIGKILL):
        return Outcome(script.name, fails=f"not done in {LIMIT} s", missing="time: not done")
    nothing = {"phase": "start", "heard": [], "sent": {}}
    found: dict[str, Any] = json.loads(result.read_text()) if result.exists() else nothing
    fails = said.read_text("utf-8", errors="replace") if said.exists() else "the process ended"
    apart = set_apart(fails, script.repository)
    if apart:
        return Outcome(script.name, apart=apart)
    return Outcome(
        script.name, "", found["phase"] != "start", tuple(found["heard"]), found["sent"], fails, why(fails)
    )


def _child(script: Script, test: Path, said: Path) -> None:
    """Run one test in this process."""
    import pytest

    told = Told()
    resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))
    os.chdir(test.parent)
    os.environ.update(HOME=str(script.repository), TMPDIR=str(test.parent), MPLBACKEND="Agg")
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    log = os.open(test.with_suffix(".log"), os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(log, 1)
    os.dup2(log, 2)
    sys.dont_write_bytecode, tempfile.tempdir = True, None
    foreign_closed.close_all_but(script.repository.parent)
    options = ["-q", "-c", os.devnull, f"--rootdir={script.repository}", "-p", "no:cacheprovider"]
    pytest.main([*options, "-p", "pytest_tarl.plugin", str(test)], plugins=[told])
    said.write_text(told.text)
    os._exit(0)


def checkouts(folders: Sequence[Path], scratch: Path) -> list[Path]:
    """Copy the repositories in the folders, each as its own git repository; return the copies."""
    copies = []
    for original in sorted(one for folder in folders for one in folder.iterdir() if one.is_dir()):
        copy = scratch / original.name
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(original, copy, symlinks=True)
        subprocess.run(["git", "init", "-q", str(copy)], check=True)
        copies.append(copy)
    return copies


def report(outcomes: Sequence[Outcome]) -> None:
    """Print the figures, the missing features by group, and the scripts that are counted separately."""
    ran = [one for one in outcomes if not one.apart]
    started = [one for one in ran if one.starts]
    print(
        f"\n{len(started)} of {len(ran)} node scripts start without adaptation; {len(outcomes) - len(ran)} others are "
        "not counted.\n"
    )
    print("| furthest stage | scripts |\n|---|---|")
    for verdict, count in Counter(one.verdict for one in ran).most_common():
        print(f"| {verdict} | {count} |")
    print("\n| missing feature | scripts | for example |\n|---|---|---|")
    groups: dict[str, list[str]] = {}
    for one in ran:
        if one.fails:
            groups.setdefault(f"{'' if one.starts else 'to start: '}{one.missing}", []).append(one.name)
    for missing, names in sorted(groups.items(), key=lambda group: (-len(group[1]), group[0])):
        print(f"| {missing} | {len(names)} | {names[0]} |")
    print("\n| counted separately because | scripts |\n|---|---|")
    apart = Counter(re.sub(r" \(.*", "", one.apart) for one in outcomes if one.apart)
    for reason, count in apart.most_common():
        print(f"| {reason} | {count} |")


def main() -> None:
    """Run the scripts and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument(
        "folders", type=Path, nargs="+", help="folders of checkouts, one folder per repository"
    )
    parser.add_argument("--only", default="", help="run the scripts whose path contains this")
    parser.add_argument("--names", type=Path, help="file of script names, one a line; run only these")
    parser.add_argument("--counted", type=int, help="run scripts in random order until this many are counted")
    parser.add_argument("--seed", type=int, default=0, help="seed of the random order")
    parser.add_argument("--keep", type=Path, help="scratch folder to keep, with the generated tests")
    parser.add_argument("--json", type=Path, help="file for the results of all scripts")
    options = parser.parse_args()
    foreign_closed.warm_up()
    with tempfile.TemporaryDirectory() as temporary:
        scratch = (options.keep or Path(temporary)).resolve()
        scratch.mkdir(parents=True, exist_ok=True)
        found = [one for copy in checkouts(options.folders, scratch) for one in scripts(copy)]
        chosen = [one for one in found if options.only in one.name]
        if options.names is not None:
            named = set(options.names.read_text().split("\n"))
            chosen = [one for one in chosen if one.name in named]
        if options.counted is not None:
            random.Random(options.seed).shuffle(chosen)
        began = time.perf_counter()
        outcomes: list[Outcome] = []
        for number, script in enumerate(chosen):
            if sum(not one.apart for one in outcomes) == options.counted:
                break
            outcomes.append(run(script, number))
            one = outcomes[-1]
            print(f"{one.name}: {one.verdict}{f': {one.missing}' if one.fails else one.apart and f': {one.apart}'}",
                  flush=True)  # fmt: skip
        report(outcomes)
        print(f"\n{time.perf_counter() - began:.0f} s")
        if options.json:
            options.json.write_text(json.dumps([asdict(one) for one in outcomes], indent=1))


if __name__ == "__main__":
    main()
