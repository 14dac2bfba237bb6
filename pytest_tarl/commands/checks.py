"""What is looked at before a patch is applied: is it what was tested, does it lose anything, does it compile?"""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

from pytest_tarl.commands.targets import Target
from pytest_tarl.errors import RefusedError
from pytest_tarl.patching.changes import FilePatch
from pytest_tarl.patching.reading import Patch


def tested(target: Target, patch: Patch, file: FilePatch, content: bytes) -> None:
    """Raise RefusedError unless a patch makes the very text of its tests, which it names as git does."""
    if file.exact(content) is None:
        raise RefusedError(
            f"{patch.name} would make another text of {target.shown} than the one that was tested: it was edited or "
            "damaged. Nothing was changed; make the patch again."
        )


def sealed(patch: Patch) -> None:
    """Raise RefusedError where nothing tells whether a patch is what was written."""
    if not patch.sealed:
        raise RefusedError(
            f"{patch.name} carries no digest, so on a text that has changed nothing tells whether it was edited: "
            "restore the text that it was made for, or make the patch again."
        )


def clean(targets: Sequence[Target]) -> Iterator[str]:
    """Yield what could not be checked. Raises RefusedError where a file has changes that are not committed."""
    for target in targets:
        if not any((folder / ".git").exists() for folder in target.path.parents):
            yield f"note:  {target.shown} is in no git repository, so nobody can tell whether it has changes to lose"
        elif shutil.which("git") is None:
            yield f"note:  git is not installed: whether {target.shown} has changes was not checked"
        elif (state := _status(target.path))[:2] == "??":
            yield f"note:  {target.shown} is not under version control; tarl revert brings its text back"
        elif state and target.as_searched:
            raise RefusedError(
                f"{target.shown} has changes that are not committed: commit or stash them first, so that the repair "
                "can be told from them; or apply it all the same with --force."
            )


def fixtures(patches: Sequence[Patch]) -> Iterator[str]:
    """Yield a note where a fixture is not there. Raises RefusedError where it is not the one of the acceptance."""
    for patch in patches:
        for told in patch.told("fixture"):
            digest, _, name = told.partition(" ")
            root = (patch.root or Path.cwd()).resolve()
            path = root / name
            if not _there(path, root):
                yield f"note:  {name} is not here, so it was not checked whether it was recorded again"
            elif hashlib.sha256(path.read_bytes()).hexdigest() != digest:
                raise RefusedError(
                    f"{name} was recorded again since {patch.name} was accepted against it: search the repair again, "
                    "or apply it all the same with --force."
                )


def _there(path: Path, root: Path) -> bool:
    """Tell whether a path that a header names is a file below a folder."""
    try:
        return path.is_file() and path.resolve().is_relative_to(root)
    except (OSError, ValueError):  # a name that no file can have
        return False


def whole(patches: Sequence[Patch]) -> None:
    """Raise RefusedError where a patch is a partial repair."""
    for patch in patches:
        for told in patch.told("partial"):
            raise RefusedError(
                f"{patch.name} is a partial repair, which was not accepted: {told}. If that is what you want, apply it "
                "with --partial."
            )


def compiles(target: Target, content: bytes) -> None:
    """Raise RefusedError where what a patch makes of a Python file is no program."""
    if target.path.suffix in (".yaml", ".yml", ".xml", ".launch"):
        return
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            compile(content, target.shown, "exec", dont_inherit=True)
    except (SyntaxError, ValueError) as problem:
        raise RefusedError(f"{target.shown} would not compile with the patch in it ({problem}).") from problem


def _status(path: Path) -> str:
    command = ("git", "-c", "core.fsmonitor=false", "status", "--porcelain", "--", path.name)
    done = subprocess.run(command, cwd=path.parent, capture_output=True, text=True, check=False)
    return done.stdout
