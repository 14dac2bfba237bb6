"""Modules whose names the statements of flows use, and named files without any recorded statement."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.analysed import analysed, passed_with_imports
from pytest_tarl.modules_in_flows import Use, uses
from pytest_tarl.unrecorded_nodes import silent_files


def step(path: str, line: int, code: str) -> Any:
    return SimpleNamespace(span=SimpleNamespace(path=path, line=line), code=code)


def project(root: Path, files: dict[str, str], *sites: Any) -> Any:
    """Write files; return an analysis of those that have a site."""
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    shown = dict.fromkeys(one.span.path for one in sites)
    return SimpleNamespace(sources={path: files[path] for path in shown}, sites=sites)


@pytest.mark.parametrize(
    ("text", "code", "file"),
    [
        ("import gains\n", "x = gains.KP", "src/gains.py"),
        ("import gains as g\n", "x = g.KP", "src/gains.py"),
        ("import gains as g\n", "x = gains.KP", None),
        ("import gains\n", "x = again.KP", None),
        ("from gains import KP\n", "x = KP * 2", "src/gains.py"),
        ("from gains import KP as k\n", "x = k * 2", "src/gains.py"),
        ("from gains import KP\n", "x = KPI", None),
        ("from gains import KP\n", "x = other", None),
        ("from . import gains\n", "x = gains.KP", "src/gains.py"),
        ("from .gains import KP\n", "x = KP", "src/gains.py"),
        ("from .. import shared\n", "x = shared.KP", "shared.py"),
        ("from ..gains import KP\n", "x = KP", None),
        ("import robot.limits\n", "x = robot.limits.TOP", "robot/limits.py"),
        ("from robot import limits\n", "x = limits.TOP", "robot/limits.py"),
        ("from robot.limits import TOP\n", "x = TOP", "robot/limits.py"),
        ("import shared\n", "x = shared.KP", "shared.py"),
        ("import math\n", "x = math.pi", None),
        ("def f():\n    import gains\n", "x = gains.KP", "src/gains.py"),
    ],
)
def test_name_leads_to_its_imported_file(tmp_path: Path, text: str, code: str, file: str | None) -> None:
    files = {"src/node.py": text, "src/gains.py": "KP = 1\n", "shared.py": "", "robot/limits.py": "TOP = 1\n"}
    found = project(tmp_path, files, step("src/node.py", 4, "y = 1"), step("src/node.py", 7, code))
    expected = [] if file is None else [Use(tmp_path.resolve() / file, "src/node.py", 7)]
    assert list(uses(found, tmp_path)) == expected


def test_first_statement_of_a_flow_in_a_file_counts(tmp_path: Path) -> None:
    files = {"node.py": "import gains\n", "other.py": "import math\n", "gains.py": ""}
    sites = (
        step("other.py", 2, "x = gains.KP"),
        step("node.py", 5, "x = gains.KP"),
        step("node.py", 3, "y = gains.KP"),
    )
    found = project(tmp_path, files, *sites)
    assert [one.line for one in uses(found, tmp_path)] == [5]


def test_files_above_the_root_are_not_found(tmp_path: Path) -> None:
    (tmp_path / "gains.py").write_text("")
    root = tmp_path / "project"
    found = project(root, {"node.py": "import gains\n"}, step("node.py", 2, "x = gains.KP"))
    assert list(uses(found, root)) == []
    found = project(root, {"node.py": "from .. import gains\n"}, step("node.py", 2, "x = gains.KP"))
    assert list(uses(found, root)) == []


def silent(root: Path, names: list[str], found: Any) -> list[str]:
    return list(silent_files([root / name for name in names], found, root, passed_with_imports))


def test_files_without_a_used_name_are_named(tmp_path: Path) -> None:
    files = {"node.py": "import gains\n", "gains.py": "KP = 1\n", "spare.py": "", "params.yaml": ""}
    found = project(tmp_path, files, step("node.py", 2, "x = gains.KP"))
    (told,) = silent(tmp_path, [*files], found)
    assert told.startswith("spare.py is named in nodes, but no flow")
    assert told.endswith("remove it from nodes, or run `tarl-lint` to see the flows")


def test_missing_init_file_is_the_reason(tmp_path: Path) -> None:
    for text in ("from robot.limits import TOP\n", "import robot.limits\n", "from robot import limits\n"):
        files = {"node.py": text, "robot/limits.py": "TOP = 1\n"}
        found = project(tmp_path, files, step("node.py", 2, "x = 1"))
        (told,) = silent(tmp_path, ["node.py", "robot/limits.py"], found)
        assert told.startswith("robot/limits.py is named")
        assert told.endswith(
            "node.py imports it from robot, which has no __init__.py; add an empty one and record again"
        )
        (tmp_path / "robot" / "__init__.py").write_text("")
        (told,) = silent(tmp_path, ["node.py", "robot/limits.py"], found)
        assert told.endswith("to see the flows")
        (tmp_path / "robot" / "__init__.py").unlink()
    (told,) = silent(tmp_path, ["robot/limits.py"], found)
    assert told.endswith("to see the flows")


def test_file_outside_the_root_is_named_by_path(tmp_path: Path) -> None:
    root = tmp_path / "project"
    found = project(root, {"node.py": ""}, step("node.py", 2, "x = 1"))
    (tmp_path / "far.py").write_text("")
    (told,) = silent_files([tmp_path / "far.py"], found, root, passed_with_imports)
    assert told.startswith(f"{tmp_path / 'far.py'} is named in nodes")


NODE = """
import rospy
from std_msgs.msg import Float64
from robot import scaled
def heard(message):
    pub.publish(Float64(scaled(message.data)))
pub = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("in", Float64, heard)
"""


def named(root: Path, *nodes: str) -> Any:
    return analysed(SimpleNamespace(nodes=nodes), root, root)  # type: ignore[arg-type]


def test_flows_pass_through_packages_that_are_not_named(tmp_path: Path) -> None:
    files = {
        "node.py": NODE,
        "robot/__init__.py": "from .gains import scaled\n",
        "robot/gains.py": "from robot.limits import held\ndef scaled(value):\n    return held(2.0 * value)\n",
        "robot/limits.py": "def held(value):\n    return min(value, 1.0)\n",
    }
    project(tmp_path, files)
    found = named(tmp_path, "node.py", "robot/gains.py")
    assert {one.span.path for one in found.sites} == {"node.py", "robot/gains.py"}
    (tmp_path / "robot" / "__init__.py").write_text("def scaled(:\n")
    assert {one.span.path for one in named(tmp_path, "node.py").sites} == {"node.py"}


def test_indirectly_reached_file_is_named_with_its_importer(tmp_path: Path) -> None:
    files = {
        "node.py": NODE.replace(
            "from robot import scaled", "from middle import Middle\nscaled = Middle().scaled"
        ),
        "middle.py": "import far\nclass Middle:\n    def scaled(self, value):\n        return far.scaled(value)\n",
        "far.py": "def scaled(value):\n    return 2.0 * value\n",
        "spare.py": "",
    }
    project(tmp_path, files)
    found = named(tmp_path, "node.py", "far.py", "spare.py")
    spare, far = silent(tmp_path, ["node.py", "far.py", "spare.py"], found)
    assert spare.startswith("spare.py is named in nodes, but no flow")
    assert far == (
        "the flows through far.py also pass through files that nodes does not name, so nothing in the former is "
        "recorded or repaired: add middle.py to nodes and record again"
    )
    assert silent(tmp_path, ["node.py", "far.py", "middle.py"], named(tmp_path, *list(files)[:3])) == []
