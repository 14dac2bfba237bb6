"""Copy the real nodes, at their commits, next to their worlds. This repository does not contain the nodes.

    python benchmarks/real_nodes/bring.py TARGET --source PLACE

PLACE is where the repositories are: a folder of clones or checkouts named owner/name or owner+name (a checkout may
lack its `.git`), or the beginning of a URL to clone from, such as https://github.com. Each file must be the blob that
`nodes.json` names, whatever its source. TARGET/NAME then holds the world's test and, at its path in the repository,
the node:

    cd TARGET/NAME && pytest --tarl-record && pytest --tarl-online --tarl-repair

With `--by-hand`, the nodes contain a repair that a person found, which shows that a repair exists.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Node:
    """A file of a repository at a commit; `blob` is the name that git gives to its text."""

    name: str
    repo: str
    commit: str
    path: str
    blob: str
    by_hand: list[list[str]]  # pairs of a text in the file and the replacement that restores the reward


def nodes() -> list[Node]:
    """Return the nodes of the benchmark."""
    return [Node(**entry) for entry in json.loads((HERE / "nodes.json").read_text())]


def blob(text: bytes) -> str:
    """Return git's name for a file of this text."""
    return hashlib.sha1(b"blob %d\0" % len(text) + text, usedforsecurity=False).hexdigest()


def text_of(node: Node, source: str, scratch: Path) -> bytes:
    """Return the node's text. Raise SystemExit if the file is missing or differs."""
    place = Path(source)
    found = [place / node.repo, place / node.repo.replace("/", "+")] if place.is_dir() else []
    plain = next((folder / node.path for folder in found if (folder / node.path).is_file()), None)
    if plain is not None and blob(plain.read_bytes()) == node.blob:
        return plain.read_bytes()
    clone = next((str(folder) for folder in found if folder.is_dir()), "") or cloned(node, source, scratch)
    show = ["git", "-C", clone, "cat-file", "blob", node.blob]
    done = subprocess.run(show, capture_output=True, check=False)
    if done.returncode or blob(done.stdout) != node.blob:
        raise SystemExit(
            f"{clone}: no {node.path} of {node.repo} at commit {node.commit}. Give another --source."
        )
    return done.stdout


def repaired(node: Node, text: bytes) -> bytes:
    """Return the text with the repair that was found by hand."""
    for old, new in node.by_hand:
        if text.count(old.encode()) != 1:
            raise SystemExit(f"{node.path}: {old!r} must occur once, not {text.count(old.encode())} times.")
        text = text.replace(old.encode(), new.encode())
    return text


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
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        for node in nodes():
            text = text_of(node, arguments.source, Path(scratch))
            folder = arguments.target / node.name
            shutil.copytree(HERE / "worlds" / node.name, folder, dirs_exist_ok=True)
            (folder / node.path).parent.mkdir(parents=True, exist_ok=True)
            (folder / node.path).write_bytes(repaired(node, text) if arguments.by_hand else text)
            print(f"{folder / node.path}: {node.repo} at {node.commit[:12]}", file=sys.stderr)


if __name__ == "__main__":
    main()
