"""A simulator in a process of its own: started, stepped, followed, reset, and ended, however it misbehaves."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.errors import SettingsError, SimulatorError, SimulatorLostError
from pytest_tarl.external.simulator import KEPT, Simulator, setup
from pytest_tarl.ros import Ros, message_type

pytestmark = pytest.mark.skipif(
    PathFinder.find_spec("rclpy") is None, reason="rclpy is not installed here: make test-ros2"
)
PROGRAM = Path(__file__).with_name("tank_simulator.py")
STEPPED = {"step": "/step", "every_step": ["/level"]}


@pytest.fixture(scope="module", autouse=True)
def guarded() -> Iterator[None]:
    """End the guardian after the tests of this file."""
    yield
    KEPT.close()


class Run:
    """An episode without nodes, whose test opens the valve by GAIN times what is missing."""

    def __init__(self, folder: Path, environment: dict[str, str] | None = None, **more: Any) -> None:
        self.ros = Ros()
        given: dict[str, Any] = {
            "clock": "/clock",
            "ready": ("/level", "/valve"),
            "step": None,
            "reset": None,
            "every_step": (),
            "timeout": 60.0,
            "patience": 20.0,
            **more,
        }
        command = given.pop("command", [sys.executable, str(PROGRAM)])
        arguments = setup(command, folder, environment=environment or {}, **given)
        self.simulator = Simulator(arguments, self.ros, [])
        self.levels: list[float] = []

    def __enter__(self) -> Run:
        try:
            self.simulator.begin()
        except BaseException:
            self.simulator.end()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self.simulator.end()

    def steps(self, count: int) -> list[float]:
        """Run some steps; return the levels after each."""
        valve = message_type("std_msgs/msg/Float64")
        for _ in range(count):
            level = self.simulator.latest("/level").data
            for forward in self.ros.bus.topic("/valve").listeners:
                forward(valve(data=2.0 * (1.0 - level)))
            self.simulator.advance(0.1)
            self.levels.append(self.simulator.latest("/level").data)
        return self.levels


def expected(count: int, pump: float = 1.0) -> list[float]:
    level, valve, found = 0.1, 0.0, []
    for step in range(count):
        valve = 2.0 * (1.0 - level) if step else 0.0  # the first command has no way yet
        level += 0.1 * pump * valve
        found.append(level)
    return found


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return "Z" not in Path(f"/proc/{pid}/stat").read_text().split(")")[-1].split()[0]


def gone(pids: list[int]) -> bool:
    """Return whether all processes end within ten seconds."""
    deadline = time.monotonic() + 10
    while any(map(alive, pids)) and time.monotonic() < deadline:
        time.sleep(0.02)
    return not any(map(alive, pids))


@pytest.mark.parametrize("fault", ["", "late", "slow 1.5"])
def test_a_stepped_simulator_is_reproducible_even_if_it_is_slow_or_late(tmp_path: Path, fault: str) -> None:
    with Run(tmp_path, {"FAULT": fault}, **STEPPED) as run:
        began = run.ros.scheduler.time
        assert run.steps(6) == expected(6)
        assert run.ros.scheduler.time - began == 600_000_000


def test_nodes_are_held_to_the_clock_of_a_simulator_in_its_own_time(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with Run(tmp_path, {"OWN_TIME": "1"}) as run:
        levels = run.steps(30)
        assert max(levels) > 0.5
        assert run.ros.scheduler.time >= 3_000_000_000
        assert run.ros.scheduler.time == round(run.simulator.clock * 1e9)
    assert "filling" in capsys.readouterr().out


def test_a_reset_keeps_the_process_and_starts_anew(tmp_path: Path) -> None:
    found = []
    for _ in range(2):
        child = tmp_path / "pids"
        with Run(tmp_path, {"CHILD": str(child)}, reset="/reset", **STEPPED) as run:
            found.append((run.steps(4), child.read_text()))
    assert found[0] == found[1]
    KEPT.close()
    assert gone([*map(int, found[0][1].split())])


@pytest.mark.parametrize(
    ("fault", "more", "error", "said"),
    [
        (
            "refuse",
            {},
            SimulatorError,
            "ended with status 1 before it was ready; its last output: no such world",
        ),
        (
            "silent",
            {"timeout": 4.0},
            SimulatorError,
            r"was not ready after 4 s: no message on /level; it publishes ",
        ),
        (
            "die 3",
            {},
            SimulatorLostError,
            "ended with status 3 at 0.3 s of its time; its last output: .*out of water",
        ),
        ("hang 3", {"patience": 1.0}, SimulatorLostError, "did not answer on /step within 1 s"),
    ],
)
def test_a_simulator_that_fails_is_described(
    tmp_path: Path, fault: str, more: dict[str, Any], error: type[Exception], said: str
) -> None:
    child = tmp_path / "pids"
    with (
        pytest.raises(error, match=said),
        Run(tmp_path, {"FAULT": fault, "CHILD": str(child)}, **STEPPED, **more) as run,
    ):
        run.steps(9)
    if child.exists():
        assert gone([*map(int, child.read_text().split())])


@pytest.mark.parametrize(
    ("fault", "said"), [("hang 5", "hung at .* nothing new came within 1 s"), ("jump 5", "went back from")]
)
def test_a_followed_simulator_that_stops_or_jumps_is_described(tmp_path: Path, fault: str, said: str) -> None:
    with (
        pytest.raises(SimulatorLostError, match=said),
        Run(tmp_path, {"FAULT": fault, "OWN_TIME": "1"}, patience=1.0) as run,
    ):
        run.steps(50)


def test_a_missing_program_is_described(tmp_path: Path) -> None:
    with (
        pytest.raises(SimulatorError, match=r"cannot be started \(No such file or directory\)"),
        Run(tmp_path, command="no-such-simulator --world 3"),
    ):
        pass
    with pytest.raises(SettingsError, match="needs a command and a topic"):
        Run(tmp_path, command="")


def test_no_process_survives_a_killed_test(tmp_path: Path) -> None:
    child = tmp_path / "pids"
    program = (
        "import sys; from pathlib import Path; from tests.realros.external.test_simulator import Run, STEPPED\n"
        f"with Run(Path({str(tmp_path)!r}), {{'CHILD': {str(child)!r}}}, **STEPPED) as run:\n"
        "    run.steps(2); print('ran', flush=True); sys.stdin.read()\n"
    )
    root = Path(__file__).parents[3]
    with subprocess.Popen(
        [sys.executable, "-c", program], cwd=root, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as test:
        assert test.stdout is not None
        assert test.stdout.readline() == b"ran\n"
        pids = [*map(int, child.read_text().split())]
        assert all(map(alive, pids))
        test.send_signal(signal.SIGKILL)
    assert gone(pids)
