"""The two examples as worlds for gate.py: their missions, recorded through pytest at any size of the drift."""

from __future__ import annotations

import shutil
import tempfile
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest
from gate_pools import Mode, Pool

from pytest_tarl import Drift
from pytest_tarl.item_episode import NOTHING, designated
from pytest_tarl.learning.tables import Sample
from pytest_tarl.recording import run_episodes
from pytest_tarl.repeating import ItemRollout, finish
from pytest_tarl.seeds import episode_seeds

FOLDER = Path(__file__).resolve().parent.parent / "examples"


@dataclass(frozen=True)
class Example:
    """A test from the examples; its drift ranges from 1 (as designed) down to the marker's value."""

    test: str
    mode: Mode  # how the sensors of the example show the drift


EXAMPLES = {
    "shuttle": Example("test_shuttle.py::test_delivers", "harmless"),
    "line_follower": Example("test_line_follower.py::test_follows_the_line", "hidden"),
}


@dataclass
class Recording:
    """A pytest plugin that records missions of a test at one size of its drift."""

    size: float
    episodes: int
    found: list[Sample] = field(default_factory=list)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Function, nextitem: pytest.Item | None) -> bool:
        """Record episodes instead of running the test once."""
        marked = designated(item)
        assert marked is not None
        ((name, full),) = marked.drifts.items()
        weaker = replace(marked, drifts={name: Drift(1.0 - self.size * (1.0 - full.value))})
        rollout = ItemRollout(item, weaker, NOTHING)
        chosen = episode_seeds(0, f"gate/{self.size}", self.episodes)
        self.found.append(run_episodes(rollout, chosen, name if self.size else None, (), _quiet).sample)
        finish(item, nextitem)
        return True


def recorded(name: str, size: float, episodes: int) -> Pool:
    """Run missions of an example; which cells its drift changes is not known."""
    example = EXAMPLES[name]
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / name
        shutil.copytree(FOLDER / name, copy, ignore=shutil.ignore_patterns(".tarl", "__pycache__"))
        recording = Recording(size, episodes)
        test = str(copy / example.test)
        # -q belongs to the terminal plugin
        plain = ["-p", "no:cacheprovider", "-p", "no:terminal"]
        pytest.main([*plain, "--rootdir", str(copy), test], [recording])
    return Pool(recording.found[0], frozenset())


def _quiet(done: int, total: int, what: str) -> None:
    """Show no progress."""
