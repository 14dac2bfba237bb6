"""Detect changes in a test's modules: its file, modules that it imports from below the root, and conftest files.

A test's simulated world, reward and helpers affect a recording as much as the node does. Each definition has a hash
that ignores comments, layout and docstrings. Marker arguments, other tests and data files are not hashed.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

DIGITS = 12  # hexadecimal digits of a hash
SHOWN = 3  # maximum number of files in a message, and of definitions per file
REST = ""  # key for the hash of all statements outside definitions

Digests = Mapping[str, Mapping[str, str]]  # file (relative to the root) → definition → hash


def digests(test: str, root: Path, nodes: Collection[Path]) -> dict[str, dict[str, str]]:
    """Return the hashes for a test, given by node ID. Skip files that cannot be read or parsed."""
    name, *parts = test.partition("[")[0].split("::")
    found: dict[str, dict[str, str]] = {}
    first = (root / name).resolve()
    for path, tree in modules(first, root, nodes):
        own = parts if path == first else None
        found[path.relative_to(root.resolve()).as_posix()] = dict(sorted(_definitions(tree, own).items()))
    return dict(sorted(found.items()))


def modules(first: Path, root: Path, nodes: Collection[Path] = ()) -> Iterator[tuple[Path, ast.Module]]:
    """Yield a test's file, the modules that it imports from below the root, and its conftest files, with trees.

    Skip the files in `nodes` and files that cannot be read or parsed.
    """
    waiting = [first, *_conftests(first.parent, root.resolve())]
    seen = {path.resolve() for path in nodes}
    while waiting:
        path = waiting.pop()
        if path in seen or not path.is_file() or not path.is_relative_to(root.resolve()):
            continue
        seen.add(path)
        try:
            tree = ast.parse(path.read_bytes())
        except (OSError, SyntaxError, ValueError):
            continue
        waiting += _imported(tree, path, root.resolve())
        yield path, tree


def changes(before: Digests, after: Digests) -> Iterator[str]:
    """Yield the changes of each file; nothing for an older recording without hashes."""
    if not before:
        return
    for path in sorted({*before, *after}):
        if path not in after:
            yield f"{path} is gone"
        elif path not in before:
            yield f"{path} is new"
        elif before[path] != after[path]:
            names = sorted({*before[path], *after[path]})
            named = [
                name or "statements" for name in names if before[path].get(name) != after[path].get(name)
            ]
            more = f" and {len(named) - SHOWN} more" if len(named) > SHOWN else ""
            yield f"{path} ({', '.join(named[:SHOWN])}{more})"


def remark(before: Digests, after: Digests) -> Iterator[str]:
    """Yield a sentence on the changes since the recording, if there are any."""
    found = list(changes(before, after))
    if found:
        more = f" and {len(found) - SHOWN} more files" if len(found) > SHOWN else ""
        yield (
            f"the test itself was edited since the recording: {', '.join(found[:SHOWN])}{more}. Differences may come "
            "from these edits instead of the drift. To keep the edits, record again with --tarl-record."
        )


def _conftests(folder: Path, root: Path) -> list[Path]:
    inside = [one for one in (folder, *folder.parents) if one.is_relative_to(root)]
    return [one / "conftest.py" for one in inside]


def _imported(tree: ast.Module, path: Path, root: Path) -> list[Path]:
    """Return the files that a module's imports may refer to; some may not exist."""
    package = path.parent
    while (package / "__init__.py").exists() and package != root:
        package = package.parent
    bases = dict.fromkeys((path.parent, package, root, root / "src"))
    named: list[tuple[Path, str]] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            named += [(base, one.name) for base in bases for one in node.names]
        elif isinstance(node, ast.ImportFrom):
            modules = [
                node.module or "",
                *(".".join(filter(None, (node.module, one.name))) for one in node.names),
            ]
            above = [path.parent, *path.parent.parents][node.level - 1 :][:1] if node.level else list(bases)
            named += [(base, module) for base in above for module in modules if module]
    return [file.resolve() for base, module in named for file in _files(base, module)]


def _files(base: Path, module: str) -> Iterator[Path]:
    parts = module.split(".")
    for end in range(1, len(parts) + 1):
        here = base.joinpath(*parts[:end])
        yield here.with_name(f"{here.name}.py")
        yield here / "__init__.py"


def _definitions(tree: ast.Module, test: Collection[str] | None) -> dict[str, str]:
    """Return the hash of every definition. For the test's own file, `test` has its function and class names."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            node.decorator_list = [one for one in node.decorator_list if not _marks(one)]
            if ast.get_docstring(node, clean=False) is not None:
                node.body = node.body[1:] or [ast.Pass()]
    used = {one.id for one in ast.walk(tree) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Load)}
    texts: dict[str, list[str]] = {}
    for statement in tree.body:
        for name, text in _named(statement):
            outermost = name.partition(".")[0]
            other_test = test is not None and outermost.lower().startswith("test") and outermost not in test
            only_marked = test is not None and isinstance(statement, ast.Assign) and name not in used
            if not other_test and not only_marked:
                texts.setdefault(name, []).append(text)
    return {
        name: hashlib.sha256("\n".join(found).encode()).hexdigest()[:DIGITS] for name, found in texts.items()
    }


def _named(statement: ast.stmt) -> Iterator[tuple[str, str]]:
    """Yield each definition in a statement, with its source; methods count as separate definitions."""
    if isinstance(statement, (ast.Import, ast.ImportFrom)) or (
        isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
    ):
        return
    if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef)):
        yield statement.name, ast.unparse(statement)
    elif isinstance(statement, ast.ClassDef):
        methods = [one for one in statement.body if isinstance(one, (ast.FunctionDef, ast.AsyncFunctionDef))]
        for one in methods:
            yield f"{statement.name}.{one.name}", ast.unparse(one)
        rest = [one for one in statement.body if one not in methods] or [ast.Pass()]
        statement.body = rest
        yield statement.name, ast.unparse(statement)
    elif isinstance(statement, ast.Assign) and all(isinstance(name, ast.Name) for name in statement.targets):
        for name in statement.targets:
            yield ast.unparse(name), ast.unparse(statement.value)
    elif isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name):
        yield statement.target.id, ast.unparse(statement)
    else:
        yield REST, ast.unparse(statement)


def _marks(decorator: ast.expr) -> bool:
    called = decorator.func if isinstance(decorator, ast.Call) else decorator
    return ast.unparse(called).endswith("mark.tarl")
