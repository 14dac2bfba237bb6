"""Run pytest in forks of a process that has already imported large libraries, so that runs start faster.

The packages under test and their tests are always imported in the run itself. Needs `os.fork`.
"""

from __future__ import annotations

import argparse
import gc
import json
import os
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path

# large libraries that the tests import, without pytest plugins, whose assertions pytest rewrites on import
LIBRARIES = (
    "_pytest.config",
    "_pytest.pytester",
    "pytest",
    "numpy",
    "numpy.random",
    "scipy.stats",
    "scipy.optimize",
    "libcst",
    "libcst.matchers",
    "greenlet",
    "pyarrow",
    "pyarrow.parquet",
    "pyarrow.compute",
    "pyarrow.dataset",
    "duckdb",
    "dask",
    "fsspec",
    "cma",
    "SALib",
    "rtamt",
    "pandas",
    "yaml",
    "pygls.lsp.server",
    "lsprotocol.types",
    "cattrs",
    "rosbags.rosbag1",
    "rosbags.rosbag2",
    "rosbags.typesys",
    "pygments",
    "PIL.Image",
    "threadpoolctl",
)
POLL = 0.02  # seconds between two checks of a running pytest


class Runner:
    """Runs pytest in a folder, one run at a time."""

    def __init__(self, server: subprocess.Popen[str], output: Path) -> None:
        self._server = server
        self._output = output

    def __call__(self, arguments: Sequence[str], limit: float) -> tuple[int, str]:
        """Return pytest's exit status (negative if a signal ended it) and its output.

        If the run takes longer than the limit in seconds, kill it with its child processes and raise TimeoutExpired.
        """
        assert self._server.stdin is not None
        assert self._server.stdout is not None
        print(
            json.dumps([*map(str, arguments)]),
            limit,
            self._output,
            sep="\t",
            file=self._server.stdin,
            flush=True,
        )
        status = self._server.stdout.readline().strip()
        if status == "timeout":
            raise subprocess.TimeoutExpired([*arguments], limit)
        return int(status), self._output.read_text(errors="replace")


@contextmanager
def warm(
    folder: Path, environment: Mapping[str, str], libraries: Sequence[str] = LIBRARIES
) -> Iterator[Runner]:
    """Start a process that runs pytest in the folder, with this environment, and end it afterwards."""
    with (
        tempfile.TemporaryDirectory() as outputs,
        subprocess.Popen(
            [sys.executable, __file__, *libraries],
            cwd=folder,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        ) as server,
    ):
        yield Runner(server, Path(outputs) / "output")
        assert server.stdin is not None
        server.stdin.close()


def main() -> None:
    """Read requests from standard input until it ends: arguments as JSON, limit in seconds, file for the output."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("libraries", nargs="*", help="modules to import beforehand")
    libraries = parser.parse_args().libraries
    sys.path[0] = ""  # as `python -m pytest` does
    for name in libraries:
        with suppress(ImportError):
            import_module(name)
    gc.freeze()
    answers = os.dup(1)
    for line in sys.stdin:
        arguments, limit, output = line.rstrip("\n").split("\t")
        child = os.fork()
        if not child:
            run(json.loads(arguments), output)
        os.write(answers, f"{ended(child, float(limit))}\n".encode())


def run(arguments: list[str], output: str) -> None:
    """Run pytest in this process (a fork), then end the process."""
    os.setsid()
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    file = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(file, 1)
    os.dup2(file, 2)
    sys.argv = ["pytest", *arguments]
    status = 1
    try:
        import pytest

        status = int(pytest.main(arguments))
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def ended(child: int, limit: float) -> str:
    """Wait for a fork and return its exit status; after the limit, kill it and return `timeout`."""
    end = time.monotonic() + limit
    while not (found := os.waitpid(child, os.WNOHANG))[0]:
        if time.monotonic() > end:
            with suppress(ProcessLookupError):
                os.killpg(child, 9)
            os.waitpid(child, 0)
            return "timeout"
        time.sleep(POLL)
    with suppress(ProcessLookupError):
        os.killpg(child, 9)  # kill the processes that the tests left behind
    return str(os.waitstatus_to_exitcode(found[1]))


if __name__ == "__main__":
    main()
