"""A simulator in a separate process is started, stepped, followed, reset and ended, even if it is faulty."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.errors import SettingsError, SimulatorError, SimulatorLostError
from pytest_tarl.external.arguments import setup
from pytest_tarl.external.simulator import KEPT, Simulator
from pytest_tarl.ros import Ros, message_type
from tests.held import comes_free, held

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
    """An episode without nodes, whose test opens the valve by GAIN times the missing level."""

    def __init__(self, folder: Path, environment: dict[str, str] | None = None, **more: Any) -> None:
        self.ros = Ros()
        given: dict[str, Any] = {
            "clock": "/clock",
            "ready": ("/level", "/valve"),
            "step": None,
            "reset": None,
            "every_step": (),
            "timeout": 600.0,  # s; long enough for a busy machine
            "patience": 300.0,
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
        valve = 2.0 * (1.0 - level) if step else 0.0  # no connection yet for the first command
        level += 0.1 * pump * valve
        found.append(level)
    return found


@pytest.mark.parametrize("fault", ["", "late", "slow 1.5"])
def test_slow_stepped_simulator_is_reproducible(tmp_path: Path, fault: str) -> None:
    with Run(tmp_path, {"FAULT": fault}, **STEPPED) as run:
        began = run.ros.scheduler.time
        assert run.steps(6) == expected(6)
        assert run.ros.scheduler.time - began == 600_000_000


def test_nodes_follow_a_free_running_clock(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with Run(tmp_path, {"OWN_TIME": "1"}) as run:
        levels = run.steps(30)
        assert max(levels) > 0.5
        assert run.ros.scheduler.time >= 3_000_000_000
        assert run.ros.scheduler.time == round(run.simulator.clock * 1e9)
    assert "filling" in capsys.readouterr().out


def test_a_reset_keeps_the_process_and_restarts_the_simulation(tmp_path: Path) -> None:
    found, lock = [], tmp_path / "held"
    for _ in range(2):
        with Run(tmp_path, {"HELD": str(lock)}, reset="/reset", **STEPPED) as run:
            found.append((run.steps(4), lock.read_text()))
    assert found[0] == found[1]
    assert held(lock)
    KEPT.close()
    assert comes_free(lock)


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
    ],
)
def test_the_error_describes_how_a_simulator_failed(
    tmp_path: Path, fault: str, more: dict[str, Any], error: type[Exception], said: str
) -> None:
    lock = tmp_path / "held"
    with (
        pytest.raises(error, match=said),
        Run(tmp_path, {"FAULT": fault, "HELD": str(lock)}, **STEPPED, **more) as run,
    ):
        run.steps(9)
    assert comes_free(lock)


def test_the_error_describes_a_stepped_simulator_that_hangs(tmp_path: Path) -> None:
    lock = tmp_path / "held"
    with Run(tmp_path, {"FAULT": "hang 3", "HELD": str(lock)}, **STEPPED) as run:
        run.steps(2)
        run.simulator.setup = replace(run.simulator.setup, patience=1.0)
        with pytest.raises(SimulatorLostError, match="did not answer on /step within 1 s"):
            run.steps(1)
    assert comes_free(lock)


@pytest.mark.parametrize(
    ("fault", "patience", "said"),
    [("hang 5", 1.0, "hung at .* nothing new came within 1 s"), ("jump 5", 300.0, "went back from")],
)
def test_error_describes_a_stopped_clock(tmp_path: Path, fault: str, patience: float, said: str) -> None:
    with (
        pytest.raises(SimulatorLostError, match=said),
        Run(tmp_path, {"FAULT": fault, "OWN_TIME": "1"}, patience=patience) as run,
    ):
        run.steps(50)


def test_output_belongs_to_its_episode(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    last = "import atexit; atexit.register(print, 'drained')\n"
    program = tmp_path / "chatty.py"
    program.write_text(last + PROGRAM.read_text())
    for _ in range(2):
        with Run(tmp_path, command=[sys.executable, str(program)], **STEPPED) as run:
            run.steps(2)
        output = capfd.readouterr().out
        first, after, end = output.partition(" after TARL had ended it:\n")
        assert "filling" in first, output
        assert after, output
        assert end.strip() == "drained", output


def test_the_error_names_a_missing_simulator_program(tmp_path: Path) -> None:
    with (
        pytest.raises(SimulatorError, match=r"cannot be started \(No such file or directory\)"),
        Run(tmp_path, command="no-such-simulator --world 3"),
    ):
        pass
    with pytest.raises(SettingsError, match="needs a command and a topic"):
        Run(tmp_path, command="")


def test_no_process_survives_a_killed_test(tmp_path: Path) -> None:
    lock = tmp_path / "held"
    program = (
        "import sys; from pathlib import Path; from tests.realros.external.test_simulator import Run, STEPPED\n"
        f"with Run(Path({str(tmp_path)!r}), {{'HELD': {str(lock)!r}}}, **STEPPED) as run:\n"
        "    run.steps(2); print('ran', flush=True); sys.stdin.read()\n"
    )
    root = Path(__file__).parents[3]
    with subprocess.Popen(
        [sys.executable, "-c", program], cwd=root, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as test:
        assert test.stdout is not None
        assert test.stdout.readline() == b"ran\n"
        assert held(lock)
        test.kill()
    assert comes_free(lock)
