"""Message packages that a patch imports and package.xml lacks."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytest_tarl.patching.dependencies import undeclared


def told(
    root: Path, manifest: str | None, before: str, after: str, name: str = "pkg/src/node.py"
) -> list[str]:
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(before)
    if manifest is not None:
        (root / "pkg" / "package.xml").write_text(manifest)
    return undeclared({path: after}, root)


SECOND = '<package format="2"><name>pkg</name>{}</package>'


@pytest.mark.parametrize(
    ("text", "packages"),
    [
        ("from sensor_msgs.msg import Range\n", ["sensor_msgs"]),
        ("from sensor_msgs import msg\n", ["sensor_msgs"]),
        ("import sensor_msgs.msg as sm\n", ["sensor_msgs"]),
        ("from std_srvs.srv import Empty\nfrom nav2_msgs.action import Spin\n", ["nav2_msgs", "std_srvs"]),
        ("def f():\n    from sensor_msgs.msg import Range\n", ["sensor_msgs"]),
        ("from .sensor_msgs.msg import Range\n", []),
        ("from . import msg\n", []),
        ("import sensor_msgs\n", []),
        ("from sensor_msgs import point_cloud2\n", []),
        ("from pkg.msg import Own\n", []),
        ("import numpy.linalg\n", []),
    ],
)
def test_new_packages_of_messages_are_named_in_order(tmp_path: Path, text: str, packages: list[str]) -> None:
    found = told(tmp_path, SECOND.format(""), "", text)
    assert found == [
        f"the patch imports messages of {one}, which pkg/package.xml does not depend on: add "
        f"<exec_depend>{one}</exec_depend> there"
        for one in packages
    ]


@pytest.mark.parametrize(
    ("listed", "known"),
    [
        ("<depend>sensor_msgs</depend>", True),
        ("<exec_depend>sensor_msgs</exec_depend>", True),
        ("<run_depend> sensor_msgs </run_depend>", True),
        ('<depend condition="$ROS_VERSION == 2">sensor_msgs</depend>', True),
        ("<build_depend>sensor_msgs</build_depend>", False),
        ("<test_depend>sensor_msgs</test_depend>", False),
        ("<depend>sensor_msgs_py</depend>", False),
        ("<!-- <depend>sensor_msgs</depend> -->", False),
        ("<!--\n<depend>sensor_msgs</depend>\n--><depend>x</depend>", False),
    ],
)
def test_runtime_dependency_is_a_known_package(tmp_path: Path, listed: str, known: bool) -> None:
    text = "from sensor_msgs.msg import Range\n"
    assert (told(tmp_path, SECOND.format(listed), "", text) == []) is known


def test_imported_package_is_not_named(tmp_path: Path) -> None:
    before, after = (f"from sensor_msgs.msg import {name}\n" for name in ("Range", "Range, Imu"))
    assert told(tmp_path, SECOND.format(""), before, after) == []


@pytest.mark.parametrize(
    ("head", "kind"),
    [
        ("<package>", "run_depend"),
        ('<package format="1">', "run_depend"),
        ("<package format='2'>", "exec_depend"),
        ('<package format="3">', "exec_depend"),
    ],
)
def test_the_element_fits_the_format_of_the_manifest(tmp_path: Path, head: str, kind: str) -> None:
    (found,) = told(tmp_path, f"{head}<name>pkg</name></package>", "", "import std_msgs.msg\n")
    assert f"<{kind}>std_msgs</{kind}>" in found


def test_files_without_a_manifest_and_other_files_are_skipped(tmp_path: Path) -> None:
    assert told(tmp_path, None, "", "import std_msgs.msg\n") == []
    assert told(tmp_path, SECOND.format(""), "", "speed: 1\n", "pkg/params.yaml") == []


def test_package_is_named_once_for_all_its_files(
    tmp_path: Path,
) -> None:
    manifest = tmp_path / "pkg" / "package.xml"
    manifest.parent.mkdir()
    manifest.write_text(SECOND.format(""))
    files = [manifest.parent / name for name in ("settings.yaml", "a.py", "b.py")]
    for file in files:
        file.write_text("")
    changed = dict.fromkeys(files, "import std_msgs.msg\n")
    assert len(undeclared(changed, tmp_path)) == 1
    (found,) = undeclared(changed, tmp_path / "other")
    assert f"which {manifest.as_posix()} does not depend on" in found
