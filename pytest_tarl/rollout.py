"""Episodes as the stages above ask for them: what to run, and what came of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from pytest_tarl.instrumentation.trace import Trace


@dataclass(frozen=True)
class EpisodePlan:
    """One run of the designated test. `overlay` replaces the text of files; `record` instruments the nodes."""

    seed: int
    drift: str | None = None
    overlay: Mapping[Path, str] = field(default_factory=dict)
    record: bool = False


@dataclass(frozen=True)
class EpisodeRun:
    """What came of it. `failure` says why the test failed, one line; `topics` are message types by sensor topic.

    `crashed` tells that the node ended it before its time.

    `broken` holds what is neither a pass nor a failed mission, such as an error in the test's own code, as text.
    """

    plan: EpisodePlan
    trace: Trace
    passed: bool
    failure: str = ""
    broken: str = ""
    topics: Mapping[str, str] = field(default_factory=dict)
    crashed: bool = False


class Rollout(Protocol):
    """Runs episodes of one test."""

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode. Raises TarlError where the test cannot be run as asked."""
