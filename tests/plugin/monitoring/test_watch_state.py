"""The state of a watch: interruptions and restarts do not change the evidence."""

from __future__ import annotations

import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl.errors import MonitorError, TarlError
from pytest_tarl.monitoring import watch, watch_state
from pytest_tarl.monitoring.watch import Watch
from tests.plugin.monitoring.missions import fixture, log, walks
from tests.slow import SLOW, chance

TIMES = 30 if SLOW else 4


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a recording and two logs, one of which drifts in its second half."""
    root = tmp_path_factory.mktemp("state")
    fixture(root / "f.npz", walks(60, 1))
    log(root / "a.log", [*walks(60, 2), *walks(40, 3, drift=1.0)])
    log(root / "b.log", walks(80, 4), first=1990.5, time=990.0)
    return root


def begun(root: Path, kept: Path, **changes: float) -> Watch:
    options = {"alpha": 0.05, "seed": 0, **changes}
    logs = [root / "a.log", root / "b.log"]
    return watch.begun(logs, root / "f.npz", kept, alpha=options["alpha"], seed=int(options["seed"]))


def read(watched: Watch) -> bytes:
    for _ in watched.poll():
        pass
    watched.save()
    watched.close()
    return watched.path.read_bytes()


@settings(max_examples=15)
@given(ends=st.lists(st.integers(1, 30), max_size=6))
def test_resumed_watch_ends_with_the_same_bytes(world: Path, ends: list[int]) -> None:
    whole = read(begun(world, world / "whole.npz"))
    (world / "whole.npz").unlink()
    with pytest.MonkeyPatch.context() as patch:
        for end in ends:
            patch.setattr(watch, "PORTION", end)
            watched = begun(world, world / "parts.npz")
            for _ in watched.poll():
                watched.save()
                break
            watched.close()
        patch.undo()
    assert read(begun(world, world / "parts.npz")) == whole
    (world / "parts.npz").unlink()


def test_state_is_saved_only_after_new_missions(
    world: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    saves: list[int] = []
    watched = begun(world, tmp_path / "s.npz")
    monkeypatch.setattr(Watch, "save", lambda self: saves.append(self.monitor.counts.missions))
    assert len([*watched.poll()]) == 1
    assert saves == [180]
    assert [*watched.poll()] == []
    assert saves == [180]
    watched.close()


def test_a_long_run_saves_the_state_after_each_second(
    world: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    saves: list[int] = []
    watched = begun(world, tmp_path / "s.npz")
    monkeypatch.setattr(Watch, "save", lambda self: saves.append(self.monitor.counts.missions))
    monkeypatch.setattr(watch, "PORTION", 60)
    # begun at 10 s; portions end at 11 s (not later than one second), 11.5 s (saved, then 12 s), and 13 s
    clock = iter([10.0, 11.0, 11.5, 12.0, 13.0])
    monkeypatch.setattr(watch, "monotonic", lambda: next(clock))
    assert len([*watched.poll()]) == 3
    assert saves == [120, 180]
    watched.close()


def test_the_seed_decides_how_ties_are_broken(world: Path, tmp_path: Path) -> None:
    first, second = (begun(world, tmp_path / f"{seed}.npz", seed=seed) for seed in (0, 1))
    read(first)
    read(second)
    assert not np.array_equal(first.monitor.processes.stake, second.monitor.processes.stake)


def test_saved_state_of_another_recording_is_refused(world: Path, tmp_path: Path) -> None:
    read(begun(world, tmp_path / "s.npz"))
    for changes, says in (({"alpha": 0.1}, "begun with --alpha 0.05"), ({"seed": 3}, "begun with --seed 0")):
        with pytest.raises(MonitorError, match=says):
            begun(world, tmp_path / "s.npz", **changes)
    other = tmp_path / "other"
    other.mkdir()
    fixture(other / "f.npz", walks(60, 9))
    with pytest.raises(MonitorError, match="another recording of the test"):
        watch.begun([world / "a.log"], other / "f.npz", tmp_path / "s.npz", alpha=0.05, seed=0)


@settings(max_examples=60)
@given(data=st.data())
def test_a_damaged_state_is_reported_in_one_sentence(world: Path, data: st.DataObject) -> None:
    path = world / "damaged.npz"
    path.unlink(missing_ok=True)
    whole = bytearray(
        read(begun(world, path)) if not (world / "good.npz").exists() else (world / "good.npz").read_bytes()
    )
    (world / "good.npz").write_bytes(whole)
    place = data.draw(st.integers(0, len(whole) - 1))
    damaged = whole[:place] if data.draw(st.booleans()) else [*whole]
    if len(damaged) == len(whole):
        damaged[place] ^= data.draw(st.integers(1, 255))
    path.write_bytes(bytes(damaged))
    with suppress(TarlError):  # other exceptions fail the test; unused bytes may change without an error
        begun(world, path).close()


def test_two_watches_cannot_share_a_state(tmp_path: Path) -> None:
    with (
        watch_state.locked(tmp_path / "s.npz"),
        pytest.raises(MonitorError, match="in use by another watch"),
        watch_state.locked(tmp_path / "s.npz"),
    ):
        pass
    with watch_state.locked(tmp_path / "s.npz"):
        pass


def test_killed_and_restarted_watch_saves_the_same_bytes(world: Path, tmp_path: Path) -> None:
    """After `kill -9` at any time while the log grows, the state may lack the last missions but is valid."""
    path, whole = tmp_path / "m.log", (world / "a.log").read_bytes()
    command = [
        sys.executable,
        "-m",
        "pytest_tarl",
        "watch",
        str(path),
        "--fixture",
        str(world / "f.npz"),
        "--state",
    ]
    path.write_bytes(whole)
    subprocess.run([*command, str(tmp_path / "once.npz"), "--once"], check=False, capture_output=True)
    moments = chance(7)
    path.unlink()
    for n in range(TIMES):
        grown = whole[: (n + 1) * len(whole) // TIMES]
        with path.open("ab") as file:
            file.write(grown[path.stat().st_size :])
        run = subprocess.Popen(
            [*command, str(tmp_path / "killed.npz"), "--interval", "0.01"], stdout=subprocess.DEVNULL
        )
        time.sleep(moments.uniform(0.2, 1.5))
        run.kill()
        run.wait()
    done = subprocess.run(
        [*command, str(tmp_path / "killed.npz"), "--once"], check=False, capture_output=True
    )
    assert done.returncode == 1, done.stderr
    assert (tmp_path / "killed.npz").read_bytes() == (tmp_path / "once.npz").read_bytes()
