"""Run a probe on one kind of ROS. `python -m tests.realros.probes.running` records the results of the real one."""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
import warnings
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any

from pytest_tarl.errors import NodeError
from pytest_tarl.realros.choice import make_ros
from pytest_tarl.ros import message_type

os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"  # the default of every distribution up to Jazzy
HERE = Path(__file__).parent
LIBRARIES = {"ros1": "rospy", "ros2": "rclpy"}
NAMES = {"ros1": "std_msgs/Float64", "ros2": "std_msgs/msg/Float64"}
STEPS = 10


def probes(generation: str) -> list[Path]:
    """Return the probes of a ROS generation."""
    return sorted((HERE / generation).glob("*.py"))


def expected(generation: str) -> dict[str, list[str]]:
    """Return the recorded results of the real ROS by probe."""
    found: dict[str, list[str]] = json.loads((HERE / f"{generation}.json").read_text("utf-8"))
    return found


def installed(generation: str) -> bool:
    """Return whether the real ROS is installed."""
    return PathFinder.find_spec(LIBRARIES[generation]) is not None


def answers(probe: Path, kind: str) -> list[str]:
    """Run a probe for `STEPS` steps, with a number published on /in in each; return its output."""
    said: list[str] = []

    def say(*values: Any) -> None:
        said.append(" ".join(str(value) for value in values))

    def program() -> None:
        exec(compile(probe.read_text("utf-8"), str(probe), "exec"), {"__name__": "__main__", "say": say})

    number = message_type(NAMES[probe.parent.name])
    ros = make_ros(kind, [probe])
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()), ros.installed():
        warnings.simplefilter("ignore")
        try:
            ros.start(program, name="prober")
            for step in range(STEPS):
                ros.bus.publish("/in", number(data=float(step)))
                ros.step(0.1)
        except NodeError as error:
            said.append(f"ended in {type(error.__cause__).__name__}: {error.__cause__}")
        finally:
            ros.close()
    return said


def main() -> None:
    """Record the results of every installed real ROS."""
    for generation in LIBRARIES:
        if installed(generation):
            found = {probe.stem: answers(probe, "real") for probe in probes(generation)}
            text = json.dumps(found, indent=1, ensure_ascii=False) + "\n"
            (HERE / f"{generation}.json").write_text(text, "utf-8")
            print(f"wrote {generation}.json", file=sys.stderr)


if __name__ == "__main__":
    main()
