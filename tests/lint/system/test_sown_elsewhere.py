"""Misconfigurations of the kinds of ROSDiscover, injected into two workspaces beside drivers that were not read.

Each workspace has drivers of lasers, cameras and satellite navigation, some of unknown packages, and includes the
launch file of a package that is not in the workspace. Other misconfigurations are injected at further places of the
example workspace.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from tarl_lint.settings.config import Options, resolve
from tarl_lint.system.command import Request, systems
from tarl_lint.system.hazards import hazards

HERE = Path(__file__).parent
EXAMPLE = HERE.parents[2] / "examples/workspace"
LAUNCH = {
    "mower": "mower_bringup/launch/mower.launch.xml",
    "tug": "tug/launch/tug.launch",
    "scout": "scout_navigation/launch/bringup.launch.py",
}
Edit = tuple[str, str, str]  # file, old text, new text
_LAUNCHED = "mower_bringup/launch/mower.launch.xml"
_NAVIGATION = "mower_navigation/mower_navigation/"
_FENCE = """\
    <node pkg="mower_navigation" exec="fence" name="fence">
      <param name="reach" value="1.5"/>
    </node>
"""

SOWN: dict[str, tuple[str, str, list[Edit]]] = {
    "mower: a publisher with an absolute name": (
        "TARL301", "/mower/pilot subscribes to /mower/pose_estimate",
        [(f"{_NAVIGATION}localizer.py", '"pose_estimate"', '"/pose_estimate"')],
    ),
    "mower: a subscription with an absolute name": (
        "TARL301", "/mower/pilot subscribes to /blocked",
        [(f"{_NAVIGATION}pilot.py", '"blocked"', '"/blocked"')],
    ),
    "mower: a node outside the namespace": (
        "TARL301", "/mower/pilot subscribes to /mower/blocked",
        [(_LAUNCHED, _FENCE, ""),
         (_LAUNCHED, "  <group>", '  <node pkg="mower_navigation" exec="fence"/>\n  <group>')],
    ),
    "mower: a private topic under a public name": (
        "TARL301", "/mower/wheels subscribes to /mower/wheels/cmd_vel",
        [(_LAUNCHED, '      <remap from="cmd_vel" to="wheels/cmd_vel"/>\n', "")],
    ),
    "mower: a private service under a public name": (
        "TARL304", "/mower/pilot calls /mower/engage",
        [(f"{_NAVIGATION}pilot.py", '"blade/engage"', '"engage"')],
    ),
    "mower: a service with an absolute name": (
        "TARL304", "/mower/pilot calls /mower/blade/engage",
        [("mower_tools/mower_tools/blade.py", '"~/engage"', '"/blade/engage"')],
    ),
    "mower: a misspelt remapping": (
        "TARL301", "/mower/wheels subscribes to /mower/wheels/cmd_vel",
        [(_LAUNCHED, "wheels/cmd_vel", "wheels/cmd_vle")],
    ),
    "mower: a node is renamed, and its private service with it": (
        "TARL304", "/mower/pilot calls /mower/blade/engage",
        [(_LAUNCHED, 'exec="blade" name="blade"', 'exec="blade" name="cutter"')],
    ),
    "mower: a misspelt parameter": (
        "TARL307", "/mower/fence has no parameter reahc", [(_LAUNCHED, 'name="reach"', 'name="reahc"')],
    ),
    "mower: a remapping without effect": (
        "TARL308", "/mower/localizer uses no name gps", [(_LAUNCHED, 'from="fix"', 'from="gps"')],
    ),
    "tug: a publisher with an absolute name": (
        "TARL301", "/tug/docker subscribes to /tug/dock_pose",
        [("tug/scripts/dock_finder.py", '"dock_pose"', '"/dock_pose"')],
    ),
    "tug: an absolute name in a remapping": (
        "TARL301", "/tug/base subscribes to /tug/cmd_vel",
        [("tug/launch/docking.launch", 'to="cmd_vel"', 'to="/cmd_vel"')],
    ),
    "tug: a part outside the namespace": (
        "TARL301", "/tug/base subscribes to /tug/hooked",
        [("tug/launch/tug.launch", '    <include file="$(find tug)/launch/docking.launch"/>\n', ""),
         ("tug/launch/tug.launch", "  <group", '  <include file="$(find tug)/launch/docking.launch"/>\n  <group')],
    ),
    "tug: a private topic under a public name": (
        "TARL301", "/tug/base subscribes to /tug/hooked",
        [("tug/scripts/hook.py", '"hooked"', '"~hooked"')],
    ),
    "tug: a private service under a public name": (
        "TARL304", "/tug/docker calls /tug/catch", [("tug/scripts/docker.py", '"hook/catch"', '"catch"')],
    ),
    "tug: a misspelt topic": (
        "TARL301", "/tug/docker subscribes to /tug/dock_psoe",
        [("tug/scripts/docker.py", '"dock_pose"', '"dock_psoe"')],
    ),
    "tug: types that differ": (
        "TARL302", "/tug/docker subscribes to /tug/dock_pose as PoseWithCovarianceStamped",
        [("tug/scripts/docker.py", "PoseStamped", "PoseWithCovarianceStamped"),
         ("tug/scripts/docker.py", "dock.pose.position", "dock.pose.pose.position")],
    ),
    "scout: a subscription with an absolute name": (
        "TARL301", "/scout/planner subscribes to /obstacles",
        [("scout_navigation/scout_navigation/planner.py", '"obstacles"', '"/obstacles"')],
    ),
    "scout: an absolute name in a remapping": (
        "TARL301", "/scout/gate subscribes to /scout/cmd_vel_raw",
        [("scout_navigation/launch/bringup.launch.py", '"cmd_vel_raw"', '"/cmd_vel_raw"')],
    ),
    "scout: the planner outside the namespace": (
        "TARL301", "/scout/gate subscribes to /scout/cmd_vel_raw",
        [("scout_navigation/launch/bringup.launch.py", 'executable="planner",',
          'executable="planner", namespace="/",')],
    ),
    "scout: a private topic under a public name": (
        "TARL301", "/scout/planner subscribes to /scout/obstacles",
        [("scout_perception/scout_perception/detector.py", '"obstacles"', '"~/obstacles"')],
    ),
}  # fmt: skip


def written(workspace: str, folder: Path) -> Path:
    """Write a workspace, with scripts that can be started."""
    if workspace == "scout":
        return Path(shutil.copytree(EXAMPLE, folder / "src"))
    _, *files = re.split(
        r"^--- (\S+)\n", (HERE / f"workspaces/{workspace}.txt").read_text("utf-8"), flags=re.M
    )
    for name, text in zip(files[::2], files[1::2], strict=True):
        path = folder / "src" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
        if path.parent.name == "scripts":
            path.write_text(f"#!/usr/bin/env python3\n{text}", "utf-8")
            path.chmod(0o755)
    return folder / "src"


def found(workspace: str, folder: Path) -> list[str]:
    """Return the hazards of the workspace's launch file, as `CODE message`."""
    config = resolve(Options((folder,), select=("TARL3",)))
    request = Request(str(folder / LAUNCH[workspace]), (), (folder,))
    return [f"{one.code} {one.message}" for each in systems(request, config) for one in hazards(each, config)]


@pytest.mark.parametrize("kind", SOWN)
def test_injected_misconfiguration_is_found_beside_unread_drivers(kind: str, tmp_path: Path) -> None:
    code, message, edits = SOWN[kind]
    workspace = kind.partition(":")[0]
    folder = written(workspace, tmp_path)
    for name, old, new in edits:
        text = (folder / name).read_text("utf-8")
        assert old in text
        (folder / name).write_text(text.replace(old, new), "utf-8")
    reports = found(workspace, folder)
    assert any(one.startswith(f"{code} {message}") for one in reports), reports
    assert {one.partition(" ")[0] for one in reports} == {code}, reports


@pytest.mark.parametrize("workspace", LAUNCH)
def test_a_correct_workspace_has_no_reports(workspace: str, tmp_path: Path) -> None:
    assert found(workspace, written(workspace, tmp_path)) == []
