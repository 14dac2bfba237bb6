"""Extract Python listings that create a node from documentation, as scripts for `foreign_nodes.py`.

    python benchmarks/foreign_listings.py FOLDER OUT      # FOLDER: one folder per unpacked package

A listing is a fenced or indented block of Python code in a Markdown, reStructuredText or metadata file. Each package
that has such listings is copied to OUT, with the listings in its folder `listings`. Nothing is executed.
"""

from __future__ import annotations

import argparse
import ast
import re
import shutil
import textwrap
from collections.abc import Iterator
from pathlib import Path

from foreign_scripts import MADE_BY, starts_something

PAGES = frozenset({".md", ".rst", ".txt"})
METADATA = frozenset({"METADATA", "PKG-INFO"})
FENCED = re.compile(
    r"^([ \t]*)(?:```|~~~)[ \t]*\{?(?:python3?|py)\b[^\n]*\n(.*?)^\1(?:```|~~~)", re.MULTILINE | re.DOTALL
)
INDENTED = re.compile(
    r"^([ \t]*)\.\. code(?:-block)?:: *python[^\n]*\n((?:\1[ \t]+[^\n]*\n|[ \t]*\n)+)", re.MULTILINE
)


def listings(package: Path) -> Iterator[tuple[str, str]]:
    """Yield page and text of each listing that creates a node when run; each text once."""
    seen: set[str] = set()
    for page in sorted(package.rglob("*")):
        if not page.is_file() or page.is_symlink() or not (page.suffix in PAGES or page.name in METADATA):
            continue
        text = page.read_text("utf-8", errors="replace")
        for found in (*FENCED.finditer(text), *INDENTED.finditer(text)):
            code = textwrap.dedent(found[2])
            plain = "".join(code.split())
            if plain not in seen and _makes_node(code):
                seen.add(plain)
                yield page.stem, code


def _makes_node(code: str) -> bool:
    try:
        tree = ast.parse(code)
    except (SyntaxError, ValueError):
        return False
    return MADE_BY.search(code) is not None and any(map(starts_something, tree.body))


def main() -> None:
    """Write the listings, and print how many each package has."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("folder", type=Path, help="folder of unpacked packages, one folder per package")
    parser.add_argument("out", type=Path, help="folder for copies of the packages with listings")
    options = parser.parse_args()
    for package in sorted(one for one in options.folder.iterdir() if one.is_dir()):
        found = list(listings(package))
        if not found:
            continue
        copy = options.out / package.name
        shutil.copytree(package, copy, symlinks=True)
        (copy / "listings").mkdir(exist_ok=True)
        for number, (page, code) in enumerate(found, 1):
            name = re.sub(r"\W", "_", page)
            (copy / "listings" / f"{name}_{number}.py").write_text(code)
        print(f"{package.name}: {len(found)}")


if __name__ == "__main__":
    main()
