"""`tarl apply` and `tarl revert`: patches into the sources and out again, all files or none."""

from __future__ import annotations

import hashlib
import os
import shlex
import shutil
import subprocess
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pytest_tarl.errors import RefusedError, RepairError
from pytest_tarl.files import replace_all
from pytest_tarl.patching.combining import combined, conflicts, separated
from pytest_tarl.patching.reading import FilePatch, MisfitError, Patch, identical, read


@dataclass(frozen=True)
class Target:
    """A file to be changed: where it is, what is in it, and what each patch does to it."""

    path: Path
    shown: str
    content: bytes
    parts: tuple[tuple[Patch, FilePatch], ...]

    @property
    def as_searched(self) -> bool:
        """Tell whether the file is the text that every patch was searched and accepted on."""
        return all(identical(self.content, file.before) for _, file in self.parts)


def apply(paths: Sequence[Path], directory: Path | None, *, force: bool) -> list[str]:
    """Apply patches and return what to tell. Raises RefusedError where one should not be, and changes nothing then."""
    patches = [read(path) for path in paths]
    _together(patches)
    targets = _targets(patches, directory)
    contents = {target.path: _changed(target, force) for target in targets}
    notes = [] if force else [*_clean(targets), *_fixtures(patches)]
    for target in targets:
        _compiles(target, contents[target.path])
    _write(contents)
    done = [f"applied to {target.shown}: {_titles(target)}" for target in targets]
    undo = f"undo:  {shlex.join(['tarl', 'revert', *map(_shown, paths)])}"
    return [*done, *notes, *_again(patches), undo]


def revert(paths: Sequence[Path], directory: Path | None) -> list[str]:
    """Undo patches and return what to tell. Raises RefusedError where one is not applied or its lines were edited."""
    patches = [read(path) for path in paths]
    targets = _targets(patches, directory)
    contents: dict[Path, bytes] = {}
    told: list[str] = []
    for target in targets:
        content = _as_before(target)
        contents[target.path] = content
        whole = any(identical(content, file.before) for _, file in target.parts)
        rest = "it is what it was" if whole else "other lines have changed since and stay as they are"
        told.append(f"reverted in {target.shown}: {rest}")
    _write(contents)
    return told


def located(patch: Patch, directory: Path | None) -> Path:
    """Return the folder that a patch's names are relative to. Raises RepairError when its files are nowhere."""
    here = Path.cwd()
    if directory is not None:
        likely = [directory.resolve()]
    elif patch.root is not None:
        likely = [(patch.root / patch.base).resolve()]
    else:
        likely = [here, *here.parents]
    for folder in likely:
        if all((folder / file.name).is_file() for file in patch.files):
            return folder
    missing = next(file.name for file in patch.files if not (likely[0] / file.name).is_file())
    raise RepairError(
        f"{patch.name} changes {missing}, and there is no such file in {likely[0]}: say with --directory where its "
        "paths begin."
    )


def _targets(patches: Sequence[Patch], directory: Path | None) -> list[Target]:
    parts: dict[Path, list[tuple[Patch, FilePatch]]] = {}
    for patch in patches:
        base = located(patch, directory)
        for file in patch.files:
            parts.setdefault((base / file.name).resolve(), []).append((patch, file))
    return [Target(path, _shown(path), _content(path), tuple(each)) for path, each in sorted(parts.items())]


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as problem:
        raise RepairError(f"{path} cannot be read ({problem.strerror}).") from problem


def _together(patches: Sequence[Patch]) -> None:
    found = [str(conflict) for conflict in conflicts(patches)]
    if found:
        raise RefusedError(f"{'; '.join(found)}: apply one of them, then search the other repair again.")


