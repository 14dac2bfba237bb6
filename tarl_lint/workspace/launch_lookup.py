"""Find the launch file that a user names, by path or by its name in the workspace."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from tarl_lint.workspace.launch_model import Launch
from tarl_lint.workspace.model import Workspace

TEST: Final = ".test"  # launch files of rostest
ENDINGS: Final = (".launch", ".launch.xml", ".launch.py", ".launch.yaml", ".launch.yml", TEST)


class NoLaunchFileError(Exception):
    """No launch file has the name, or more than one. The message is a sentence."""


def unknown_argument(launch: Launch, names: Iterable[str]) -> str:
    """Return a sentence about the first of the arguments that a launch file does not have; "" if it has all."""
    name = next((one for one in names if one not in launch.arguments), None)
    if name is None:
        return ""
    close = difflib.get_close_matches(name, launch.arguments, 1)
    known = f"it has {', '.join(launch.arguments)}." if launch.arguments else "it has none."
    return f"{launch.file.name} has no argument {name!r}; {f'did you mean {close[0]!r}?' if close else known}"


def is_launch_name(name: str) -> bool:
    """Return whether a file has the name of a launch file."""
    return name.endswith((*ENDINGS, "_launch.py", "_launch.xml", "_launch.yaml", "_launch.yml"))


def launch_file(named: str, workspace: Workspace, shown: str) -> Path:
    """Return a launch file of the workspace by its name, or as `package/name`; `shown` names the workspace.

    Raises NoLaunchFileError if there is no such launch file, or if several packages have one.
    """
    package, _, name = named.rpartition("/")
    for packages in (workspace.packages, tuple(one.package for one in workspace.hidden)):
        known = {(one.name, file.name): file for one in packages for file in one.launch_files}
        found = [
            file for (owner, file_name), file in known.items() if file_name == name and package in ("", owner)
        ]
        if found:
            break
    if len(found) == 1:
        return found[0]
    if found:
        owners = ", ".join(sorted(f"{owner}/{one}" for owner, one in known if one == name))
        raise NoLaunchFileError(f"{named} is a launch file of several packages: name one of {owners}.")
    own = [file.name for one in workspace.packages if one.name == named for file in one.launch_files]
    if own:
        raise NoLaunchFileError(
            f"{named} is a package: name one of its launch files, {', '.join(sorted(own))}."
        )
    names = sorted({file.name for one in workspace.packages for file in one.launch_files})
    close = difflib.get_close_matches(name, names, n=1)
    meant = f" Did you mean {close[0]}?" if close else ""
    raise NoLaunchFileError(
        f"{named}: no such file, and no launch file of the workspace {shown} has this name.{meant} "
        "`tarl workspace` lists them."
    )
