"""Checks before a patch is applied."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

from pytest_tarl.commands.targets import Target
from pytest_tarl.errors import RefusedError
from pytest_tarl.files import read_regular
from pytest_tarl.patching.changes import FilePatch
from pytest_tarl.patching.patch_reader import Patch


def tested(target: Target, patch: Patch, file: FilePatch, content: bytes) -> None:
    """Raise RefusedError if the patched text was not tested."""
    if file.exact(content) is None:
        raise RefusedError(
            f"{patch.name} does not produce the tested text of {target.shown}: the patch was edited or damaged. "
            "Nothing was changed; search for the repair again."
        )


def sealed(patch: Patch) -> None:
    """Raise RefusedError if a patch has no digest."""
    if not patch.sealed:
        raise RefusedError(
            f"{patch.name} has no digest, so TARL cannot check it on a changed file: restore the text for which "
            "it was made, or search for the repair again."
        )


def clean(targets: Sequence[Target]) -> Iterator[str]:
    """Raise RefusedError for uncommitted changes; yield notes on files that could not be checked."""
    for target in targets:
        if not any((folder / ".git").exists() for folder in target.path.parents):
            yield f"note:  {target.shown} is not in a git repository, so uncommitted changes cannot be detected"
        elif shutil.which("git") is None:
            yield f"note:  git is not installed, so {target.shown} was not checked for uncommitted changes"
        elif (state := _status(target.path))[:2] == "??":
            yield f"note:  {target.shown} is not under version control; tarl revert restores its text"
        elif state and target.as_searched:
            raise RefusedError(
                f"{target.shown} has uncommitted changes: commit or stash them first, to keep them apart from the "
                "repair, or use --force."
            )


def fixtures(patches: Sequence[Patch]) -> Iterator[str]:
    """Raise RefusedError if the recording is new; yield a note for each missing recording."""
    for patch in patches:
        for told in patch.told("fixture"):
            digest, _, name = told.partition(" ")
            root = (patch.root or Path.cwd()).resolve()
            content = _content(root / name, root)
            if content is None:
                yield f"note:  {name} is missing, so TARL could not check whether it was recorded again"
            elif hashlib.sha256(content).hexdigest() != digest:
                raise RefusedError(
                    f"{name} was recorded again since {patch.name} was accepted: search for the repair again, or "
                    "apply it with --force."
                )


def _content(path: Path, root: Path) -> bytes | None:
    """Return the content of a path from a patch's header, or None."""
    try:
        return read_regular(path) if path.is_file() and path.resolve().is_relative_to(root) else None
    except (OSError, ValueError):  # unreadable file or invalid name
        return None


def whole(patches: Sequence[Patch]) -> None:
    """Raise RefusedError if a patch is only a partial repair."""
    for patch in patches:
        for told in patch.told("partial"):
            raise RefusedError(
                f"{patch.name} is a partial repair, which was not accepted: {told}. To apply it anyway, use --partial."
            )


def compiles(target: Target, content: bytes) -> None:
    """Raise RefusedError if a patched Python file does not compile."""
    if target.path.suffix in (".yaml", ".yml", ".xml", ".launch"):
        return
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            compile(content, target.shown, "exec", dont_inherit=True)
    except (SyntaxError, ValueError) as problem:
        raise RefusedError(
            f"{target.shown} does not compile with the patch applied ({problem})."
        ) from problem


def _status(path: Path) -> str:
    command = ("git", "-c", "core.fsmonitor=false", "status", "--porcelain", "--", path.name)
    done = subprocess.run(command, cwd=path.parent, capture_output=True, text=True, check=False)
    return done.stdout
