"""The command `tarl observe`: its arguments, and what it runs."""

from __future__ import annotations

import gc
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl import Sensor, Signal
from pytest_tarl.errors import AnalysisError, LogError
from pytest_tarl.observing import command
from pytest_tarl.observing.command import Order
from pytest_tarl.observing.listeners import Topics
from pytest_tarl.observing.writer import Rotation
from pytest_tarl.sensors import binning_digest

PLACE = Sensor("place", topic="/place", field="x", low=0, high=10, bins=5)
SPEED = Sensor("speed", topic="/speed", field="x", low=0, high=2, bins=2)


def order(folder: Path, **changes: Any) -> Order:
    return Order(**{"node": folder / "node.py", "reward": "/reward", **changes})


FIXTURE: Any = SimpleNamespace(
    sensors=(PLACE, SPEED),
    test="t.py::test_x",
    topics={"/place": "geometry_msgs/msg/Point"},
    signals=(Signal("tilt", topic="/t", field="x"), Signal("own")),
    sample=SimpleNamespace(judgements=None),
    lists=[SimpleNamespace(sites=[SimpleNamespace(path="src/node.py"), SimpleNamespace(path="other.py")])],
)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"node": Path("nowhere.py")}, r"nowhere.py: no such file"),
        ({"mission": "/m", "idle": 1.0}, "--mission-topic and --idle cannot be used together"),
        ({"reward": ""}, "Give either --reward-topic"),
        ({"step": 0.5}, "Give either --reward-topic"),
    ],
)
def test_contradicting_arguments_are_refused(tmp_path: Path, changes: dict[str, Any], says: str) -> None:
    (tmp_path / "node.py").write_text("")
    with pytest.raises(LogError, match=says):
        command._check(order(tmp_path, **changes))


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"mission": "/m"},
        {"idle": 0.0},
        {"idle": 1.0},
        {"reward": "", "step": 0.5},
        {"reward": "", "step": 0.0},
    ],
)
def test_other_combinations_of_arguments_are_accepted(tmp_path: Path, changes: dict[str, Any]) -> None:
    (tmp_path / "node.py").write_text("")
    command._check(order(tmp_path, **changes))


def test_the_only_recording_that_names_the_node_is_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    named = {"a": "node.py", "b": "other.py", "c": "deep/node.py"}
    monkeypatch.setattr(
        command,
        "load",
        lambda path: SimpleNamespace(
            lists=[SimpleNamespace(sites=[]), SimpleNamespace(sites=[SimpleNamespace(path=named[path.stem])])]
        ),
    )
    with pytest.raises(LogError, match=r"name node\.py: none\. Choose one with --fixture"):
        command._fixture_of(Path("src/node.py"))
    for name in ("a", "b"):
        (tmp_path / name / ".tarl/utility").mkdir(parents=True)
        (tmp_path / name / ".tarl/utility" / f"{name}.npz").write_bytes(b"")
    assert command._fixture_of(Path("src/node.py")) == tmp_path / "a/.tarl/utility/a.npz"
    (tmp_path / "a/.tarl/utility/c.npz").write_bytes(b"")
    with pytest.raises(
        LogError, match=r"node\.py: a/\.tarl/utility/a\.npz, a/\.tarl/utility/c\.npz\. Choose"
    ):
        command._fixture_of(Path("src/node.py"))


def test_types_of_topics_may_be_given_with_the_topic() -> None:
    found = command._topics(Order(Path("n.py"), reward="/r:own/msg/Reward", mission="/m"), FIXTURE)
    assert found == Topics(FIXTURE.topics, "/r", "/m", {"/r": "own/msg/Reward"})
    found = command._topics(Order(Path("n.py"), mission="/m:own/msg/Word:x"), FIXTURE)
    assert found == Topics(FIXTURE.topics, "", "/m", {"/m": "own/msg/Word:x"})


def test_the_observed_statements_are_the_statements_of_the_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    asked: list[Any] = []
    analysis = SimpleNamespace(flows=["one"])
    monkeypatch.setattr(command, "analyse", lambda paths, **how: asked.append((paths, how)) or analysis)
    monkeypatch.setattr(command, "plan", lambda given: ("plan of", given))
    found: Any = command._sites(Order(Path("node.py"), modules=(Path("lib.py"),)))
    assert found == ("plan of", analysis)
    assert asked == [([tmp_path / "node.py", tmp_path / "lib.py"], {"root": tmp_path, "with_settings": True})]
    analysis.flows = []
    with pytest.raises(AnalysisError, match=r"No flow .* in node\.py"):
        command._sites(Order(Path("node.py")))


class Watcher:
    """An observer that notes what happens around it."""

    log: list[Any]
    problem = ""

    def __init__(self, sensors: Any, log: Path, about: Any, **options: Any) -> None:
        self.given = (sensors, log, about, options)
        type(self).log.append(self)

    def close(self) -> None:
        self.log.append("close")
        self.problem = type(self).problem


