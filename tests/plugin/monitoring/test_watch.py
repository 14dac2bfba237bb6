"""The command `tarl watch`: its output, exit codes and files."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jsonschema import validate

from pytest_tarl.commands.cli import main
from pytest_tarl.learning.bounds import Range
from pytest_tarl.monitoring import dashboard, monitor, watch
from pytest_tarl.monitoring.log_reader import LogReader
from tests.plugin.monitoring.missions import Walk, content, fixture, log, walks


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory, which contains only the recording of a small world."""
    monkeypatch.chdir(tmp_path)
    fixture(tmp_path / "f.npz", walks(80, 1))
    return tmp_path


def test_missions_in_the_recorded_world_raise_no_alarm(
    root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log(root / "m.log", walks(200, 2))
    assert main(["watch", "m.log", "--fixture", "f.npz", "--once"]) == 0
    out = capsys.readouterr().out
    assert "200 missions, 200 passed (100 %)" in out
    assert "at least 96.3 % of missions pass (95 % confidence): evidence" in out
    assert (
        "probability that this watch ever raises a false alarm: at most 5 % (alpha); 10 % including the 5 % risk"
        in out
    )
    assert "ALARM" not in out
    assert "where" not in out
    assert (root / ".tarl/watch/f.npz").exists()


def test_drift_raises_an_alarm_with_onset_and_cells(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log(root / "m.log", [*walks(300, 2), *walks(60, 3, drift=1.0)])
    assert main(["watch", "m.log", "--fixture", "f.npz", "--once", "--json", "-"]) == 1
    found = json.loads(capsys.readouterr().out)
    validate(found, dashboard.schema())
    assert abs(found["world"]["evidence"]["since"]["mission"] - 301) < 10
    assert 301 <= found["world"]["evidence"]["alarm"]["mission"] < 330
    assert 301 <= found["bounds"][0]["evidence"]["alarm"]["mission"] < 340
    assert {cell[0] for cell in found["where"]["cells"]} == {2}
    assert found["where"]["words"] == "x 2-3"
    assert main(["watch", "m.log", "--fixture", "f.npz", "--once"]) == 1
    out = capsys.readouterr().out
    assert "360 missions" in out  # no mission is counted twice
    assert "where   x 2-3" in out


def test_new_cells_are_reported(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    elsewhere = [Walk((*one.cells, (3, 5)), (*one.reward, 1.0), True) for one in walks(30, 4)]
    log(root / "m.log", elsewhere)
    assert main(["watch", "m.log", "--fixture", "f.npz", "--once"]) == 1
    assert "new     x 3-4, wet 5: no recorded episode visited it" in capsys.readouterr().out


def test_logs_of_other_worlds_are_reported(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log(root / "m.log", walks(5, 2))
    log(root / "other.log", walks(5, 2), sensors=["speed"])
    assert main(["watch", "m.log", "other.log", "none.log", "--fixture", "f.npz", "--once"]) == 2
    said = capsys.readouterr()
    assert "5 missions" in said.out
    assert "other.log was written with the sensors speed, but the recording of" in said.err
    assert "none.log does not exist yet" in said.err


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--alpha", "1.5"], "--alpha must be a probability between 0 and 1"),
        (["--interval", "0"], "--interval must be a number of seconds above 0"),
        (["--once", "--until-alarm"], "--once reads the logs once and ends"),
        (["--once", "--state", "."], "The state . is a folder: name a file with --state."),
        (["--once", "--json", "m.log"], "--json m.log would overwrite an input file"),
        (["--once", "--fixture", "none.npz"], "none.npz: no such recording"),
        (["--once", "--state", "f.npz"], "The state f.npz is damaged or not a state of `tarl watch`"),
        (["--once", "--state", "f.npz/s"], "cannot be written"),
        (["--once", "--json", "f.npz/s"], "f.npz/s cannot be written"),
    ],
)
def test_invalid_arguments_are_reported_in_one_sentence(
    root: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], says: str
) -> None:
    log(root / "m.log", walks(5, 2))
    before = (root / "f.npz").read_bytes()
    assert main(["watch", "m.log", "--fixture", "f.npz", *arguments]) == 2
    assert says in capsys.readouterr().err
    assert (root / "f.npz").read_bytes() == before


def test_failed_recording_has_no_bound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    fixture(tmp_path / "f.npz", [Walk(one.cells, one.reward, False) for one in walks(40, 1)])
    log(tmp_path / "m.log", walks(20, 2))
    assert main(["watch", "m.log", "--fixture", "f.npz", "--once"]) == 1  # only recorded ones fail
    out = capsys.readouterr().out
    assert "at least 0 % of missions pass (95 % confidence): nothing to test" in out
    assert "ever raises a false alarm: at most 5 % (alpha)\n" in out


def test_missions_without_rewards_or_steps_are_reported(
    root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    some = walks(6, 2)
    unjudged = [Walk(one.cells, (float("nan"),) * len(one.cells), True) for one in some]
    log(root / "m.log", [*unjudged, Walk((), (), True)])
    assert main(["watch", "m.log", "--fixture", "f.npz", "--once"]) == 0
    out = capsys.readouterr().out
    assert "6 missions without rewards" in out
    assert "1 mission without a step" in out


def started(root: Path, *arguments: str) -> subprocess.Popen[str]:
    command = [
        sys.executable,
        "-m",
        "pytest_tarl",
        "watch",
        "m.log",
        "--fixture",
        "f.npz",
        "--interval",
        "0.02",
    ]
    return subprocess.Popen(
        [*command, *arguments], cwd=root, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def until(what: object, process: subprocess.Popen[str]) -> None:
    """Wait until a call returns something true; fails if the watch ends early."""
    for _ in range(3000):
        if what():  # type: ignore[operator]
            return
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)
    raise AssertionError(process.kill() or process.communicate())


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_watch_follows_a_growing_log_until_a_signal(root: Path, number: signal.Signals) -> None:
    process = started(root, "--json", "w.json")

    def missions() -> int:
        return int(json.loads((root / "w.json").read_text())["missions"]) if (root / "w.json").exists() else 0

    log(root / "m.log", walks(20, 2))
    until(lambda: missions() == 20, process)
    with (root / "m.log").open("ab") as file:
        file.write(content(walks(10, 3)))
    until(lambda: missions() == 30, process)
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    assert "30 missions" in out
    assert "Traceback" not in err
    validate(json.loads((root / "w.json").read_text()), dashboard.schema())


def test_until_alarm_exits_at_the_first_alarm(root: Path) -> None:
    log(root / "m.log", walks(60, 3, drift=1.0))
    process = started(root, "--until-alarm")
    out, err = process.communicate(timeout=60)
    assert process.returncode == 1, err
    assert "ALARM with mission" in out
    assert "most of all" in out


def test_a_closed_output_ends_the_watch_without_a_traceback(root: Path) -> None:
    log(root / "m.log", walks(5, 2))
    command = f"{sys.executable} -m pytest_tarl watch m.log --fixture f.npz --once | true"
    done = subprocess.run(
        command, shell=True, cwd=root, capture_output=True, text=True, check=False, env={**os.environ}
    )
    assert "Traceback" not in done.stderr


def test_the_mean_is_tested_if_a_range_was_declared(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fixture(root / "g.npz", walks(200, 1), Range(0.0, 12.0))
    less = [replace(one, reward=tuple(0.6 * amount for amount in one.reward)) for one in walks(300, 3)]
    log(root / "same.log", walks(300, 4))
    log(root / "less.log", less)
    assert main(["watch", "same.log", "--fixture", "g.npz", "--once", "--state", "same.npz"]) == 0
    assert (
        main(["watch", "less.log", "--fixture", "g.npz", "--once", "--state", "less.npz", "--json", "-"]) == 1
    )
    said, _, document = capsys.readouterr().out.rpartition("\n{")
    assert "a mission earns at least 5." in said
    assert "15 % including the 5 % and 5 % risk that the bounds themselves are wrong" in said
    success, total = json.loads("{" + document)["bounds"]
    assert (success["of"], total["of"]) == ("success", "total")
    assert success["evidence"]["alarm"] is None
    assert total["evidence"]["alarm"]["mission"] < 200


def test_totals_outside_the_declared_range_are_reported(
    root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fixture(root / "g.npz", walks(80, 1), Range(0.0, 12.0))
    one = walks(1, 3)[0]
    log(root / "m.log", [replace(one, reward=(-100.0,) * len(one.cells)), one])
    main(["watch", "m.log", "--fixture", "g.npz", "--once"])
    assert "1 mission with a total outside the declared range: clipped to its ends" in capsys.readouterr().out


def test_a_recording_of_equal_episodes_has_no_bound(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fixture(root / "g.npz", walks(1, 1) * 80, varied=False)
    log(root / "m.log", walks(1, 1) * 200)
    assert main(["watch", "m.log", "--fixture", "g.npz", "--once"]) == 0
    out = capsys.readouterr().out
    assert "episodes of the recording are equal, so it has no bound to test" in out
    assert "ever raises a false alarm: at most 5 % (alpha)\n" in out


def test_bounds_are_printed_before_the_first_mission(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log(root / "m.log", [])
    assert main(["watch", "m.log", "--fixture", "f.npz", "--once"]) == 0
    out = capsys.readouterr().out
    assert "0 missions, 0 passed\n" in out
    assert "evidence 0.5, alarm at 20" in out
    assert "10 % including the 5 % risk" in out


@pytest.mark.parametrize("time", [float("nan"), float("inf"), -1e300, 1e300, 0.0])
def test_a_wrong_clock_does_not_stop_the_watch(
    root: Path, capsys: pytest.CaptureFixture[str], time: float
) -> None:
    log(root / "m.log", walks(20, 3, drift=1.0), first=time)
    assert main(["watch", "m.log", "--fixture", "f.npz", "--once"]) == 1
    assert "ALARM with mission" in capsys.readouterr().out


def test_a_log_named_twice_is_refused(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log(root / "m.log", walks(5, 2))
    assert main(["watch", "m.log", "./m.log", "--fixture", "f.npz", "--once"]) == 2
    assert "m.log is named twice: name each log once." in capsys.readouterr().err


def test_false_alarms_are_rarer_than_alpha_over_fresh_recordings(tmp_path: Path) -> None:
    """Run 60 short watches at α = 30 %, each with its own recording."""
    alarms = 0
    rng = np.random.default_rng(0)
    for life in range(60):
        seeds = rng.integers(2**31, size=2).tolist()
        recorded = fixture(tmp_path / "f.npz", walks(24, seeds[0]))
        watched = monitor.begun(recorded, alpha=0.3, seed=life)
        reader = LogReader(
            log(tmp_path / f"{life}.log", walks(60, seeds[1])), watch.expectation(recorded, watched), {}, {}
        )
        watched.observe(watch.joined(list(reader.missions())))
        reader.close()
        alarms += bool((watched.processes.alarm >= 0).any())
    assert alarms <= 25  # at most 18 expected, plus two standard errors
