"""Run the episodes of a test on local or remote workers."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.errors import RecordingError, TarlError
from pytest_tarl.item_episode import Instruments
from pytest_tarl.options import Options
from pytest_tarl.rollout import EpisodePlan, EpisodeRun
from pytest_tarl.sensors import Sensor
from pytest_tarl.workers import protocol
from pytest_tarl.workers.pool import TRIES, Pool, Post, WorkerDiedError, WorkerHeldError

Serve = Callable[[Post, bytes], bytes]

# plugins that a worker must not load, because they write reports, cache, debug or start workers
OFF: Mapping[str, Any] = {
    "cacheclear": False,
    "collectonly": False,
    "dist": "no",
    "failedfirst": False,
    "htmlpath": None,
    "json_report": False,
    "lf": False,
    "newfirst": False,
    "no_cov": True,
    "numprocesses": None,
    "report_log": None,
    "stepwise": False,
    "tarl_cluster": None,
    "tarl_search": None,
    "tarl_workers": "1",
    "trace": False,
    "tx": [],
    "usepdb": False,
    "xmlpath": None,
}


@dataclass(frozen=True)
class EpisodeExecutor:
    """A rollout whose episodes run on workers."""

    executor: Executor
    serve: Serve
    post: Post
    workers: int

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode and return its result.

        Raise TarlError if the test cannot run as configured. Raise pytest's Exit or Skipped if the test did.
        """
        return self.begin(plan).result()

    def begin(self, plan: EpisodePlan) -> Answer:
        """Submit an episode."""
        return Answer(plan, self.executor.submit(self.serve, self.post, protocol.plan_message(plan)))


@dataclass(frozen=True)
class Answer:
    """A submitted episode."""

    plan: EpisodePlan
    future: Future[bytes]

    def result(self) -> EpisodeRun:
        """Wait for the episode and return its result.

        Raise TarlError if the episode could not run. Raise pytest's Exit or Skipped if the test did.
        """
        try:
            return protocol.answered(self.plan, self.future.result())
        except WorkerDiedError as died:
            raise RecordingError(
                f"In each of {TRIES} attempts, the worker process of the episode with seed {self.plan.seed} {died}. "
                "Run it without --tarl-workers to debug its node, or use fewer workers if memory is short."
            ) from None
        except WorkerHeldError as held:
            raise RecordingError(
                f"Stopped at an episode (seed {self.plan.seed}) that did not end: a node held the interpreter at "
                f"{held} in one call that does not return (a loop in C, a runaway regular expression). TARL replaced "
                "its worker. Bound that call."
            ) from None
        except protocol.SkippedError as skipped:
            pytest.skip(str(skipped))
        except protocol.EndedError as ended:
            pytest.exit(str(ended))
        except CancelledError:
            raise RecordingError("The cluster cancelled an episode: check its scheduler's log.") from None

    def cancel(self) -> bool:
        """Cancel the episode; return whether it had not started yet."""
        return self.future.cancel()

    def then(self, call: Callable[[EpisodeRun], None]) -> None:
        """Call a function with the result, in the thread that receives the result."""

        def ended(future: Future[bytes]) -> None:
            if future.cancelled() or future.exception() is not None:
                return
            with suppress(TarlError):  # the caller gets this error from `result`
                call(protocol.answered(self.plan, future.result()))

        self.future.add_done_callback(ended)


@contextmanager
def opened(
    item: pytest.Function, instruments: Instruments, sensors: Sequence[Sensor], options: Options
) -> Iterator[EpisodeExecutor]:
    """Yield an executor for a test; end its workers on exit."""
    post = posted(item, instruments, sensors)
    if options.cluster is not None:
        from pytest_tarl.workers.cluster import joined, serve_here

        with joined(options.cluster) as (executor, workers):
            yield EpisodeExecutor(executor, serve_here, post, workers)
        return
    pool = Pool()
    executor = ThreadPoolExecutor(options.workers, "tarl")
    try:
        yield EpisodeExecutor(executor, pool.serve, post, options.workers)
    finally:
        executor.shutdown(wait=False, cancel_futures=True)
        pool.close()
        executor.shutdown()


def posted(item: pytest.Function, instruments: Instruments, sensors: Sequence[Sensor]) -> Post:
    """Return everything a worker needs to prepare the item."""
    config = item.config
    plain = {name: value for name, value in vars(config.option).items() if _plain(value)}
    rooted = {"rootdir": str(config.rootpath)}
    if config.inipath is not None:
        rooted["inifilename"] = str(config.inipath)
    plugins = [*config.option.plugins, "no:terminal"]
    folder = str(config.invocation_params.dir)
    start = {
        # absolute, because the worker may have another working directory
        "path": [str(Path(folder, entry)) for entry in sys.path],
        "options": plain | dict(OFF) | rooted | {"plugins": plugins, "basetemp": None},
        "target": f"{item.path}::{item.nodeid.partition('::')[2]}",
    }
    first = {
        "nodeid": item.nodeid,
        "edges": {sensor.name: sensor.edges for sensor in sensors if sensor.learned},
        "instruments": {
            "positions": {
                str(path): [[line, column, number] for (line, column), number in places.items()]
                for path, places in instruments.positions.items()
            },
            "publishes": sorted(instruments.publishes),
        },
    }
    loud = config.option.capture == "no"
    return Post(folder, json.dumps(start), json.dumps(first).encode(), loud)


def _plain(value: object) -> bool:
    try:
        json.dumps(value)
    except (TypeError, ValueError):
        return False
    return True