@pytest.mark.parametrize("problem", ["", "Sensor 'place': odd"])
@pytest.mark.parametrize("how", ["reward", "step"])
@pytest.mark.parametrize("formulas", [False, True])
def test_observed_node_always_closes_its_observer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, problem: str, how: str, formulas: bool
) -> None:
    (tmp_path / "node.py").write_text("")
    kind = type("Kind", (Watcher,), {"log": [], "problem": problem})
    changes: dict[str, Any] = {"reward": "/reward"} if how == "reward" else {"reward": "", "step": 0.5}
    given = order(tmp_path, log=tmp_path / "log", log_size=9, log_keep=2, idle=3.0, **changes)
    fixture = SimpleNamespace(
        **{**vars(FIXTURE), "sample": SimpleNamespace(judgements=[] if formulas else None)}
    )
    sites: Any = SimpleNamespace(places=[SimpleNamespace(id="a"), SimpleNamespace(id="b")])
    monkeypatch.setattr(command, "Observer", kind)
    monkeypatch.setattr(command, "_fixture_of", lambda node: node)
    monkeypatch.setattr(command, "load", lambda path: fixture if path == given.node else None)
    monkeypatch.setattr(command, "_sites", lambda _: sites)
    monkeypatch.setattr(command, "libraries", lambda paths: iter(["rclpy", "rospy"]) if paths else None)

    class Inside:
        def __init__(self, *what: Any, **named: Any) -> None:
            kind.log.append((*what, named))  # type: ignore[attr-defined]

        def __enter__(self) -> None:
            kind.log.append("in")  # type: ignore[attr-defined]

        def __exit__(self, *_: Any) -> None:
            kind.log.append("out")  # type: ignore[attr-defined]

    monkeypatch.setattr(command, "watched", Inside)
    monkeypatch.setattr(command, "_steps", Inside)
    monkeypatch.setattr(command, "_run", lambda *what: kind.log.append("run"))  # type: ignore[attr-defined]
    said = command.observe(given)
    assert said == f"wrote {tmp_path / 'log'}" + (f"; {problem}" if problem else "")
    made, watching, entered, steps, *rest = kind.log  # type: ignore[attr-defined]
    assert [entered, *rest] == ["in", "in", "run", "out", "out", "close"]
    assert watching == ("rclpy", made, command._topics(given, fixture), {"idle": True})
    assert steps == (given, made, {})
    sensors, log, about, options = made.given
    assert (sensors, log) == (FIXTURE.sensors, tmp_path / "log")
    assert about == {
        "node": "node.py",
        "test": "t.py::test_x",
        "sensors": ["place", "speed"],
        "bins": binning_digest(FIXTURE.sensors),
        "sites": ["a", "b"],
        "judged": how == "step",
    }
    assert options == {
        "rotation": Rotation(9, 2),
        "idle": 3.0,
        "signals": [FIXTURE.signals[0]],
        "following": formulas,
    }


def test_a_node_without_a_ros_library_cannot_be_observed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "node.py").write_text("")
    monkeypatch.setattr(command, "load", lambda path: FIXTURE)
    monkeypatch.setattr(command, "_sites", lambda _: SimpleNamespace(places=[]))
    with pytest.raises(LogError, match="imports neither rospy nor rclpy"):
        command.observe(order(tmp_path, fixture=tmp_path / "x.npz", log=tmp_path / "log"))
    assert not (tmp_path / "log").exists()


@pytest.mark.parametrize("fails", [False, True])
def test_existing_objects_are_not_collected_while_the_node_runs(
    monkeypatch: pytest.MonkeyPatch, fails: bool
) -> None:
    calls: list[str] = []
    for name in ("collect", "freeze", "unfreeze"):
        monkeypatch.setattr(gc, name, lambda name=name: calls.append(name))
    try:
        with command._collected_before():
            calls.append("run")
            if fails:
                raise ValueError
    except ValueError:
        assert fails
    assert calls == ["collect", "freeze", "run", "unfreeze"]


@pytest.mark.parametrize("step", [None, 0.25])
def test_steps_close_at_an_interval_without_a_topic(
    monkeypatch: pytest.MonkeyPatch, step: float | None
) -> None:
    waits: list[float | None] = []
    rewards: list[float] = []

    class Over:
        """An event that is set after three waits, and a thread that runs at once."""

        def wait(self, seconds: float | None) -> bool:
            waits.append(seconds)
            return len(waits) > 3

        def set(self) -> None:
            waits.append(-1.0)

    joined: list[str] = []

    class Thread:
        def __init__(self, target: Callable[[], None], name: str, daemon: bool) -> None:
            self.target, self.alive = target, False
            assert daemon

        def start(self) -> None:
            self.alive = True
            self.target()

        def is_alive(self) -> bool:
            return self.alive

        def join(self) -> None:
            assert waits[-1] == -1.0  # it has been told to end
            joined.append("joined")

    monkeypatch.setattr(command.threading, "Event", Over)
    monkeypatch.setattr(command.threading, "Thread", Thread)
    observer: Any = SimpleNamespace(step=rewards.append)
    with command._steps(Order(Path("n.py"), step=step), observer):
        pass
    assert waits == ([-1.0] if step is None else [0.25] * 4 + [-1.0])
    assert [str(one) for one in rewards] == ([] if step is None else ["nan"] * 3)
    assert joined == ([] if step is None else ["joined"])
