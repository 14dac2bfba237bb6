"""A recording is the same to the byte in any environment: flags of Python, locale, HOME, hash seed, umask, workers."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from tests.plugin.tank import RECORD, fixture_file
from tests.slow import SLOW, chance

TIMES = 40 if SLOW else 2
PYTESTS_OWN = "assertions not in test modules:pytest.PytestConfigWarning"  # with -O, pytest warns about this
PYTHON = (
    [],
    ["-O"],
    ["-OO"],
    ["-W", "error"],
    ["-O", "-W", "error"],
    ["-B"],
    ["-X", "utf8=0"],
    ["-X", "dev"],
)
OPTIONS = ([], ["--tarl-workers=2"], ["-n", "2"], ["-p", "no:cacheprovider"], ["-p", "no:xdist"])
VARIABLES: Mapping[str, tuple[str | None, ...]] = {
    "HOME": (None, "", "/nonexistent", "/dev/null"),
    "LC_ALL": (None, "C", "POSIX", "C.UTF-8", "tr_TR.UTF-8", "no such locale"),
    "PYTHONCOERCECLOCALE": (None, "0"),
    "PYTHONIOENCODING": (None, "ascii", "latin-1", "utf-16"),
    "PYTHONHASHSEED": (None, "0", "1", "4294967295"),
    "TZ": (None, "Asia/Tokyo", "nowhere"),
    "COLUMNS": (None, "1", "x"),
    "TERM": (None, "dumb"),
}


def drawn(seed: int) -> tuple[list[str], list[str], dict[str, str], int]:
    """Return the flags of Python, options of pytest, variables and umask of a run."""
    draw = chance(seed)
    chosen = {name: draw.choice(values) for name, values in VARIABLES.items()}
    kept = {name: value for name, value in os.environ.items() if name not in chosen}
    variables = kept | {name: value for name, value in chosen.items() if value is not None}
    return draw.choice(PYTHON), draw.choice(OPTIONS), variables, draw.choice([0o022, 0o077, 0])


def started(
    folder: Path, flags: list[str], options: list[str], variables: Mapping[str, str], umask: int = 0o022
) -> subprocess.Popen[bytes]:
    """Start a recording whose standard input is closed."""
    return subprocess.Popen(
        [sys.executable, *flags, "-m", "pytest", "-q", *RECORD, *options, "-W", f"ignore:{PYTESTS_OWN}"],
        cwd=folder,
        env=variables,
        umask=umask,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )


@pytest.fixture
def reference(tank: pytest.Pytester) -> bytes:
    """The recording that this process makes."""
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    recorded = fixture_file(tank).read_bytes()
    fixture_file(tank).unlink()
    return recorded


@pytest.mark.parametrize("seed", range(TIMES))
def test_recording_does_not_depend_on_the_environment(
    tank: pytest.Pytester, reference: bytes, seed: int
) -> None:
    flags, options, variables, umask = drawn(seed)
    shown = flags, options, {name: variables.get(name) for name in VARIABLES}, umask
    with started(tank.path, flags, options, variables, umask) as run:
        output = run.communicate()[0]
    assert run.returncode == 0, (shown, output)
    assert b"Traceback" not in output, (shown, output)
    assert fixture_file(tank).read_bytes() == reference, shown


def test_simultaneous_runs_write_one_recording(tank: pytest.Pytester, reference: bytes) -> None:
    runs = [started(tank.path, [], [], os.environ) for _ in range(3)]
    outputs = [run.communicate()[0] for run in runs]
    assert [run.returncode for run in runs] == [0, 0, 0], outputs
    assert fixture_file(tank).read_bytes() == reference
    assert [path.name for path in fixture_file(tank).parent.iterdir()] == [fixture_file(tank).name]
