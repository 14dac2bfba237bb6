"""Find out which lines of a package each test reaches, at a fraction of the cost of tracing.

In each branch-free piece of a function, an added statement stores a 1 in memory. All processes of a run share this
memory, so it also has the marks of forks and of killed processes. The package is compiled once with these stores;
`install` makes imports use the result.
"""

from __future__ import annotations

import ast
import builtins
import importlib.machinery
import json
import marshal
import mmap
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import CodeType
from typing import Any

NAME = "__reached__"  # name of the shared memory in builtins: one byte per line of the package
FOLDER = "REACH_MARKS"  # environment variable with the folder written by `compiled`
_COMPOUND = (
    ast.If,
    ast.For,
    ast.AsyncFor,
    ast.While,
    ast.Try,
    *((ast.TryStar,) if hasattr(ast, "TryStar") else ()),
    ast.With,
    ast.AsyncWith,
    ast.Match,
)
_SCOPES = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


@dataclass(frozen=True)
class Marks:
    """The marks of a package; `pieces` maps each mark to the file and lines of its piece."""

    pieces: Mapping[int, tuple[str, tuple[int, ...]]]
    memory: mmap.mmap

    def taken(self) -> list[int]:
        """Return the marks stored since the last call, and clear them."""
        data = self.memory[:]
        self.memory[:] = bytes(len(data))
        found, at = [], data.find(1)
        while at >= 0:
            found.append(at)
            at = data.find(1, at + 1)
        return found

    def lines(self, stored: Sequence[int]) -> dict[str, list[int]]:
        """Return the lines that the marks stand for, by file."""
        found: dict[str, list[int]] = {}
        for mark in stored:
            path, numbers = self.pieces[mark]
            found.setdefault(path, []).extend(numbers)
        return found


def pieces(body: Sequence[ast.stmt]) -> Iterator[list[ast.stmt]]:
    """Yield a block's statements in pieces; all statements of a piece run, unless an exception ends it.

    A compound statement ends a piece, because a `return` inside it may skip what follows.
    """
    piece: list[ast.stmt] = []
    for statement in body:
        piece.append(statement)
        if isinstance(statement, _COMPOUND):
            yield piece
            piece = []
    if piece:
        yield piece


def marked(tree: ast.Module, first: int) -> tuple[ast.Module, dict[int, tuple[int, ...]]]:
    """Add marks to all functions of a module; a mark is `first` plus its line number.

    Return the module, changed in place, and the lines of each mark.
    """
    found: dict[int, tuple[int, ...]] = {}
    _scope(tree.body, first, found, in_function=False)
    return ast.fix_missing_locations(tree), found


def _scope(body: list[ast.stmt], first: int, found: dict[int, tuple[int, ...]], *, in_function: bool) -> None:
    documented = bool(body) and isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant)
    result = body[: int(documented)]
    for piece in pieces(body[int(documented) :]):
        if in_function:
            mark = first + piece[0].lineno
            found[mark] = tuple(line for one in piece for line in _heads(one))
            store = ast.parse(f"{NAME}[{mark}] = 1").body[0]
            for node in ast.walk(store):
                if isinstance(node, ast.stmt | ast.expr):
                    ast.copy_location(node, piece[0])
            result.append(store)
        for statement in piece:
            result.append(statement)
            _inside(statement, first, found, in_function=in_function)
    body[:] = result


def _inside(statement: ast.stmt, first: int, found: dict[int, tuple[int, ...]], *, in_function: bool) -> None:
    function = isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef)
    inner = function or (in_function and not isinstance(statement, ast.ClassDef))
    owners: list[ast.AST] = [
        statement,
        *getattr(statement, "handlers", ()),
        *getattr(statement, "cases", ()),
    ]
    for owner in owners:
        for name in ("body", "orelse", "finalbody"):
            block = getattr(owner, name, None)
            if isinstance(block, list) and block:
                _scope(block, first, found, in_function=inner)


def _heads(statement: ast.stmt) -> Iterator[int]:
    """Yield a statement's lines without its blocks; for a `match`, include the lines of its patterns."""
    if isinstance(statement, _SCOPES):
        return
    blocks = [block for name in ("body", "cases") if (block := getattr(statement, name, None))]
    if isinstance(statement, ast.Match):
        yield from range(statement.lineno, (statement.subject.end_lineno or statement.lineno) + 1)
        for case in statement.cases:
            yield from range(case.pattern.lineno, max(case.pattern.lineno + 1, case.body[0].lineno))
    elif blocks:
        yield from range(statement.lineno, max(statement.lineno + 1, blocks[0][0].lineno))
    else:
        yield from range(statement.lineno, (statement.end_lineno or statement.lineno) + 1)


def compiled(root: Path, package: str, folder: Path) -> None:
    """Compile the package in `root` with marks; write everything that `install` and `marks` read."""
    first, files = 0, {}
    spots: dict[int, tuple[str, tuple[int, ...]]] = {}
    for number, file in enumerate(sorted((root / package).rglob("*.py"))):
        text = file.read_bytes()
        tree, found = marked(ast.parse(text), first)
        code = compile(tree, str(file), "exec", dont_inherit=True)
        (folder / f"{number}.code").write_bytes(marshal.dumps(code))
        files[str(file)] = f"{number}.code"
        spots |= {mark: (file.relative_to(root).as_posix(), lines) for mark, lines in found.items()}
        first += text.count(b"\n") + 2
    (folder / "memory").write_bytes(bytes(first))
    (folder / "files.json").write_text(json.dumps(files))
    (folder / "pieces.json").write_text(json.dumps(spots))


def install() -> None:
    """Make this process import the marked code, if the environment names a folder from `compiled`."""
    name = os.environ.get(FOLDER, "")
    if not name or hasattr(builtins, NAME):
        return
    folder = Path(name)
    files: dict[str, str] = json.loads((folder / "files.json").read_text())
    setattr(builtins, NAME, _memory(folder))
    original = importlib.machinery.SourceFileLoader.get_code

    def get_code(self: Any, fullname: str) -> CodeType | None:
        found = files.get(self.path)
        if found is None:
            return original(self, fullname)
        code: CodeType = marshal.loads((folder / found).read_bytes())  # noqa: S302 - written by `compiled`
        return code

    importlib.machinery.SourceFileLoader.get_code = get_code  # type: ignore[method-assign]


def marks() -> Marks:
    """Return this process's marks; `install` must have run in it."""
    read = json.loads((Path(os.environ[FOLDER]) / "pieces.json").read_text())
    return Marks(
        {int(mark): (path, tuple(lines)) for mark, (path, lines) in read.items()}, getattr(builtins, NAME)
    )


def _memory(folder: Path) -> mmap.mmap:
    with (folder / "memory").open("r+b") as file:
        return mmap.mmap(file.fileno(), 0)
