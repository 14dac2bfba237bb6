"""Measure the CPU time of judging formulas, per episode: `python benchmarks/formulas.py`."""

from __future__ import annotations

import argparse
import random
from time import process_time

from pytest_tarl.formulas.judging import Judge
from pytest_tarl.formulas.parsing import formula

FORMULAS = (
    "always (gap > 0.3)",
    "always ((gap < 1) -> eventually[0:2] (gap > 2))",
    "(gap > 0.6) until[0:5] (gap > 2.5)",
)
STEPS = (100, 400)
STEP = 40_000_000  # length of a step (ns)
ROUNDS = 3
CAP = 100.0


def episode(text: str, steps: int) -> Judge:
    """Return a judge for one episode with a new random value in each step."""
    judge = Judge(("gap",), [formula("benchmark", text, ("gap",))])
    draws = random.Random(steps)
    for step in range(1, steps + 1):
        judge.steps.append(step * STEP)
        judge.give("gap", draws.uniform(0.5, 3.0), step * STEP)
    return judge


def milliseconds(text: str, steps: int, *, rewarding: bool) -> float:
    """Return the minimum CPU time (ms) to judge an episode, including step rewards if `rewarding`."""
    least = float("inf")
    for _ in range(ROUNDS):
        judge = episode(text, steps)
        begun = process_time()
        judge.conclude(steps * STEP)
        if rewarding:
            judge.rewards(steps * STEP, CAP)
        least = min(least, process_time() - begun)
    return 1000 * least


def main() -> None:
    """Print a table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    print(f"{'ms of CPU time per episode':<52}" + "".join(f"{steps:>8} steps" for steps in STEPS))
    for text in FORMULAS:
        for rewarding in (False, True):
            name = f"{text}{', as reward' if rewarding else ''}"
            figures = "".join(f"{milliseconds(text, steps, rewarding=rewarding):>14.1f}" for steps in STEPS)
            print(f"{name:<66}{figures}".replace(" " * 14, " ", 1))


if __name__ == "__main__":
    main()
