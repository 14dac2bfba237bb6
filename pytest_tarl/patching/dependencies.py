"""Find message packages that are imported but missing from package.xml."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from pathlib import Path

_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_DEPENDS = re.compile(r"<(?:depend|exec_depend|run_depend)\b[^>]*>\s*([\w-]+)\s*</")
_NAME = re.compile(r"<name>\s*([\w-]+)\s*</name>")
_FIRST_FORMAT = re.compile(r"<package(?:\s+format\s*=\s*[\"']1[\"'])?\s*>")
_PARTS = ("msg", "srv", "action")


def undeclared(changed: Mapping[Path, str], root: Path) -> list[str]:
    """Return a sentence for each message package that a patch imports and package.xml does not list.

    `changed` maps files to their new text. Packages that the file imported before the patch are ignored.
    """
    told: dict[str, None] = {}
    for path, text in changed.items():
        if path.suffix != ".py":
            continue
        manifest = next(
            (one / "package.xml" for one in path.parents if (one / "package.xml").is_file()), None
        )
        if manifest is None:
            continue
        described = _COMMENT.sub("", manifest.read_text(encoding="utf-8", errors="replace"))
        known = {*_DEPENDS.findall(described), *_NAME.findall(described), *_imported(path.read_bytes())}
        kind = "run_depend" if _FIRST_FORMAT.search(described) else "exec_depend"
        place = manifest.relative_to(root) if manifest.is_relative_to(root) else manifest
        for package in sorted(_imported(text) - known):
            told[
                f"the patch imports messages of {package}, which {place.as_posix()} does not depend on: add "
                f"<{kind}>{package}</{kind}> there"
            ] = None
    return list(told)


def _imported(text: str | bytes) -> set[str]:
    """Return the packages that a file imports messages, services or actions from."""
    modules: list[str] = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and not node.level and node.module:
            modules += [node.module, *(f"{node.module}.{each.name}" for each in node.names)]
        elif isinstance(node, ast.Import):
            modules += [each.name for each in node.names]
    parts = (module.split(".") for module in modules)
    return {part[0] for part in parts if len(part) > 1 and part[1] in _PARTS}
