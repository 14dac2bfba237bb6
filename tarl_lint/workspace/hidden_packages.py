"""Hidden packages that a launch file names: the launch file needs them, but build tools skip them."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path

from tarl_lint.workspace.launch_model import Launch
from tarl_lint.workspace.model import Hidden, Problem, Workspace


def named_by(launch: Launch, workspace: Workspace) -> tuple[Hidden, ...]:
    """Return the hidden packages that contain the launch file, an included file, a node or parameters; by name."""
    settings = [*launch.settings, *(one for node in launch.nodes for one in node.settings)]
    places = {launch.file, *(one.file for one in settings), *(node.file for node in launch.nodes)}
    found = {workspace.hidden_at(place) for place in places}
    packages = {node.package for node in launch.nodes}
    visible = {one.name for one in workspace.packages}
    found |= {one for one in workspace.hidden if one.package.name in packages - visible}
    return tuple(sorted((one for one in found if one is not None), key=lambda one: one.package.name))


def problems(launch: Launch, workspace: Workspace) -> Iterator[Problem]:
    """Yield a problem for each marker that hides packages which the launch file names."""
    names: dict[Path, list[str]] = {}
    for one in named_by(launch, workspace):
        names.setdefault(one.marker, []).append(one.package.name)
    for marker, hidden in names.items():
        plural = "packages" if len(hidden) > 1 else "package"
        yield Problem(
            marker,
            0,
            f"the file hides the {plural} {', '.join(hidden)} from ROS, but the launch file needs "
            f"{'them' if len(hidden) > 1 else 'it'}: read here as if the file were absent",
        )


def folders_with(hidden: Collection[Hidden], workspace: Workspace) -> tuple[Path, ...]:
    """Return the folders of hidden packages, and of all other packages hidden by the same markers."""
    markers = {one.marker for one in hidden}
    return tuple(one.package.folder for one in workspace.hidden if one.marker in markers)
