"""Replay bags through recorded nodes in a worker process."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pytest_tarl.errors import LogError, NodeError, RecordingError, SettingsError
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.rollout import EpisodePlan, EpisodeRun
from pytest_tarl.sensors import binning_digest
from pytest_tarl.workers import protocol
from pytest_tarl.workers.pool import Pool, Post, WorkerDiedError, WorkerHeldError

OF_ONE_BAG = (LogError, RecordingError, NodeError, WorkerDiedError, WorkerHeldError, protocol.SkippedError)
OFF: Mapping[str, object] = {
    "dist": "no",
    "numprocesses": None,
    "tx": [],
    "no_cov": True,
    "usepdb": False,
    "trace": False,
    "htmlpath": None,
    "xmlpath": None,
    "json_report": False,
    "report_log": None,
    "collectonly": False,
}


@dataclass
class Replays:
    """The worker that replays bags; it starts with the first bag."""

    fixture: Fixture
    root: Path  # project folder; the test ID in the recording is relative to it
    _pool: Pool = field(default_factory=Pool)
    _post: Post | None = None

    def __call__(self, bag: Path, seed: int) -> EpisodeRun:
        """Return the mission of a bag.

        Raise LogError if this bag cannot be replayed, or another TarlError if no bag can be.
        """
        plan = EpisodePlan(seed, record=True, bag=bag.resolve())
        self._post = self._post or self._posted(bag)
        try:
            run = protocol.answered(plan, self._pool.serve(self._post, protocol.plan_message(plan)))
        except OF_ONE_BAG as problem:
            raise LogError(f"{bag} cannot be replayed: {problem}") from None
        if run.stuck or run.broken:
            why = run.failure or run.broken.strip().rpartition("\n")[2]
            raise LogError(f"{bag} cannot be replayed: the test ended in an error ({why}).")
        return run

    def close(self) -> None:
        """End the worker."""
        self._pool.close()

    def _posted(self, bag: Path) -> Post:
        """Return the worker's job; its bag makes pytest collect the test."""
        test = self.fixture.test.partition("[")[0]
        if not (self.root / test.partition("::")[0]).is_file():
            raise SettingsError(
                f"{test} was not found in {self.root}, and bags are replayed through its nodes: name the folder of "
                "its project, in which pytest runs, with --project."
            )
        arguments = ["--rootdir", str(self.root), "-p", "no:terminal", "-p", "no:cacheprovider"]
        start = {
            "path": [str(self.root), *sys.path],
            "arguments": [*arguments, "--tarl-online", f"--tarl-bag={bag.resolve()}", test],
            "options": OFF,
        }
        places = {site.id: None for one in self.fixture.lists for site in one.sites}
        first = {
            "nodeid": self.fixture.test,
            "edges": {one.name: one.edges for one in self.fixture.sensors if one.learned},
            "instruments": None,
            "sensors": binning_digest(self.fixture.sensors),
            "sites": [*places],
        }
        return Post(str(self.root), json.dumps(start), json.dumps(first).encode())
