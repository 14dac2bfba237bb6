"""A module name has one meaning in the whole project, and the map in docs/architecture.md names files that exist."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FILES = sorted(
    path.relative_to(ROOT)
    for package in ("pytest_tarl", "tarl_lint")
    for path in (ROOT / package).rglob("*.py")
)
PACKAGES = sorted({path.parent for path in FILES if path.name == "__init__.py"})

SAME_MEANING = {  # names that stand for the same thing wherever they are used
    "cli": "the command line of each package",
    "command": "the command line of `tarl observe`, and of `tarl-lint --launch`",
    "errors": "the errors that each package shows to users",
    "files": "paths and files, for each package",
    "model": "the frozen values that the rest of the package or room uses",
    "options": "the checked options of each package",
    "progress": "the progress of a run on a terminal, for each package",
    "budget": "the work that may be done: by a repair, and by the abstract interpretation",
    "bus": "the topics of an episode: in this process, and on an installed ROS",
    "delivering": "write and report the result: of a repair, and of a stress run",
    "episode": "one episode: as the body of a test uses it, and its ROS",
    "environment": "environment variables: those of a sourced ROS, and how reading them is modelled",
    "imports": "the imports of a module: edited by a patch, and resolved by the analysis",
    "launched": "what a launch file gives a node: in an episode, and in the analysis",
    "schema": "the description of stored values: tables of a fleet, and settings",
    "scores": "the scores of missions: computed in `monitoring`, and for a whole fleet in `fleet`",
    "services": "the ROS services of an episode, and their models in the analysis",
    "topic_tools": "the ROS package of this name: its stand-in, and its programs in launch files",
    "blackboards": "py_trees' blackboard: what it holds, and the models of its functions",
    "context_managers": "generators as context managers: their two halves, and calls of them",
    "watch": "`tarl watch`: the command, and the watch that it runs",
    # one file per format; each room formats its own result
    **dict.fromkeys(["dot", "html", "json", "json2", "json_result"], "a format of a result"),
    **dict.fromkeys(["junit", "mermaid", "sarif", "text", "words"], "a format of a result"),
}  # fmt: skip
# parts of Python that two interpreters implement: of constant files, and the abstract one
INTERPRETERS = (
    re.compile(r"tarl_lint/workspace/python/"),
    re.compile(r"tarl_lint/(interpret|ir|memory|models)/"),
)
# files that stand in for modules of ROS have the names of ROS, and are read with the name of their folder
STAND_INS = re.compile(r"pytest_tarl/ros/(?!messages/\w+\.py)\w+/")


def same_names(files: list[Path]) -> Iterator[tuple[str, list[Path]]]:
    """Yield each module name that several files share, and these files."""
    named = defaultdict(list)
    for path in files:
        if not path.stem.startswith("__") and not STAND_INS.match(path.as_posix()):
            named[path.stem].append(path)
    yield from ((name, paths) for name, paths in sorted(named.items()) if len(paths) > 1)


def interpreted_twice(paths: list[Path]) -> bool:
    """Tell whether the files are the same part of Python in both interpreters."""
    texts = sorted(path.as_posix() for path in paths)
    return len(texts) == 2 and all(
        sum(bool(room.match(text)) for text in texts) == 1 for room in INTERPRETERS
    )


def test_a_module_name_has_one_meaning() -> None:
    found = {
        name: [path.as_posix() for path in paths]
        for name, paths in same_names(FILES)
        if name not in SAME_MEANING and not interpreted_twice(paths)
    }
    assert found == {}, "rename these files, or state in SAME_MEANING what their common name means"


def test_every_allowed_name_is_used_twice() -> None:
    assert SAME_MEANING.keys() - {name for name, _ in same_names(FILES)} == set()


@pytest.mark.parametrize(
    ("paths", "found"),
    [
        (["tarl_lint/read/holding.py", "pytest_tarl/holding.py"], ["holding"]),
        (["tarl_lint/read/holding.py", "pytest_tarl/ros/rclpy/holding.py"], []),
        (["pytest_tarl/fleet/holding.py", "pytest_tarl/ros/messages/holding.py"], ["holding"]),
        (["pytest_tarl/__main__.py", "tarl_lint/__main__.py"], []),
    ],
)
def test_repeated_names_are_found(paths: list[str], found: list[str]) -> None:
    assert [name for name, _ in same_names([Path(path) for path in paths])] == found


def sections() -> Iterator[tuple[list[str], str]]:
    """Yield the parts of the map: the folders that a heading or the first cell of a row names, and the text."""
    text = (ROOT / "docs" / "architecture.md").read_text("utf-8")
    for part in re.split(r"(?m)^(?=#{2,3} )", text):
        heading = part.partition("\n")[0]
        for line in part.split("\n"):
            row = line.startswith("|")
            yield re.findall(r"`([\w./]+)/`", line.split("|")[1] if row else heading), line


def exists(name: str, rooms: list[str]) -> bool:
    """Tell whether a file is in one of the rooms or directly in a package; a name with a folder can be anywhere."""
    places = [path for path in FILES if path.as_posix().endswith(f"/{name}")]
    if "/" in name or not rooms:
        return bool(places)
    return any(
        len(path.parts) == 2 or any(f"/{room}/" in path.as_posix() for room in rooms) for path in places
    )


def test_the_map_names_files_that_exist() -> None:
    missing = [
        f"{', '.join(rooms)}: {name}"
        for rooms, line in sections()
        for name in re.findall(r"`([\w/]+\.py)`", line)
        if name != "setup.py" and not exists(name, rooms)  # users' packages have one
    ]
    assert missing == []


def test_the_map_names_every_room() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text("utf-8")
    rooms = {"/".join(path.parts[1:]) for path in PACKAGES if len(path.parts) > 1}
    named = {room for room in rooms if f"`{room}/`" in text}
    parents = {room for room in rooms if any(room.startswith(f"{one}/") for one in named)}
    assert rooms - named - parents == set()
