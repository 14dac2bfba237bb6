"""Read margins from files, folders or git revisions."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from pytest_tarl.errors import FixtureError
from pytest_tarl.files import read_regular
from pytest_tarl.stressing.margins import Margins, read

FOLDER = ".tarl/margins"


def is_recording(place: str) -> bool:
    """Return whether an argument of `tarl diff` is a recording."""
    return place.endswith(".npz")


def margins_in(place: str) -> list[Margins]:
    """Return the margins in a file, or in the `.json` files of a folder, sorted by name.

    Raise FixtureError if the place does not exist or a file has no margins. A folder that does not exist at a revision
    has no margins.
    """
    path = Path(place)
    if path.is_dir():
        return [_file(one) for one in sorted(path.glob("*.json"))]
    if path.exists():
        return [_file(path)]
    revision, colon, inner = place.partition(":")
    if not colon:
        raise FixtureError(
            f"{place}: no such file or folder. Name a file of margins, {FOLDER}, or REVISION:{FOLDER}."
        )
    return _at(revision, inner)


def _file(path: Path) -> Margins:
    try:
        return read(read_regular(path), str(path))
    except OSError as problem:
        raise FixtureError(f"{path}: cannot be read ({problem.strerror or problem}).") from None


def _at(revision: str, inner: str) -> list[Margins]:
    """Return the margins at a revision; paths are relative to the working directory."""
    if revision.startswith("-") or not revision:
        raise FixtureError(f"{revision!r} is not a git revision: name a branch, a tag or a commit.")
    if shutil.which("git") is None:
        raise FixtureError(
            f"git is not installed, so {revision} cannot be read: install git, or compare two files."
        )
    if _git("rev-parse", "--verify", "--quiet", f"{revision}^{{commit}}") is None:
        raise FixtureError(
            f"{revision}: git does not know this revision. In CI, fetch it first; "
            "`tarl diff --help` shows how to compare two recordings, reports or revisions."
        )
    place = inner.removesuffix("/")
    found = _git("ls-tree", "-z", "--name-only", revision, "--", place, f"{place}/") or b""
    names = [one for one in found.decode(errors="surrogateescape").split("\0") if one.endswith(".json")]
    return [
        read(_git("cat-file", "blob", f"{revision}:./{name}") or b"", f"{revision}:{name}")
        for name in sorted(names)
    ]


def _git(*arguments: str) -> bytes | None:
    """Return git's output, or None if git fails."""
    command = ("git", "-c", "core.fsmonitor=false", *arguments)
    done = subprocess.run(command, capture_output=True, check=False)
    return done.stdout if done.returncode == 0 else None
