"""Copy a built site into the published tree, which has a directory for each version, named after its tag.

    python -m website.publish SITE TREE VERSION

A version such as v0.2.0 becomes the directory 0.2.0, and `latest` is a copy of the newest version. Any other name, such
as `dev`, becomes a directory of that name. `versions.json` provides the menu of versions. `schemas/` has the newest
version's JSON schemas, so that their addresses stay the same.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
from pathlib import Path

FORWARD = """<!doctype html>
<meta charset="utf-8"><title>TARL</title>
<meta http-equiv="refresh" content="0; url={to}"><link rel="canonical" href="{to}">
<a href="{to}">TARL's documentation</a>
"""
NUMBER = re.compile(r"(\d+)\.(\d+)\.(\d+)")


def number(version: str) -> tuple[int, ...] | None:
    """Return the numbers of a released version; None for any other name."""
    found = NUMBER.fullmatch(version)
    return tuple(map(int, found.groups())) if found else None


def publish(site: Path, tree: Path, tag: str) -> None:
    """Copy a site into the tree under its tag's name. Raise ValueError for a tag that cannot name a directory."""
    version = re.sub(r"^v(?=\d)", "", tag)
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9._-]*", version) or version in ("latest", "schemas"):
        raise ValueError(f"{tag!r} cannot name a version: use letters, digits, dots and hyphens")
    _replace(site, tree / version)
    names = [
        path.name for path in tree.iterdir() if (path / "index.html").is_file() and path.name != "latest"
    ]
    released = sorted(
        (name for name in names if number(name)), key=lambda name: number(name) or (), reverse=True
    )
    others = sorted(set(names) - set(released))
    newest = (released or others)[0]
    versions = [
        {"version": name, "title": name, "aliases": ["latest"] * (name == newest)}
        for name in [*released, *others]
    ]
    (tree / "versions.json").write_text(json.dumps(versions, indent=1) + "\n", "utf-8")
    _replace(tree / newest, tree / "latest")
    _replace(tree / newest / "schemas", tree / "schemas")
    (tree / "index.html").write_text(FORWARD.format(to="latest/index.html"), "utf-8")
    (tree / ".nojekyll").touch()


def _replace(source: Path, target: Path) -> None:
    shutil.rmtree(target, ignore_errors=True)
    shutil.copytree(source, target)


def main() -> None:
    """Copy a site into a tree."""
    parser = argparse.ArgumentParser(description="Copy a built site into the published tree.")
    parser.add_argument("site", type=Path)
    parser.add_argument("tree", type=Path)
    parser.add_argument("version")
    arguments = parser.parse_args()
    publish(arguments.site, arguments.tree, arguments.version)


if __name__ == "__main__":
    main()
