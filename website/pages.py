"""Copy the repository's pages to the site, and adapt their links."""

from __future__ import annotations

import os
import re
import shutil
from functools import cache
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).parent.parent
TOP = ("CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md", "GOVERNANCE.md", "CODE_OF_CONDUCT.md")
ONLY = Path(__file__).parent / "site_pages"  # pages that exist only on the site, relative to its root
GENERATED = {f"docs/reference/{name}.md" for name in ("options", "commands", "settings", "schemas", "api")}
LINK = re.compile(r"(\]\()([^)\s]+)(\))")


def address(path: PurePosixPath) -> PurePosixPath:
    """Return the path on the site of a file in the repository."""
    parts = path.parts
    if parts[0] == "docs":
        path = PurePosixPath(*parts[1:])
    elif path.suffix == ".md" and len(parts) == 1:
        path = PurePosixPath(path.name.lower())
    elif path.name.endswith(".schema.json"):
        return PurePosixPath("schemas", path.name)
    return path.with_name("index.md") if path.name == "README.md" else path


@cache
def written() -> dict[PurePosixPath, Path]:
    """Return every page, picture and linked file that is not generated: path in the repository → file."""
    files = [*(ROOT / "docs").rglob("*"), *(ROOT / name for name in TOP), *(ROOT / "examples").rglob("*.md")]
    linked = [*(ROOT / "examples").rglob("*.py"), *schemas()]
    places = {PurePosixPath(path.relative_to(ROOT).as_posix()): path for path in sorted({*files, *linked})}
    places |= {
        PurePosixPath("docs") / path.relative_to(ONLY).as_posix(): path for path in sorted(ONLY.rglob("*.md"))
    }
    return {
        place: path
        for place, path in places.items()
        if path.is_file() and not any(part == "__pycache__" or part.startswith(".") for part in place.parts)
    }


def schemas() -> list[Path]:
    """Return the JSON schemas of the packages."""
    return sorted(
        path for name in ("pytest_tarl", "tarl_lint") for path in (ROOT / name).rglob("*.schema.json")
    )


def relinked(text: str, page: PurePosixPath) -> str:
    """Return a page's text with its links adapted to the site. Raise ValueError for a broken link."""

    def moved(match: re.Match[str]) -> str:
        target, _, anchor = match[2].partition("#")
        if not target or "://" in target or target.startswith("mailto:"):
            return match[0]
        return f"{match[1]}{_relative(target, anchor, page)}{match[3]}"

    return LINK.sub(moved, text)


def _relative(target: str, anchor: str, page: PurePosixPath) -> str:
    """Convert a link between files in the repository to one between their paths on the site."""
    place = PurePosixPath(os.path.normpath(page.parent / target))
    if (ROOT / place).is_dir():
        place /= "README.md"
    if place not in written() and str(place) not in GENERATED:
        raise ValueError(f"{page}: the link {target} leads to no page of the site")
    there = address(place)
    here = address(page).parent
    shared = 0
    while shared < min(len(here.parts), len(there.parts) - 1) and here.parts[shared] == there.parts[shared]:
        shared += 1
    link = "/".join([".."] * (len(here.parts) - shared) + list(there.parts[shared:]))
    return f"{link}#{anchor}" if anchor else link


def stage(target: Path) -> None:
    """Write all pages, pictures and linked files that are not generated below a directory."""
    for place, path in written().items():
        to = target / address(place)
        to.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".md":
            to.write_text(relinked(path.read_text("utf-8"), place), "utf-8")
        else:
            shutil.copyfile(path, to)
