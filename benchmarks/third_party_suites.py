"""Run other projects' test suites, plain and with every statement recorded, and compare each test's outcome.

`python benchmarks/third_party_suites.py toolz attrs` downloads the sdists (pinned, with hashes), installs them in a
temporary environment, runs each suite twice, and prints the tests whose outcomes differ. If there are any, the plain
suite runs up to three more times; then the files of the tests that still differ run up to twenty times. An outcome that
also occurs in a plain run is not caused by recording. The exit status is 1 if recording changed an outcome.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import venv
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
PLAIN_RUNS = 4  # maximum number of plain runs
FILE_RUNS = 20  # maximum number of further plain runs, only of the files whose tests still differ
TOOLS = ("pytest==8.4.2", "hypothesis==6.135.0")


@dataclass(frozen=True)
class Suite:
    """A release: hash of its sdist, folder of its package, requirements of its tests, and how to run them."""

    version: str
    sha256: str
    package: str
    tests: tuple[str, ...] = ("tests",)
    needs: tuple[str, ...] = ()
    options: tuple[str, ...] = ()


SUITES = {
    "toolz": Suite(
        "1.0.0", "2c86e3d9a04798ac556793bced838816296a2f085017664e4995cb40a1047a02", "toolz", ("toolz", "tlz")
    ),
    "sortedcontainers": Suite(  # its sdist has no tests, but examples in every docstring
        "2.4.0",
        "25caa5a06cc30b6b83d11423433f65d1f9d76c4c6a0c90e3379eaa43b9bfdb88",
        "sortedcontainers",
        ("sortedcontainers",),
        options=("--doctest-modules",),
    ),
    "attrs": Suite(
        "25.3.0",
        "75d7cefc7fb576747b2c81b4442d4d4a1ce0900973527c011d1030fd3bf4af1b",
        "src",
        needs=("cloudpickle==3.1.1",),
    ),
    "more-itertools": Suite(
        "10.7.0", "9fddd5403be01a94b204faadcff459ec3568cf110265d3c54323e1e866ad29d3", "more_itertools"
    ),
    "transitions": Suite(
        "0.9.2",
        "2f8490dbdbd419366cef1516032ab06d07ccb5839ef54905e842a472692d4204",
        "transitions",
        needs=("six==1.17.0", "dill==0.4.0", "mock==5.2.0"),
        # this test file checks the sources with other tools
        options=("-o", "addopts=", "--ignore=tests/test_codestyle.py"),
    ),
    "jinja2": Suite(
        "3.1.6",
        "0137fb05990d35f1275a587e9aee6d56da821fc83491a0fb838183be43f66d6d",
        "src/jinja2",
        needs=("trio==0.30.0",),
    ),
    "click": Suite("8.2.1", "27c491cc05d968d271d5a1db13e3b5a184636d9d930f148c50b038f0d0646202", "src/click"),
    "filterpy": Suite(
        "1.4.5",
        "4f2a4d39e4ea601b9ab42b2db08b5918a9538c168cff1c6895ae26646f3d73b1",
        "filterpy",
        ("filterpy",),
        ("scipy==1.15.3", "matplotlib==3.10.3"),
    ),
    "pydantic": Suite(
        "2.11.7",
        "d989c3c6cb79469287b1569f7447a17848c998458d49ebe294e975b9baf0f0db",
        "pydantic",
        needs=(
            "dirty-equals==0.9.0",
            "jsonschema==4.24.0",
            "pytz==2025.2",
            "pytest-mock==3.14.1",
            "pytest-benchmark==5.1.0",  # the suite's settings contain this plugin's options
            "email-validator",
        ),
        # a plugin that runs tests in threads registers the marks that the tests use
        options=(
            *("-W", "ignore::pytest.PytestUnknownMarkWarning"),
            *("--ignore=tests/benchmarks", "--ignore=tests/mypy", "--ignore=tests/test_docs.py"),
        ),
    ),
    "networkx": Suite(
        "3.4.2",
        "307c3669428c5362aab27c8a1260aa8f47c4e91d3891f48be0141738d8d053e1",
        "networkx",
        ("networkx",),
        ("scipy==1.15.3",),
    ),
}
Outcomes = dict[str, list[str]]


def main() -> None:
    """Run the named suites, or all of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("suites", nargs="*", help=f"of {', '.join(SUITES)} (default: all)")
    parser.add_argument("--keep", type=Path, help="folder in which to keep the results of all tests")
    parser.add_argument("--tests", nargs="*", metavar="PATH", help="only these parts of each suite")
    given = parser.parse_args()
    unknown = sorted(set(given.suites) - set(SUITES))
    if unknown:
        parser.error(f"unknown suite {unknown[0]!r}: choose from {', '.join(SUITES)}")
    print(
        "| suite | tests | passed | files recorded | sites | events | CPU s plain, recorded | changed by recording |"
    )
    print("|---|---|---|---|---|---|---|---|", flush=True)
    changed: list[str] = []
    with tempfile.TemporaryDirectory(prefix="suites-") as folder:
        python = environment(Path(folder))
        for name in given.suites or SUITES:
            changed += compared(name, Path(folder), python, given.keep, tuple(given.tests or ()))
    if changed:
        sys.exit("\n".join(["", "changed by recording:", *changed]))


