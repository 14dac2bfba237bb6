"""`tarl apply` and `tarl revert`: patch all files or none."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from pytest_tarl.commands.checks import clean, compiles, fixtures, sealed, tested, whole
from pytest_tarl.commands.replacing import Change, MovedError, replace_all
from pytest_tarl.commands.targets import Target, shown
from pytest_tarl.commands.targets import targets as found_targets
from pytest_tarl.errors import RefusedError, RepairError
from pytest_tarl.patching.changes import FilePatch, MisfitError, identical
from pytest_tarl.patching.merge import combined, conflicts, separated
from pytest_tarl.patching.patch_reader import Patch, read


def apply(paths: Sequence[Path], directory: Path | None, *, force: bool, partial: bool = False) -> list[str]:
    """Apply patches; return the output. Raise RefusedError if a check fails."""
    patches = [read(path) for path in paths]
    if not partial:
        whole(patches)
    _together(patches)
    targets = found_targets(patches, directory)
    halfway = _halfway(targets)
    targets = [target for target in targets if target.path not in halfway]
    contents = {target.path: _changed(target, force) for target in targets}
    notes = [] if force else [*clean(targets), *fixtures(patches)]
    for target in targets:
        compiles(target, contents[target.path])
    _write(targets, contents)
    notes += [f"note:  {shown(path)} was already changed by the interrupted run" for path in halfway]
    done = [f"applied to {target.shown}: {_titles(target)}" for target in targets]
    undo = f"undo:  {shlex.join(['tarl', 'revert', *map(shown, paths)])}"
    return [*done, *notes, *_recording(patches, targets), *_again(patches), undo]


def revert(paths: Sequence[Path], directory: Path | None) -> list[str]:
    """Undo patches; return the output. Raise RefusedError."""
    patches = [read(path) for path in paths]
    targets = found_targets(patches, directory)
    # `tarl apply` was interrupted: skip the files that it did not reach
    if any(target.done for target in targets):
        targets = [target for target in targets if not (len(target.parts) == 1 and target.as_searched)]
    contents: dict[Path, bytes] = {}
    told: list[str] = []
    for target in targets:
        content = _as_before(target)
        contents[target.path] = content
        whole = any(identical(content, file.before) for _, file in target.parts)
        rest = "the original text is restored" if whole else "later edits of other lines are kept"
        told.append(f"reverted in {target.shown}: {rest}")
    _write(targets, contents)
    return told


def _together(patches: Sequence[Patch]) -> None:
    found = [str(conflict) for conflict in conflicts(patches)]
    if found:
        raise RefusedError(f"{'; '.join(found)}: apply one of them, then search for the other repair again.")


def _halfway(targets: Sequence[Target]) -> set[Path]:
    """Return the files that an interrupted run has already changed."""
    done = {target.path for target in targets if target.done}
    return done if len(done) < len(targets) else set()


def _changed(target: Target, force: bool) -> bytes:
    """Return a file's patched content. Raise RefusedError if this content was not tested."""
    if target.as_searched:
        for patch, file in target.parts:
            tested(target, patch, file, target.content)
        return combined(target.content, [one for _, file in target.parts for one in file.replacements])
    content = target.content
    for patch, file in target.parts:
        if identical(content, file.after) or (_fits(file.reverse, content) and not _fits(file, content)):
            raise RefusedError(f"{patch.name} is already applied to {target.shown}: nothing was changed.")
        try:
            changed = file.applied(content)
        except MisfitError as misfit:
            raise RefusedError(
                f"{target.shown} differs from the text that {patch.name} was made for, and the change at line "
                f"{misfit} does not apply: restore that text, or search for the repair again."
            ) from misfit
        original = _before_others(content, patch, file)
        if original is not None:
            tested(target, patch, file, original)
        elif not force:
            raise RefusedError(
                f"{target.shown} has changed since {patch.name} was tested. The patch still applies, but its result "
                "is untested: search for the repair again, or apply it with --force."
            )
        else:
            sealed(patch)
        content = changed
    return content


def _before_others(content: bytes, patch: Patch, file: FilePatch) -> bytes | None:
    """Return the tested text underneath other patches, if `content` contains it."""
    others = sorted(path for path in patch.path.parent.glob("*.patch") if path.name != patch.name)
    for path in others:
        try:
            made = [one for one in read(path).files if one.name == file.name and one.before == file.before]
        except RepairError:
            continue
        for one in made:
            if (original := one.reverse.exact(content)) is not None:
                return original
    return None


def _fits(file: FilePatch, content: bytes) -> bool:
    try:
        file.applied(content)
    except MisfitError:
        return False
    return True


def _as_before(target: Target) -> bytes:
    """Return a file's content with the patches undone."""
    content = separated(target.content, [one for _, file in target.parts for one in file.replacements])
    if content is not None and all(identical(content, file.before) for _, file in target.parts):
        return content
    content = target.content
    for patch, file in reversed(target.parts):
        if identical(content, file.after):
            tested(target, patch, file.reverse, content)
        else:
            sealed(patch)
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
            f"{target.shown} was edited in the lines of {patch.name} (line {misfit} of the patched file), so the "
            "patch cannot be undone: restore the file from version control."
        ) from misfit


def _write(targets: Sequence[Target], contents: Mapping[Path, bytes]) -> None:
    changes = [Change(one.path, one.project, one.content, contents[one.path]) for one in targets]
    try:
        replace_all(changes)
    except MovedError as moved:
        raise RefusedError(
            f"{moved.path} changed during the command: another program edited or replaced it. No file was changed; "
            "try again."
        ) from moved
    except OSError as problem:
        where = problem.filename or ", ".join(one.shown for one in targets)
        raise RepairError(
            f"{where} cannot be written ({problem.strerror}); no file was changed."
        ) from problem


def _again(patches: Sequence[Patch]) -> list[str]:
    """Return the commands that repeat the tests' comparisons."""
    commands = dict.fromkeys(command for patch in patches for command in patch.told("again"))
    return [f"again: {_move(patches)}{command}" for command in commands]


def _move(patches: Sequence[Patch]) -> str:
    """Return the shell prefix that changes to the right folder."""
    root = patches[0].root
    return f"cd {shlex.quote(shown(root))} && " if root is not None and root != Path.cwd() else ""


def _recording(patches: Sequence[Patch], targets: Sequence[Target]) -> list[str]:
    """Return the advice to record a permanent drift and commit the recording."""
    commands = dict.fromkeys(command for patch in patches for command in patch.told("record"))
    if not commands:
        return []
    files = " and ".join([*(target.shown for target in targets), ".tarl/utility"])
    return [
        *(f"then:  {_move(patches)}{command}" for command in commands),
        f"then:  commit {files} together: the drift is now part of the design",
    ]


def _titles(target: Target) -> str:
    return "; ".join(dict.fromkeys(patch.title.partition(": ")[2] for patch, _ in target.parts))
