"""Whether an ended episode can be used, and the notes about one that can."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.ended_episode import EndedEpisode
from pytest_tarl.errors import RecordingError, SettingsError
from pytest_tarl.faults.installing import NO_FAULTS, Faults
from pytest_tarl.formulas.marker_arguments import NOTHING_REQUIRED, Requirements

HEARD: Any = SimpleNamespace(silent=False, subscribed={"/odom", "/joy"}, shutdown_errors=(), notes=())
SILENT: Any = SimpleNamespace(silent=True, subscribed={"/odom", "/joy"}, shutdown_errors=(), notes=())
DEAF: Any = SimpleNamespace(silent=True, subscribed=set(), shutdown_errors=(), notes=())
SOUND: Any = SimpleNamespace(problem=lambda: None)
UNKNOWN: Any = SimpleNamespace(problem=lambda: RecordingError("Sensor 'x' received no message."))


def ended(**changed: Any) -> EndedEpisode:
    """Return an episode with a reward and a node that published, except for what is given."""
    usual = EndedEpisode(
        rewards=1,
        requirements=NOTHING_REQUIRED,
        situation=SOUND,
        faults=NO_FAULTS,
        drifted=False,
        changed=False,
        ros=HEARD,
        drives_ros=True,
        replay=None,
        unrecorded={},
    )
    return replace(usual, **changed)


def problem(**changed: Any) -> str:
    return str(ended(**changed).problem() or "")


def refusing(_: Any) -> Any:
    raise SettingsError("the fault 'bias' names /scan, which never occurred.")


class Refusing:
    """A fault whose topic never occurs."""

    def check(self, *_: Any) -> None:
        refusing(None)


FAULTS = Faults({"bias": Refusing()})  # type: ignore[dict-item]
ACTIVE = Faults({"bias": Refusing()}, {"bias": (Refusing(), 1.0)})  # type: ignore[dict-item]


def test_rewarded_publishing_episode_is_usable() -> None:
    assert ended().problem() is None
    assert ended().notes() == ()


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"rewards": 0}, "never called tarl.reward"),
        ({"rewards": 0, "requirements": Requirements(rewarding=True)}, "never called tarl.step"),
        ({"rewards": 0, "drifted": True}, "never called tarl.reward"),
        ({"rewards": 0, "situation": UNKNOWN}, "never called tarl.reward"),
        ({"situation": UNKNOWN, "faults": FAULTS, "ros": SILENT}, "the fault 'bias'"),
        ({"faults": FAULTS, "ros": SILENT}, "the fault 'bias'"),
    ],
)
def test_first_reason_of_an_unusable_episode_is_reported(changed: dict[str, Any], words: str) -> None:
    assert re.search(words, problem(**changed))


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"situation": UNKNOWN}, "Sensor 'x'"),
        ({"situation": UNKNOWN, "ros": SILENT}, "Sensor 'x'"),
        ({"ros": SILENT}, "published nothing in the whole episode.*it subscribes to /joy, /odom"),
        ({"ros": DEAF}, "it subscribes to no topic"),
        ({"situation": UNKNOWN, "changed": True, "ros": SILENT}, "Sensor 'x'"),
    ],
)
def test_silent_sensor_is_reported(changed: dict[str, Any], words: str) -> None:
    assert problem(**changed) == ""
    assert re.search(words, ended(**changed).silence())


@pytest.mark.parametrize(
    "changed",
    [
        {"requirements": Requirements(rewarding=True)},
        {"drifted": True, "ros": SILENT, "situation": UNKNOWN, "faults": FAULTS},
        {"ros": SILENT, "drives_ros": False},
        {"ros": SILENT, "changed": True},
        {"ros": None},
        {"ros": None, "faults": FAULTS},
        {"faults": ACTIVE},
    ],
)
def test_missing_output_under_a_drift_is_no_error(
    changed: dict[str, Any],
) -> None:
    assert problem(**changed) == ended(**changed).silence() == ""


def replay(begun: bool) -> Any:
    return SimpleNamespace(
        begun=begun, notes=("2 messages were skipped.",), bag=SimpleNamespace(path=Path("bags/mission.bag"))
    )


def test_a_replayed_mission_needs_a_step_and_a_reward() -> None:
    silent = {"ros": SILENT, "situation": UNKNOWN}
    assert problem(replay=replay(False), rewards=0).startswith("mission.bag was not replayed")
    assert problem(replay=replay(True), rewards=0).startswith("Nothing was learned from mission.bag")
    assert problem(replay=replay(True), **silent) == ended(replay=replay(True), **silent).silence() == ""


def test_silenced_node_is_noted_unless_a_fault_is_declared() -> None:
    (note,) = ended(drifted=True, ros=SILENT).notes()
    assert "published nothing in a whole episode of this drift" in note
    assert "it subscribes to /joy, /odom" in note
    assert ended(ros=SILENT).notes() == ()
    assert ended(drifted=True).notes() == ()
    assert ended(drifted=True, ros=SILENT, faults=ACTIVE).notes() == ()
    assert ended(drifted=True, ros=SILENT, drives_ros=False).notes() == ()


def test_notes_have_a_fixed_order() -> None:
    ros: Any = SimpleNamespace(
        silent=True,
        subscribed=(),
        shutdown_errors=("Node '/a' raised KeyError.",),
        notes=("No launch file.",),
    )
    unrecorded = {Path("src/node.py"): ((9, 5), (12, 1), (9, 1)), Path("b.py"): ((1, 1),)}
    found = ended(ros=ros, unrecorded=unrecorded, replay=replay(True), drifted=True).notes()
    assert [one[:32] for one in found] == [
        "Node '/a' raised KeyError. The n",
        "cannot record node.py:9, 12: sli",
        "cannot record b.py:1: slices of ",
        "No launch file.",
        "2 messages were skipped.",
        "The node published nothing in a ",
    ]
    assert ended(ros=None).notes() == ()
