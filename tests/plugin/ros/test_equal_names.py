"""Workspaces with equally named packages in one session: nodes and tests get the packages of their own workspace."""

from __future__ import annotations

import pickle
import runpy
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.ros import Ros
from pytest_tarl.ros.messages import find_class, node_workspaces, ros1, ros2
from pytest_tarl.ros.messages.field_values import FieldError
from pytest_tarl.ros.messages.known import Part
from pytest_tarl.ros.messages.package_modules import could_be_package
from pytest_tarl.ros.messages.type_definitions import Kind, type_names
from pytest_tarl.ros.packages import get_package_share_directory
from pytest_tarl.ros.siblings import generated
from pytest_tarl.ros.uninstalled import candidates
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.read import read as original
from tests.plugin.ros.test_workspaces import CFG, write

SETTING = CFG.replace("arm_base", "robot").replace('"Arm"', '"Drive"')


def files(field: str) -> dict[str, str]:
    """Return a repository whose definitions all have a field of this name."""
    return {
        ".git/HEAD": "",
        "robot/package.xml": "<package><name>robot</name></package>",
        "robot/msg/Level.msg": f"float64 {field}",
        "robot/msg/Outer.msg": "Level[] inside\nstd_msgs/String text",
        "robot/msg/Same.msg": "std_msgs/String text",
        "robot/srv/Fill.srv": f"float64 {field}\n---\nLevel level",
        "robot/action/Drain.action": f"float64 {field}\n---\nLevel level\n---\nbool done",
        "robot/cfg/Drive.cfg": SETTING.replace('"gain"', f'"{field}"'),
        f"robot/msg/Only{field.title()}.msg": "bool there",
        "helper/helper.py": f"NAME = {field!r}",
        "node.py": f"from robot.msg import Level\nfrom robot.srv import Fill\nNAME = {field!r}",
        "tests/test_node.py": """
            from pytest_tarl.ros import message_type
            Level = message_type("robot/msg/Level")
            Old = message_type("robot/Level")
            Fill = message_type("robot/srv/Fill")
            """,
    }


@pytest.fixture
def two(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[Path, Path]]:
    """Create two repositories, of which none has been searched."""
    monkeypatch.setattr(node_workspaces, "_SEARCHED", [])
    monkeypatch.setattr(node_workspaces, "_KEPT", set())
    node_workspaces.forget()
    places = tmp_path / "one", tmp_path / "other"
    for place, field in zip(places, ("water", "oil"), strict=True):
        write(place, files(field))
    yield places
    node_workspaces.forget()


def fields(kind: Any) -> list[str]:
    """Return the names of the fields of a message class."""
    return list(kind.get_fields_and_field_types() if hasattr(kind, "SLOT_TYPES") else kind.__slots__)


def run(place: Path) -> tuple[list[str], list[str], str]:
    """Run the node of a repository in an episode; return the fields of the classes that it imported, and its name."""
    ros = Ros()
    before = set(sys.modules)
    with ros.installed():
        ros.use_definitions_around(place, place / "tests")
        found: dict[str, Any] = {}
        ros.start(lambda: found.update(runpy.run_path(str(place / "node.py"))), name="node")
        ros.close()
    for name in sys.modules.keys() - before:
        if name.partition(".")[0] == "robot":
            del sys.modules[name]
    return fields(found["Level"]), fields(found["Fill"].Request), found["NAME"]


def test_each_node_imports_the_messages_of_its_own_workspace(two: tuple[Path, Path]) -> None:
    one, other = two
    assert run(one) == (["water"], ["water"], "water")
    assert run(other) == (["oil"], ["oil"], "oil")
    assert run(one) == (["water"], ["water"], "water")


def test_each_test_gets_the_messages_of_its_own_workspace(two: tuple[Path, Path]) -> None:
    one, other = (runpy.run_path(str(place / "tests" / "test_node.py")) for place in two)
    for found, field in ((one, "water"), (other, "oil")):
        assert fields(found["Level"]) == [field]
        assert fields(found["Old"]) == [field]
        assert fields(found["Fill"].Request) == [field]


@pytest.mark.parametrize("kind", ["ros1", "ros2"])
def test_a_class_depends_on_all_messages_inside(kind: Kind, two: tuple[Path, Path]) -> None:
    seen: dict[Path, list[Any]] = {}
    for place in (*two, *two):
        node_workspaces.search(place)
        outer, same = (find_class(kind, "robot", name) for name in ("Outer", "Same"))
        assert outer is not None
        inner = find_class(kind, "robot", "Level")
        assert inner is not None
        outer(inside=[inner()])._tarl_copy(outer(inside=[inner()]))
        seen.setdefault(place, []).append((outer, same, inner))
    first, second = seen.values()
    assert first[0] == first[1]  # also after the other workspace was used
    assert second[0] == second[1]
    assert first[0][0] is not second[0][0]  # the text of Outer.msg is the same, but not that of Level.msg
    assert first[0][1] is second[0][1]  # the same definition is the same class
    assert find_class(kind, "std_msgs", "String") is type(first[0][1]().text)


