"""Copy the real nodes, at their commits, next to their worlds. This repository does not contain the nodes.

    python benchmarks/real_nodes/bring.py TARGET --source PLACE

PLACE is where the repositories are. It is either a folder of clones or checkouts named owner/name or owner+name (a
checkout may lack its `.git`), or the beginning of a URL to clone from, such as https://github.com. Packages of PyPI are
wheels in this folder, or come from pip. Each file must be the blob that `nodes.json` names, whatever its source.
TARGET/NAME then holds the world's test and, at its path in the repository, the node:

    cd TARGET/NAME && pytest --tarl-record && pytest --tarl-online --tarl-repair

With `--by-hand`, the nodes contain a repair that a person found, which shows that a repair exists. A node with a repair
for each drift is then written once for each, to TARGET/NAME-DRIFT.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent


Edits = Sequence[Sequence[str]]
PYPI = "pypi"


@dataclass(frozen=True)
class Node:
    """A file of a repository at a commit; `blob` is the name that git gives to its text.

    A node of the repository "pypi" is a wheel, and its `commit` is the requirement for pip. `by_hand` is the repair of
    a person: a list of pairs, each a text in the file and its replacement. If each drift has its own repair, `by_hand`
    maps the drift to triples: a path, a text in that file, and its replacement.
    """

    name: str
    repo: str
    commit: str
    path: str
    blob: str
    by_hand: Edits | dict[str, Edits]
    more: Sequence[Sequence[str]] = ()  # pairs of a path and a blob: other files that the node needs

    @property
    def repairs(self) -> dict[str, Edits]:
        """Return the edits of each repair as triples, by the name of the folder that gets this repair."""
        if isinstance(self.by_hand, dict):
            return {f"{self.name}-{drift.replace(' ', '-')}": edits for drift, edits in self.by_hand.items()}
        return {self.name: [[self.path, old, new] for old, new in self.by_hand]}


def nodes() -> list[Node]:
    """Return the nodes of the benchmark."""
    return [Node(**entry) for entry in json.loads((HERE / "nodes.json").read_text())]


def blob(text: bytes) -> str:
    """Return git's name for a file of this text."""
    return hashlib.sha1(b"blob %d\0" % len(text) + text, usedforsecurity=False).hexdigest()


def text_of(node: Node, path: str, name: str, source: str, scratch: Path) -> bytes:
    """Return the text of a node's file, whose blob has this name. Raise SystemExit if it is missing or differs."""
    place = Path(source)
    found = [place / node.repo, place / node.repo.replace("/", "+")] if place.is_dir() else []
    plain = next((folder / path for folder in [*found, place] if (folder / path).is_file()), None)
    if plain is not None and blob(plain.read_bytes()) == name:
        return plain.read_bytes()
    if node.repo == PYPI:
        return downloaded(node, name, scratch)
    clone = next((str(folder) for folder in found if folder.is_dir()), "") or cloned(node, source, scratch)
    show = ["git", "-C", clone, "cat-file", "blob", name]
    done = subprocess.run(show, capture_output=True, check=False)
    if done.returncode or blob(done.stdout) != name:
        raise SystemExit(f"{clone}: no {path} of {node.repo} at commit {node.commit}. Give another --source.")
    return done.stdout


def downloaded(node: Node, name: str, scratch: Path) -> bytes:
    """Return a wheel of PyPI."""
    command = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", "-d", str(scratch), node.commit]
    wheel = scratch / node.path
    if subprocess.run(command, check=False).returncode or blob(wheel.read_bytes()) != name:
        raise SystemExit(f"{node.commit}: pip did not download {node.path} with the blob {name}.")
    return wheel.read_bytes()


def written(node: Node, source: str, scratch: Path, folder: Path) -> None:
    """Write the node's files and its world into a folder."""
    shutil.copytree(HERE / "worlds" / node.name, folder, dirs_exist_ok=True)
    for path, name in [(node.path, node.blob), *node.more]:
        text = text_of(node, path, name, source, scratch)
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(text)
    if node.repo == PYPI:
        with zipfile.ZipFile(folder / node.path) as wheel:
            wheel.extractall(folder)
        (folder / node.path).unlink()


def repaired(folder: Path, edits: Edits) -> None:
    """Repair a node's files as a person did."""
    for path, old, new in edits:
        text = (folder / path).read_bytes()
        if text.count(old.encode()) != 1:
            raise SystemExit(f"{path}: {old!r} must occur once, not {text.count(old.encode())} times.")
        (folder / path).write_bytes(text.replace(old.encode(), new.encode()))


def cloned(node: Node, source: str, scratch: Path) -> str:
    """Clone a repository once, without a work tree, and return its folder."""
    target = scratch / node.repo.replace("/", "+")
    if not target.exists():
        command = ["git", "clone", "--quiet", "--bare", f"{source.rstrip('/')}/{node.repo}", str(target)]
        if subprocess.run(command, check=False).returncode:
            raise SystemExit(f"{source}: {node.repo} cannot be cloned from there. Give another --source.")
    return str(target)


def main() -> None:
    """Write each node into the folder of its world."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("target", type=Path)
    parser.add_argument(
        "--source", default="https://github.com", help="folder of repositories, or beginning of a URL"
    )
    parser.add_argument(
        "--by-hand", action="store_true", help="write the nodes with the repair that a person found"
    )
    parser.add_argument("--only", action="append", metavar="NAME", help="only this node; repeatable")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        for node in nodes():
            if arguments.only and node.name not in arguments.only:
                continue
            for name, edits in node.repairs.items() if arguments.by_hand else [(node.name, [])]:
                folder = arguments.target / name
                written(node, arguments.source, Path(scratch), folder)
                repaired(folder, edits)
                print(f"{folder / node.path}: {node.repo} at {node.commit[:12]}", file=sys.stderr)


if __name__ == "__main__":
    main()
