"""Markers and flags: every mistake gives a sentence with advice."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.designation import designation
from pytest_tarl.errors import SettingsError
from pytest_tarl.options import options

GOOD: dict[str, Any] = {"nodes": ["a.py"], "sensors": [Sensor("x")]}
FLAGS: dict[str, Any] = {
    "record": False,
    "online": True,
    "repair": False,
    "drift": None,
    "edit": "auto",
    "constants": False,
    "seed": 0,
    "episodes": None,
    "alpha": 0.05,
    "search": None,
    "budget": 300,
    "utility": "batch",
    "workers": "1",
    "cluster": None,
    "ros": "embedded",
    "log": None,
    "bag": None,
    "holm": False,
    "localize": None,
    "looks": None,
    "strict": False,
    "stress": False,
    "stress-budget": 1000,
    "resume": False,
    "total": None,
}


def test_a_valid_marker_has_default_values() -> None:
    marked = designation("t.py::test", (), GOOD | {"drifts": {"mud": 0.15}})
    assert (marked.episodes, marked.min_success, marked.tolerance) == (200, 1.0, None)
    assert marked.drifts == {"mud": Drift(0.15)}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"nodes": "a.py"}, r"nodes=\["),
        ({"nodes": []}, r"nodes=\["),
        ({"sensors": []}, "declare the inputs of the node"),
        ({"sensors": ["x"]}, "declare the inputs of the node"),
        ({"sensors": [Sensor("x"), Sensor("x")]}, "'x' is used twice"),
        ({"drifts": ["mud"]}, "drifts maps names"),
        ({"episodes": 0}, "episodes must be a whole number"),
        ({"episodes": 2.5}, "episodes must be a whole number"),
        ({"min_success": 1.5}, "min_success must be a number from 0 to 1"),
        ({"tolerance": -1}, "tolerance must be a number"),
        ({"sensor": []}, "did you mean 'sensors'"),
        ({"colour": 1}, "no argument 'colour'"),
    ],
)
def test_an_invalid_marker_is_reported_in_one_sentence(change: dict[str, Any], words: str) -> None:
    with pytest.raises(SettingsError, match=words) as raised:
        designation("t.py::test", (), GOOD | change)
    assert str(raised.value).startswith("t.py::test")


@pytest.mark.parametrize(
    ("name", "least", "most", "beyond"),
    [
        ("episodes", 2, 1_000_000, (1, 1_000_001)),
        ("min_success", 0, 1, (-0.001, 1.001)),
        ("tolerance", 0, 1e300, (-1e-300, float("inf"))),
    ],
)
def test_marker_numbers_may_equal_their_limits(
    name: str, least: float, most: float, beyond: tuple[float, float]
) -> None:
    for value in (least, most):
        assert getattr(designation("here", (), GOOD | {name: value}), name) == value
    for value in beyond:
        with pytest.raises(SettingsError, match=f"here: {name} must be"):
            designation("here", (), GOOD | {name: value})


@pytest.mark.parametrize(("value", "accepted"), [(0.5, True), (1 - 1e-9, True), (0.499, False), (1.0, False)])
def test_confidence_is_between_one_half_and_one(value: float, accepted: bool) -> None:
    arguments = GOOD | {"confidence": value, "min_success": 0.9}
    if accepted:
        assert designation("here", (), arguments).confidence == value
    else:
        with pytest.raises(SettingsError, match="here: confidence must be"):
            designation("here", (), arguments)


def test_positional_arguments_are_refused() -> None:
    with pytest.raises(SettingsError, match="named arguments only"):
        designation("t.py::test", (["a.py"],), GOOD)


@pytest.mark.parametrize(
    ("change", "mode"),
    [({}, "online"), ({"record": True, "online": False}, "record"), ({"repair": True}, "repair")],
)
def test_flags_select_the_mode(change: dict[str, Any], mode: str) -> None:
    assert options(FLAGS | change).mode == mode


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"record": True}, "need separate runs"),
        ({"online": False, "repair": True}, "needs --tarl-online"),
        ({"online": False, "drift": "mud"}, "needs --tarl-online"),
        ({"search": ["sweeep"]}, "did you mean 'sweep'"),
        ({"utility": "q"}, "batch or sarsa"),
        ({"alpha": 0.0}, "--tarl-alpha"),
        ({"budget": 0}, "--tarl-budget"),
        ({"episodes": 1}, "--tarl-episodes"),
    ],
)
def test_invalid_flags_are_reported_in_one_sentence(change: dict[str, Any], words: str) -> None:
    with pytest.raises(SettingsError, match=words):
        options(FLAGS | change)


@pytest.mark.parametrize(
    ("given", "name", "least", "most", "beyond"),
    [
        ({}, "episodes", 2, 1_000_000, (1, 1_000_001)),
        ({}, "looks", 1, 5, (0, 6)),
        ({}, "alpha", 1e-6, 0.5, (0.9e-6, 0.500001)),
        ({}, "budget", "1", "1000000", ("0", "1000001")),
        ({}, "stress-budget", "32", "1000000", ("31", "1000001")),
        ({}, "workers", "1", "1024", ("0", "1025")),
    ],
)
def test_flag_numbers_may_equal_their_limits(
    given: dict[str, Any], name: str, least: Any, most: Any, beyond: tuple[Any, Any]
) -> None:
    for value in (least, most):
        options(FLAGS | given | {name: value})
    for value in beyond:
        with pytest.raises(SettingsError, match=f"--tarl-{name}"):
            options(FLAGS | given | {name: value})


@pytest.mark.parametrize(
    ("name", "value"), [("nodes", 5), ("tolerance", float("inf")), ("tolerance", float("nan"))]
)
def test_values_out_of_range_are_refused_in_one_sentence(name: str, value: object) -> None:
    arguments = {"nodes": ["a.py"], "sensors": [Sensor("x")], name: value}
    with pytest.raises(SettingsError, match=r"^here: "):
        designation("here", (), arguments)


def test_workers_are_a_number_or_a_share_of_cores(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert options(FLAGS | {"workers": "3"}).workers == 3
    monkeypatch.setattr("os.sched_getaffinity", lambda _: range(8), raising=False)
    monkeypatch.delenv("PYTEST_XDIST_WORKER_COUNT", raising=False)
    assert options(FLAGS | {"workers": "auto"}).workers == 8
    monkeypatch.setenv("PYTEST_XDIST_WORKER_COUNT", "4")
    assert options(FLAGS | {"workers": "auto"}).workers == 2
    for wrong in ("0", "many", "-1"):
        with pytest.raises(SettingsError, match="--tarl-workers: it must be a whole number"):
            options(FLAGS | {"workers": wrong})