def environment(folder: Path) -> Path:
    """Create an environment with this checkout and return its interpreter."""
    venv.create(folder / "venv", with_pip=True)
    python = folder / "venv" / "bin" / "python"
    install(python, "--editable", f"{ROOT}[pytest]", *TOOLS)
    return python


def install(python: Path, *what: str) -> None:
    """Install distributions. On failure, exit with pip's output."""
    done = subprocess.run([python, "-m", "pip", "install", "-q", *what], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"pip install {' '.join(what)}:\n{done.stderr[-2000:]}")


def sources(name: str, folder: Path, python: Path) -> Path:
    """Download a suite's sdist, check its hash, and return the folder of its contents."""
    suite, store = SUITES[name], folder / name
    # the suite's metadata, and the packages that it needs
    install(python, f"{name}=={suite.version}", *suite.needs)
    wanted = ("--no-deps", "--no-binary", ":all:", "-d", str(store), f"{name}=={suite.version}")
    subprocess.run([python, "-m", "pip", "download", "-q", *wanted], check=True, capture_output=True)
    (archive,) = store.iterdir()
    found = hashlib.sha256(archive.read_bytes()).hexdigest()
    if found != suite.sha256:
        sys.exit(f"{archive.name}: sha256 {found} differs from the pinned {suite.sha256}: check the release.")
    shutil.unpack_archive(archive, store)
    (unpacked,) = (path for path in store.iterdir() if path.is_dir())
    return unpacked


def compared(
    name: str, folder: Path, python: Path, keep: Path | None, only: tuple[str, ...] = ()
) -> list[str]:
    """Print the row of a suite or of some of its tests; return the tests whose outcome recording changed."""
    suite, at = SUITES[name], sources(name, folder, python)
    suite = replace(suite, tests=only or suite.tests)
    plain, plain_seconds = run(python, suite, at, folder, record=False)
    recorded, recorded_seconds = run(python, suite, at, folder, record=True)
    runs = [plain["tests"]]
    changed = different(runs, recorded["tests"])
    while changed and len(runs) < PLAIN_RUNS:
        runs.append(run(python, suite, at, folder, record=False)[0]["tests"])
        changed = different(runs, recorded["tests"])
    runs += again(python, suite, at, folder, runs, recorded["tests"])
    changed = different(runs, recorded["tests"])
    restless = different([runs[0]], *runs[1:])
    tests: Outcomes = plain["tests"]
    passed = sum(outcome == ["setup passed", "call passed", "teardown passed"] for outcome in tests.values())
    if not passed or not recorded["events"]:
        sys.exit(
            f"{name}: {passed} tests passed and {recorded['events']} events were recorded, which shows nothing."
        )
    note = f"{len(changed)}" + (f" ({len(restless)} differ between plain runs)" if restless else "")
    print(
        f"| {name} {suite.version} | {len(tests):,} | {passed:,} | {recorded['files']} | {recorded['sites']:,} | "
        f"{recorded['events']:,} | {plain_seconds:.0f}, {recorded_seconds:.0f} | {note} |",
        flush=True,
    )
    if keep is not None:
        keep.mkdir(parents=True, exist_ok=True)
        (keep / f"{name}.json").write_text(json.dumps({"plain": plain, "recorded": recorded}, indent=1))
    return [f"{one}: {tests.get(one)} → {recorded['tests'].get(one)}" for one in changed]


def again(
    python: Path, suite: Suite, at: Path, folder: Path, runs: list[Outcomes], recorded: Outcomes
) -> list[Outcomes]:
    """Run the files of the tests that still differ, until each outcome has occurred in a plain run."""
    more: list[Outcomes] = []
    while len(more) < FILE_RUNS and (changed := different([*runs, *more], recorded)):
        files = sorted({one.partition("::")[0] for one in changed})
        found = run(python, replace(suite, tests=tuple(files)), at, folder, record=False)[0]["tests"]
        more.append({**runs[0], **found})
    return more


def different(runs: list[Outcomes], *others: Outcomes) -> list[str]:
    """Return the tests with an outcome in `others` that they had in none of the runs."""
    names = {name for one in (*runs, *others) for name in one}
    return sorted(
        name
        for name in names
        if any(other.get(name) not in [one.get(name) for one in runs] for other in others)
    )


def run(python: Path, suite: Suite, at: Path, folder: Path, *, record: bool) -> tuple[dict[str, Any], float]:
    """Run a suite; return its tests' outcomes and the CPU seconds."""
    result = folder / "result.json"
    result.unlink(missing_ok=True)
    package = at / suite.package
    importable = package if suite.package == "src" else package.parent
    surroundings = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(importable), str(ROOT / "benchmarks")]),
        "PYTHONHASHSEED": "0",
        "PYTHONDONTWRITEBYTECODE": "1",
        "MPLBACKEND": "agg",
        "SUITE_RECORDED": str(package) if record else "",
        "SUITE_RESULT": str(result),
    }
    tests = [test for test in suite.tests if (at / test).exists()]
    plugins = ("-p", "suite_recorder", "-p", "no:cacheprovider", "-p", "no:tarl")
    command = [str(python), "-m", "pytest", "-q", *plugins, *suite.options, *tests]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=at, env=surroundings, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if not result.exists():
        sys.exit(f"{at.name}: pytest ended without a result:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    spent = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    outcome: dict[str, Any] = json.loads(result.read_text())
    return outcome, spent


if __name__ == "__main__":
    main()
