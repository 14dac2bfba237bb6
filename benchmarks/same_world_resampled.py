"""Measure the drift test's false alarms on random splits of one long recording.

    python benchmarks/same_world_resampled.py shuttle [--episodes 4000] [--splits 2500] [--seed 0]

`same_world.py` makes a recording for each comparison, which takes seconds. Here, `pytest --tarl-record` runs a world
once, with many episodes. Each split draws 200 of them as the designed world and 40 as the deployed world, which takes
50 ms. If the recording is many times longer than a split, the share of splits with p below a level estimates the true
rate of false alarms at that level.
"""

from __future__ import annotations

import argparse
import os
import shutil
import tempfile
from collections.abc import Sequence
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from same_world import SPARED, Undrifted, World, worlds

from pytest_tarl.learning.drift import compare
from pytest_tarl.learning.fixture import Fixture, load
from pytest_tarl.learning.tables import Ints, Sample

DESIGNED, DEPLOYED = 200, 40  # episodes of a recording and of a comparison (the plugin's defaults)
LEVELS = (0.01, 0.05, 0.1, 0.25, 0.5)


class Lengthened(Undrifted):
    """A pytest plugin that records the requested number of episodes."""

    def __init__(self, episodes: int) -> None:
        self.episodes = episodes

    @pytest.hookimpl(tryfirst=True)
    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        """Change the marker before the scenarios are generated."""
        super().pytest_generate_tests(metafunc)
        marker = metafunc.definition.get_closest_marker("tarl")
        if marker is not None and isinstance(marker.kwargs, dict):
            marker.kwargs["episodes"] = self.episodes


def recorded(world: World, episodes: int) -> Fixture:
    """Record a world. Raise RuntimeError if the recording fails."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / world.folder.name
        shutil.copytree(world.folder, folder, ignore=SPARED)
        os.chdir(folder)
        quiet = ("-q", "-p", "no:cacheprovider", "-c", os.devnull, "--rootdir", ".")
        with Path(os.devnull).open("w") as nowhere, redirect_stdout(nowhere):
            status = pytest.main(
                ["-W", "ignore", *quiet, world.test, "--tarl-record"], [Lengthened(episodes)]
            )
        if status != pytest.ExitCode.OK:
            raise RuntimeError(f"{world.test}: pytest ended with {status!r}.")
        (path,) = (folder / ".tarl" / "utility").glob("*.npz")
        return load(path)


def chosen(sample: Sample, episodes: Ints) -> Sample:
    """Return the sample of these episodes (indices in ascending order)."""
    place = np.full(sample.episodes, -1)
    place[episodes] = np.arange(len(episodes))
    rows = place[sample.chain.episode] >= 0
    kept = type(sample.chain)(*(column[rows] for column in vars(sample.chain).values()))
    return replace(
        sample,
        seeds=tuple(sample.seeds[i] for i in episodes.tolist()),
        passed=sample.passed[episodes],
        total=sample.total[episodes],
        steps=sample.steps[episodes],
        chain=replace(kept, episode=place[kept.episode]),
        lists=(),
        judgements=None,
    )


def p_values(fixture: Fixture, splits: int, seed: int) -> list[float]:
    """Return p_drift of each split."""
    generator = np.random.default_rng(seed)
    found = []
    for _ in range(splits):
        drawn = generator.permutation(fixture.sample.episodes)[: DESIGNED + DEPLOYED]
        designed, deployed = (
            chosen(fixture.sample, np.sort(part)) for part in (drawn[:DESIGNED], drawn[DESIGNED:])
        )
        difference = compare(
            designed, deployed, alpha=0.05, tolerance=None, generator=generator, sensors=fixture.sensors
        )
        found.append(difference.verdict.p_drift)
    return found


def main(arguments: Sequence[str] | None = None) -> None:
    """Record, split, and print the shares below each level."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("world", choices=list(worlds()), metavar="WORLD")
    parser.add_argument("--episodes", type=int, default=4000)
    parser.add_argument("--splits", type=int, default=2500)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args(arguments)
    if asked.episodes < DESIGNED + DEPLOYED:
        parser.error(f"--episodes {asked.episodes}: a split takes {DESIGNED + DEPLOYED}.")
    found = np.array(p_values(recorded(worlds()[asked.world], asked.episodes), asked.splits, asked.seed))
    shares = ", ".join(f"{(found < level).mean():.1%} below {level:g}" for level in LEVELS)
    print(f"{asked.world}: p_drift of {asked.splits} splits of {asked.episodes} episodes: {shares}")


if __name__ == "__main__":
    main()