def _changed(target: Target, force: bool) -> bytes:
    """Return a file's content with all patches in it."""
    if target.as_searched:
        return combined(target.content, [one for _, file in target.parts for one in file.replacements])
    content = target.content
    for patch, file in target.parts:
        if identical(content, file.after) or (_fits(file.reverse, content) and not _fits(file, content)):
            raise RefusedError(f"{patch.name} is already applied to {target.shown}: nothing was changed.")
        try:
            changed = file.applied(content)
        except MisfitError as misfit:
            raise RefusedError(
                f"{target.shown} is not the text that {patch.name} was made for, and its change at line {misfit} fits "
                "nowhere: restore that text, or search the repair again."
            ) from misfit
        if not force and not _made_by_others(content, patch, file):
            raise RefusedError(
                f"{target.shown} has changed since {patch.name} was tested. The patch still fits, but nobody has run "
                "what it would make: search the repair again, or apply it all the same with --force."
            )
        content = changed
    return content


def _made_by_others(content: bytes, patch: Patch, file: FilePatch) -> bool:
    """Tell whether a content is what other patches made of the very text that a patch was tested on."""
    others = sorted(path for path in patch.path.parent.glob("*.patch") if path.name != patch.name)
    for path in others:
        try:
            made = [one for one in read(path).files if one.name == file.name and one.before == file.before]
        except RepairError:
            continue
        if any(identical(content, one.after) for one in made):
            return True
    return False


def _fits(file: FilePatch, content: bytes) -> bool:
    try:
        file.applied(content)
    except MisfitError:
        return False
    return True


def _as_before(target: Target) -> bytes:
    """Return a file's content without the patches."""
    content = separated(target.content, [one for _, file in target.parts for one in file.replacements])
    if content is not None and all(identical(content, file.before) for _, file in target.parts):
        return content
    content = target.content
    for patch, file in reversed(target.parts):
        content = _undone(target, content, patch, file)
    return content


def _undone(target: Target, content: bytes, patch: Patch, file: FilePatch) -> bytes:
    try:
        return file.reverse.applied(content)
    except MisfitError as misfit:
        if _fits(file, content):
            raise RefusedError(
                f"{patch.name} is not applied to {target.shown}: nothing was changed."
            ) from misfit
        raise RefusedError(
            f"{target.shown} was edited where {patch.name} had changed it (line {misfit} of the patched file), so it "
            "cannot be undone line by line: restore it from version control."
        ) from misfit


def _clean(targets: Sequence[Target]) -> Iterator[str]:
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


def _status(path: Path) -> str:
    command = ("git", "status", "--porcelain", "--", path.name)
    done = subprocess.run(command, cwd=path.parent, capture_output=True, text=True, check=False)
    return done.stdout


def _fixtures(patches: Sequence[Patch]) -> Iterator[str]:
    """Yield a note where a fixture is not there. Raises RefusedError where it is not the one of the acceptance."""
    for patch in patches:
        for told in patch.told("fixture"):
            digest, _, name = told.partition(" ")
            path = (patch.root or Path.cwd()) / name
            if not path.exists():
                yield f"note:  {name} is not here, so it was not checked whether it was recorded again"
            elif hashlib.sha256(path.read_bytes()).hexdigest() != digest:
                raise RefusedError(
                    f"{name} was recorded again since {patch.name} was accepted against it: search the repair again, "
                    "or apply it all the same with --force."
                )


def _compiles(target: Target, content: bytes) -> None:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            compile(content, target.shown, "exec", dont_inherit=True)
    except (SyntaxError, ValueError) as problem:
        raise RefusedError(f"{target.shown} would not compile with the patch in it ({problem}).") from problem


def _write(contents: Mapping[Path, bytes]) -> None:
    try:
        replace_all(contents)
    except OSError as problem:
        raise RepairError(
            f"{problem.filename} cannot be written ({problem.strerror}); all files are as they were."
        ) from problem


def _again(patches: Sequence[Patch]) -> list[str]:
    """Return the commands that run the tests against their drifts again."""
    commands = dict.fromkeys(command for patch in patches for command in patch.told("again"))
    root = patches[0].root
    move = f"cd {shlex.quote(_shown(root))} && " if root is not None and root != Path.cwd() else ""
    return [f"again: {move}{command}" for command in commands]


def _titles(target: Target) -> str:
    return "; ".join(dict.fromkeys(patch.title.partition(": ")[2] for patch, _ in target.parts))


def _shown(path: Path) -> str:
    return Path(os.path.relpath(path.resolve(), Path.cwd())).as_posix()
