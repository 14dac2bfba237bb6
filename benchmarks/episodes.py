"""Measure the cost of an episode of the shuttle, plain and recorded, and of an empty test.

    python benchmarks/episodes.py [--episodes 200]

Times are CPU times of the process, the minimum of several rounds. The empty test has one sensor, but no world and no
node.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.item_episode import NOTHING, Instruments, designated
from pytest_tarl.repeating import ItemRollout, finish
from pytest_tarl.rollout import EpisodePlan
from pytest_tarl.seeds import episode_seeds
from tarl_lint.api import analyse

EXAMPLE = Path(__file__).resolve().parent.parent / "examples" / "shuttle"
ROUNDS = 5

EMPTY = """
import pytest
from pytest_tarl import Sensor

@pytest.mark.tarl(nodes=["none.py"], sensors=[Sensor("x")])
def test_empty(tarl):
    tarl.observe(x=0)
    tarl.reward(0.0)
"""


@dataclass
class Stopwatch:
    """A pytest plugin that times a test's episodes instead of running the test once; `found` has milliseconds."""

    episodes: int
    found: dict[str, float] = field(default_factory=dict)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Function, nextitem: pytest.Item | None) -> bool:
        """Time plain and recorded episodes alternately."""
        marked = designated(item)
        assert marked is not None
        root = item.config.rootpath
        nodes = [path for node in marked.nodes if (path := item.path.parent / node).exists()]
        sites = plan(analyse(nodes, root=root)) if nodes else None
        positions = {root / path: at for path, at in sites.positions.items()} if sites else {}
        instruments = Instruments(positions, sites.publishes) if sites else NOTHING
        rollout = ItemRollout(item, marked, instruments)
        seeds = episode_seeds(0, "offline", self.episodes)
        for _ in range(ROUNDS):
            for name, record in (("plain", False), ("recorded", True)):
                start = time.process_time()
                for seed in seeds:
                    rollout(EpisodePlan(seed, record=record))
                spent = (time.process_time() - start) / len(seeds) * 1000
                self.found[name] = min(spent, self.found.get(name, spent))
        finish(item, nextitem)
        return True


def timed(test: str, root: Path, episodes: int) -> dict[str, float]:
    """Return the milliseconds per episode of a test, plain and recorded."""
    watch = Stopwatch(episodes)
    with contextlib.redirect_stdout(io.StringIO()):
        pytest.main(["-q", "-p", "no:cacheprovider", "--rootdir", str(root), test], [watch])
    return watch.found


def table(episodes: int = 200) -> list[str]:
    """Return the lines of the table."""
    shuttle = timed(str(EXAMPLE / "test_shuttle.py::test_delivers"), EXAMPLE, episodes)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "test_empty.py"
        path.write_text(EMPTY)
        empty = timed(str(path), Path(folder), episodes)
    over = shuttle["recorded"] / shuttle["plain"] - 1
    return [
        "| what | ms of CPU per episode | goal |",
        "|---|---|---|",
        f"| shuttle, uninstrumented | {shuttle['plain']:.2f} | ≤ 20 |",
        f"| shuttle, recorded | {shuttle['recorded']:.2f} ({over:+.1%}) | ≤ +5 % |",
        f"| an empty test | {empty['plain']:.2f} | ≤ 0.5 |",
    ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--episodes", type=int, default=200)
    print("\n".join(table(parser.parse_args().episodes)))


if __name__ == "__main__":
    main()
