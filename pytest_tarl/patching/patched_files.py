"""Locate the files of a patch; refuse files outside the project."""

from __future__ import annotations

from pathlib import Path

from pytest_tarl.errors import RefusedError, RepairError
from pytest_tarl.patching.patch_reader import Patch, in_closed_folder


def located(patch: Patch, directory: Path | None) -> tuple[Path, list[Path]]:
    """Return the project's folder and the patched files in order, with links resolved.

    The project is `directory` if given. Otherwise it is the git repository around `.tarl` or, without one, the folder
    that contains `.tarl`. Raise RepairError if a file does not exist, and RefusedError if it is outside the project.
    """
    try:
        return _located(patch, directory)
    except (OSError, ValueError) as problem:
        raise RepairError(
            f"{patch.name} contains invalid file names ({problem}): make it again."
        ) from problem


def _located(patch: Patch, directory: Path | None) -> tuple[Path, list[Path]]:
    if directory is not None:
        project = directory.resolve()
        likely = [project]
    elif patch.root is not None:
        project = _project(patch.root.resolve())
        likely = [(patch.root.resolve() / patch.base).resolve()]
        _keep_inside(patch, patch.base, likely[0], project)
    else:
        here = Path.cwd().resolve()
        project = _project(here)
        likely = [folder for folder in (here, *here.parents) if folder.is_relative_to(project)]
    base = next((folder for folder in likely if not _missing(patch, folder)), None)
    if base is None:
        raise RepairError(
            f"{patch.name} changes {_missing(patch, likely[0])[0]}, but {likely[0]} has no such file: name the folder "
            "to which the patch's paths are relative with --directory."
        )
    files = [(base / file.name).resolve() for file in patch.files]
    for file, path in zip(patch.files, files, strict=True):
        _keep_inside(patch, file.name, path, project)
    return project, files


def _keep_inside(patch: Patch, named: str, path: Path, project: Path) -> None:
    if not path.is_relative_to(project) or in_closed_folder(path.relative_to(project).parts):
        raise RefusedError(
            f"{patch.name} leads out of {project}: {named} is {path}. Nothing was changed; if "
            "this is intended, name "
            "the folder with --directory."
        )


def _project(folder: Path) -> Path:
    """Return the git repository around a folder; without one, the folder itself."""
    return next((each for each in (folder, *folder.parents) if (each / ".git").exists()), folder)


def _missing(patch: Patch, folder: Path) -> list[str]:
    return [file.name for file in patch.files if not (folder / file.name).is_file()]
