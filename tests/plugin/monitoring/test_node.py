"""A watch as a ROS node, on the in-process ROS of either generation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.commands.watch import Order, run
from pytest_tarl.errors import SettingsError
from pytest_tarl.ros import Ros
from tests.plugin.monitoring.missions import content, fixture, log, walks


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    fixture(tmp_path / "f.npz", walks(80, 1))
    return tmp_path


def watching(root: Path, library: str, after: list[bytes]) -> list[Any]:
    """Run the node on a log that grows every two seconds; return the published statuses."""
    heard: list[Any] = []
    ros = Ros()
    order = Order((root / "m.log",), root / "f.npz", root / f"{library}.npz", ros=library, interval=1.0)
    with ros.installed():
        ros.on_delivery(lambda topic, message: heard.append(message) if topic == "/diagnostics" else None)
        ros.start(lambda: run(order) and None, name="watch")
        for more in after:
            with (root / "m.log").open("ab") as file:
                file.write(more)
            ros.step(2.0)
        ros.close()
    return heard


@pytest.mark.parametrize("library", ["rospy", "rclpy"])
def test_node_publishes_ok_and_then_a_changed_world(root: Path, library: str) -> None:
    log(root / "m.log", walks(100, 2))
    heard = watching(root, library, [b"", content(walks(50, 3, drift=1.0))])
    assert len(heard) >= 4
    first, last = heard[0].status[0], heard[-1].status[0]
    level = (lambda one: one.level[0]) if library == "rclpy" else (lambda one: one.level)
    assert (level(first), level(last)) == (0, 2)
    assert first.name == "tarl: test_walk.py::test_walk"
    assert first.message.startswith("100 missions, 100 passed (100 %); success bound: evidence")
    values = {one.key: one.value for one in last.values}
    assert values["missions"] == "150"
    assert values["where"].startswith("x 2-3")
    assert 101 <= int(values["world.alarm"]) < 130
    assert float(values["success.log10_evidence"]) > 1.3
    assert heard[-1].header.stamp != heard[0].header.stamp


def test_the_error_about_a_missing_library_names_the_library(root: Path) -> None:
    log(root / "m.log", walks(3, 2))
    order = Order((root / "m.log",), root / "f.npz", root / "s.npz", ros="rospy")
    with pytest.raises(SettingsError, match="--diagnostics rospy needs rospy, which is not installed"):
        run(order)