def test_messages_are_unpickled_by_the_workspace_in_use(two: tuple[Path, Path]) -> None:
    def messages() -> list[Any]:
        fill, drain, old = (ros2.service_class("robot", "Fill"), ros2.action_class("robot", "Drain"),
                            ros1.service_class("robot", "Fill"))  # fmt: skip
        made: list[Any] = [fill, drain, old]
        return [
            made[0].Request(),
            made[0].Response(),
            made[1].Goal(),
            made[1].Result(),
            made[1].Impl.SendGoalService.Request(),
            made[1].Impl.FeedbackMessage(),
            made[2]._request_class(),
        ]

    packed = {}
    for place in two:
        node_workspaces.search(place)
        packed[place] = pickle.dumps(messages())
    for place in two:
        node_workspaces.search(place)
        again = pickle.loads(packed[place])
        assert again == messages()
        assert [type(one) for one in again] == [type(one) for one in messages()]
    assert fields(again[0]) == fields(again[2]) == fields(again[-1]) == ["oil"]


def test_unknown_action_part_has_no_class(two: tuple[Path, Path]) -> None:
    node_workspaces.search(two[0])
    for module, name in (
        ("robot.srv", "Fill_Goal"),
        ("robot.action", "Drain_Other"),
        ("robot.srv", "No_Request"),
    ):
        with pytest.raises(FieldError, match=f"robot/{name} is not known"):
            ros2._rebuild(module, name, {})


@pytest.mark.parametrize("part", ["msg", "srv", "action"])
def test_names_come_from_the_current_workspace(part: Part, two: tuple[Path, Path]) -> None:
    only = {"water": "OnlyWater", "oil": "OnlyOil"}
    for place, field in (*zip(two, only, strict=True), (two[0], "water")):
        node_workspaces.search(place)
        assert could_be_package("robot")
        assert get_package_share_directory("robot") == str(place / "robot")
        assert generated("robot.cfg.DriveConfig").defaults[field] == 0.5
        assert (only[field] in type_names("ros2", "robot", part)) is (part == "msg")
        assert len([name for name in only.values() if name in type_names("ros2", "robot", "msg")]) == 1
        assert candidates("helper")[0].is_relative_to(place)
        assert f"float64 {field}" in "".join(node_workspaces.workspace_types(part).values())


def test_workspaces_are_read_again_only_for_a_new_one(
    two: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[Path] = []

    def noted(root: Path, kept: frozenset[Path]) -> Workspace:
        read.append(root)
        return original(root, kept)

    monkeypatch.setattr(node_workspaces, "read", noted)
    one, other = two
    for place in (one, other):
        node_workspaces.search(place)
    node_workspaces.workspaces()
    assert sorted(read) == [one, other]
    for place in (one, other, one):
        node_workspaces.search(place)
        assert node_workspaces.workspaces()[0].root == place
        assert len(node_workspaces.workspaces()) == 2
    assert sorted(read) == [one, other]


def test_a_repository_inside_another_comes_first_for_its_nodes(two: tuple[Path, Path]) -> None:
    one, _ = two
    inner = one / "vendor" / "arm"
    write(inner, files("air"))
    node_workspaces.search(one)
    assert node_workspaces.workspace_types("msg")["robot/Level"] == "float64 water"
    node_workspaces.search(inner)
    assert node_workspaces.workspace_types("msg")["robot/Level"] == "float64 air"
    found = [
        node_workspaces.workspace_around(place) for place in (inner / "node.py", one / "node.py", one.parent)
    ]
    assert [None if each is None else each.root for each in found] == [inner, one, None]
    node_workspaces.search(one)
    found = [node_workspaces.workspace_around(place) for place in (inner / "node.py", one / "node.py")]
    assert [None if each is None else each.root for each in found] == [inner, one]


def test_known_packages_do_not_search_the_repository(two: tuple[Path, Path]) -> None:
    write(two[0], {"test_it.py": "from pytest_tarl.ros import message_type\nmessage_type('std_msgs/String')"})
    runpy.run_path(str(two[0] / "test_it.py"))
    assert node_workspaces._SEARCHED == []
