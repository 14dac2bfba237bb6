"""Print how fast the same test runs in-process, in lock-step on a real rclpy, and with an external simulator.

    python benchmarks/three_worlds.py

This needs rclpy (`make setup-ros2`, then `.venv-ros2/bin/python`). The test is the tank of tests/realros/external: one
node, one sensor, and two simulated seconds per episode in steps of 0.1 s. Each kind is recorded in a separate run. CPU
seconds include all processes of the test, such as a simulator. The cost of an episode comes from the difference between
a run of many episodes and a run of few, which excludes the fixed cost of a run.
"""

from __future__ import annotations

import argparse
import os
import runpy
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic

TANK = Path(__file__).resolve().parents[1] / "tests" / "realros" / "external" / "tank_project.py"
KINDS = {
    "in the process": ("inside", (), 400),
    "in lock-step on rclpy": ("inside", ("--tarl-ros=real",), 100),
    "external, started anew": ("external", (), 8),
    "external, reset": ("reset", (), 20),
}  # world, options, episodes
FEW = 2


def main() -> int:
    """Print the milliseconds per episode: wall time, CPU time, and CPU time relative to the first kind."""
    argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0]).parse_args()
    first = 0.0
    print(
        "| kind | ms an episode, wall | ms an episode, CPU | CPU relative to the first |\n|---|---|---|---|"
    )
    for kind, (world, options, episodes) in KINDS.items():
        few = _seconds(world, options, FEW)
        many = _seconds(world, options, FEW + episodes)
        wall, cpu = (1000 * (b - a) / episodes for a, b in zip(few, many, strict=True))
        first = first or cpu
        print(f"| {kind} | {wall:.1f} | {cpu:.1f} | {cpu / first:.0f} |", flush=True)
    return 0


def _seconds(world: str, options: tuple[str, ...], episodes: int) -> tuple[float, float]:
    """Record the test; return the wall seconds and CPU seconds."""
    with TemporaryDirectory() as name:
        folder = runpy.run_path(str(TANK))["write"](Path(name) / "tank", external=world != "inside")
        if world == "reset":
            _reset_instead(folder / "test_tank.py")
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *options]
        command += ["--tarl-record", f"--tarl-episodes={episodes}"]
        before, started = os.times(), monotonic()
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        after, ended = os.times(), monotonic()
        if done.returncode:
            sys.exit(done.stdout + done.stderr)
    return ended - started, sum(after[2:4]) - sum(before[2:4])


def _reset_instead(test: Path) -> None:
    """Keep the simulator's process, and start each episode with its reset service."""
    text = test.read_text()
    text = text.replace('step="/step",', 'step="/step", reset="/reset",')
    changed = text.replace('environment={"START": repr(level), "PUMP": repr(pump)},', "")
    assert changed != text
    test.write_text(
        changed.replace(
            "self.tarl = tarl\n        self.simulator",
            "self.tarl, self.level = tarl, 0.1\n        self.simulator",
        )
    )


if __name__ == "__main__":
    sys.exit(main())
