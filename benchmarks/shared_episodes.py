"""Compare `--tarl-total` with an even split of the same episodes: how often are drifts of known size found?

    python benchmarks/shared_episodes.py [--runs 1000] [--total 160] [--recorded 60] [--seed 0]

Totals of episodes are normal with standard deviation 1; a drift of size d lowers their mean by d. All drifts of a world
are compared with one recording. The script uses the plugin's schedule of interim tests, its permutation test, and its
rule for which comparison continues. It ignores regions of sensor space, so a loss counts as found as soon as it is
significant.

Comparisons may end early. The row "even, as many run" therefore uses a larger even share: the smallest one for which
the comparisons run, on average, as many episodes as with the shared total. Users cannot know this share in advance.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from pytest_tarl.learning.permutation import permutations_for, permuted_loss
from pytest_tarl.learning.sequential import Look, planned
from pytest_tarl.learning.spending import Standing, chosen, next_look, schedule
from pytest_tarl.learning.tables import Floats
from pytest_tarl.options import Options

ALPHA = 0.05
DRIFTS = (
    (2.0, 1.0, 0.5, 0.0),
    (2.0, 2.0, 0.5, 0.5),
    (1.5, 0.7, 0.4, 0.2),
    (2.0, 2.0, 2.0, 0.4),
    (0.0, 0.0, 0.0, 0.6),
    (0.6,) * 4,
    (0.0,) * 4,
)
Result = tuple[list[bool], int]  # whether each drift was found, and how many episodes ran


@dataclass(frozen=True)
class World:
    """The recorded total rewards and, for each drift, enough total rewards for every rule."""

    recorded: Floats
    drifts: Sequence[Floats]
    known: dict[tuple[int, int, int], float] = field(default_factory=dict)

    def p_value(self, drift: int, look: Look, looks: Sequence[Look]) -> float:
        """Return a loss's p-value at an interim test; equal numbers of episodes always give the same p-value."""
        permutations = permutations_for(ALPHA, int(np.ceil(1 / looks[0].share)))
        key = drift, look.episodes, permutations
        if key not in self.known:
            draws = np.random.Generator(np.random.Philox(key=look.episodes))
            totals = self.drifts[drift][: look.episodes]
            self.known[key] = permuted_loss(self.recorded, totals, draws, permutations)
        return self.known[key]


def even(world: World, share: int, looks: int) -> Result:
    """Compare each drift separately, all with the same number of episodes."""
    plan = planned(share, looks)
    found, run = [], 0
    for drift in range(len(world.drifts)):
        ended = next((one for one in plan if world.p_value(drift, one, plan) < ALPHA * one.share), None)
        found.append(ended is not None)
        run += (ended or plan[-1]).episodes
    return found, run


def shared(world: World, total: int) -> Result:
    """Share a total among the drifts."""
    looks = schedule(total, len(world.drifts), Options.LOOKS)

    def after(drift: int, look: Look) -> Standing:
        p_value = world.p_value(drift, look, looks)
        return Standing(look.episodes, p_value, p_value < ALPHA * look.share)

    standings = [after(drift, looks[0]) for drift in range(len(world.drifts))]
    run = sum(one.episodes for one in standings)
    while (drift := chosen(standings, looks, total - run)) is not None:
        look = next_look(standings[drift], looks)
        assert look is not None
        run += look.episodes - standings[drift].episodes
        standings[drift] = after(drift, look)
    return [one.decided for one in standings], run


def measured(rule: Callable[[World], Result], worlds: Sequence[World]) -> tuple[Floats, float]:
    """Return how often each drift was found, shape (drifts,), and the mean number of episodes."""
    results = [rule(world) for world in worlds]
    return np.mean([found for found, _ in results], axis=0), float(np.mean([run for _, run in results]))


def main(arguments: Sequence[str] | None = None) -> int:
    """Print one table for each set of drifts."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--total", type=int, default=160)
    parser.add_argument("--recorded", type=int, default=60)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    for number, sizes in enumerate(DRIFTS):
        draws = np.random.Generator(np.random.Philox(key=(options.seed, number)))
        worlds = [
            World(
                draws.standard_normal(options.recorded),
                [draws.standard_normal(options.total) - size for size in sizes],
            )
            for _ in range(options.runs)
        ]
        print(
            f"drifts of {', '.join(f'{size:g}' for size in sizes)} standard deviations, {options.runs} runs"
        )
        _compared(worlds, options.total, options.total // len(sizes))
    return 0


def _compared(worlds: Sequence[World], total: int, share: int) -> None:
    """Print the rules' results; `share` is the number of episodes per drift in an even split."""
    pooled = measured(partial(shared, total=total), worlds)
    _print("shared", pooled)
    _print("even, looks", measured(partial(even, share=share, looks=Options.LOOKS), worlds))
    _print("even, one look", measured(partial(even, share=share, looks=1), worlds))
    for more in range(share, 2 * share + 1):
        again = measured(partial(even, share=more, looks=Options.LOOKS), worlds)
        if again[1] >= pooled[1]:
            _print(f"even, as many run ({more} each)", again)
            break


def _print(name: str, result: tuple[Floats, float]) -> None:
    found = "  ".join(f"{share:6.1%}" for share in result[0])
    print(f"  {name:32} {found}   mean {result[0].mean():6.1%}   {result[1]:5.1f} episodes")


if __name__ == "__main__":
    sys.exit(main())
