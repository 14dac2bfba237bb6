"""Read every file of a workspace and report unreadable ones."""

from __future__ import annotations

import io
import re
import tokenize
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from tarl_lint.workspace.bounded_files import UnreadableError, read_bytes
from tarl_lint.workspace.cfg_files import configurations
from tarl_lint.workspace.interface_syntax import mistakes
from tarl_lint.workspace.launch_documents import xml_root
from tarl_lint.workspace.launch_model import LaunchedNode
from tarl_lint.workspace.launch_read import read_launch
from tarl_lint.workspace.model import Package, Problem, Workspace
from tarl_lint.workspace.node_programs import program
from tarl_lint.workspace.python.source_files import parsed

LARGEST: Final = 20_000_000  # maximum size of a file whose text is examined (bytes)
_DECLARED: Final = re.compile(rb"<\?xml[^>]*\sencoding\s*=\s*[\"']([\w.-]+)")
NO_YAML: Final = "YAML files were not examined: run pip install PyYAML"


@dataclass(frozen=True)
class Examined:
    """A workspace, together with all parts of it that could not be read.

    `foreign` are nodes that launch files start from packages outside the workspace, as `package/program`; `absent`
    are packages outside the workspace whose launch files are included. `symbolic` is the number of values in launch
    files that are known only on the robot. `note` describes the parts that were not examined at all.
    """

    workspace: Workspace
    foreign: tuple[str, ...] = ()
    absent: tuple[str, ...] = ()
    symbolic: int = 0
    note: str = ""


def examined(workspace: Workspace) -> Examined:
    """Read every file of the packages and return the packages with their problems."""
    found = _Examination(workspace)
    packages = tuple(found.package(one) for one in workspace.packages)
    return Examined(
        replace(workspace, packages=packages),
        tuple(sorted(found.foreign)),
        tuple(sorted(found.absent)),
        len(found.symbolic),
        found.note,
    )


class _Examination:
    """Examines packages, and collects the packages outside the workspace that launch files use."""

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace
        self.foreign: set[str] = set()
        self.absent: set[str] = set()
        self.symbolic: set[Problem] = set()
        self.note = ""
        self._seen: set[Problem] = set()

    def package(self, package: Package) -> Package:
        """Return a package with the problems of all its files; each problem belongs to one package."""
        problems = dict.fromkeys(package.problems)
        for file in package.launch_files:
            problems |= dict.fromkeys(self._launch(file))
        for file in package.configurations:
            problems |= dict.fromkeys((*_text(file, _python_encoding), *configurations(file)[1]))
        for file in package.interfaces:
            problems |= dict.fromkeys(_interface(file))
        for file in package.parameter_files:
            problems |= dict.fromkeys((*_text(file), *self._yaml(file)))
        for file in package.others:
            problems |= dict.fromkeys(_other(file))
        for file in sorted(_python_files(package)):
            problems |= dict.fromkeys(_python(file))
        for name in ("setup.cfg", "CMakeLists.txt"):
            if (package.folder / name).is_file():
                problems |= dict.fromkeys(_text(package.folder / name))
        new = [one for one in problems if one not in self._seen]
        self._seen.update(new)
        return replace(package, problems=tuple(sorted(new, key=lambda one: (one.file, one.line, one.reason))))

    def _launch(self, file: Path) -> Iterator[Problem]:
        """Yield the problems that may hide nodes; count values known only on the robot."""
        yield from _text(file, _python_encoding if file.suffix == ".py" else _xml_encoding)
        launch = read_launch(file, self.workspace)
        for one in launch.problems:
            if one.package and self.workspace.package(one.package) is None:
                self.absent.add(one.package)
            elif one.hides or not one.line:
                yield replace(one, given=())
            else:
                self.symbolic.add(one)
        for node in launch.nodes:
            yield from self._node(node)

    def _node(self, node: LaunchedNode) -> Iterator[Problem]:
        """Yield a problem if a launched program of the workspace is missing."""
        if "$(" in node.package + node.executable or node.kind == "container" or not node.package:
            return
        package = self.workspace.package(node.package)
        if package is None:
            self.foreign.add(f"{node.package}/{node.executable}")
        elif node.kind == "node" and not _builds(package, node.executable):
            found = program(node, self.workspace, _named(package, node.executable))
            if isinstance(found, str):
                found = (
                    f"{node.package} has no program {node.executable}" if found.startswith("no ") else found
                )
                yield Problem(node.file, node.line, f"the node {node.name or node.executable}: {found}")

    def _yaml(self, file: Path) -> Iterator[Problem]:
        try:
            import yaml
        except ModuleNotFoundError:
            self.note = NO_YAML
            return
        try:
            data = read_bytes(file, LARGEST)
            for _ in yaml.compose_all(data.decode("utf-8", errors="replace"), Loader=yaml.SafeLoader):
                pass
        except UnreadableError as reason:
            yield Problem(file, 0, str(reason))
        except (yaml.YAMLError, RecursionError) as error:
            mark = getattr(error, "problem_mark", None)
            said = getattr(error, "problem", None) or " ".join(str(error).split())[:100]
            yield Problem(file, mark.line + 1 if mark is not None else 0, f"it is not YAML: {said}")


def _builds(package: Package, name: str) -> bool:
    """Return whether a `CMakeLists.txt` names a program."""
    if name in (*package.compiled, *package.tests):
        return True
    try:
        text = read_bytes(package.folder / "CMakeLists.txt", LARGEST).decode("utf-8", errors="replace")
    except UnreadableError:
        return False
    return re.search(rf"(?<![\w.-]){re.escape(name)}(?![\w.-])", text) is not None


def _named(package: Package, name: str) -> list[Path]:
    """Return the files of a package with a name."""
    if not name or "/" in name or name in (".", "..") or set("*?[") & set(name):
        return []
    return [one for one in package.folder.rglob(name) if one.is_file()]


def _python_files(package: Package) -> set[Path]:
    """Return a package's Python files, without those of inner packages."""
    found = {one.path for one in package.executables if one.path is not None}
    for root in package.modules:
        found |= {root.path} if root.path.is_file() else set(root.path.rglob("*.py"))
    return found


def _python(file: Path) -> Iterator[Problem]:
    problems = [*_text(file, _python_encoding)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # warnings about escapes are left to other linters
        parsed(file, problems)
    yield from problems


def _interface(file: Path) -> Iterator[Problem]:
    unread = [*_text(file)]
    yield from unread
    if not any(one.line == 0 for one in unread):
        text = read_bytes(file, LARGEST).decode("utf-8", errors="replace")
        yield from (Problem(file, line, reason) for line, reason in mistakes(text, file.suffix))


def _other(file: Path) -> Iterator[Problem]:
    """Yield a problem for a file that may be a launch file, if it cannot be parsed."""
    problems: list[Problem] = []
    if file.suffix == ".py":
        yield from _python(file)
    else:
        xml_root(file, problems)
        yield from problems


def _text(file: Path, encoding: Callable[[bytes], str] = lambda _: "utf-8") -> Iterator[Problem]:
    """Yield a problem if a file cannot be read, or is not text in its encoding."""
    try:
        data = read_bytes(file, LARGEST)
        name = encoding(data)
        text = data.decode(name)
    except UnreadableError as reason:
        yield Problem(file, 0, str(reason))
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        yield Problem(
            file, line, f"it is not {error.encoding}: the byte 0x{data[error.start]:02x} is replaced"
        )
    except (LookupError, SyntaxError, UnicodeError) as error:
        yield Problem(file, 1, f"its encoding is unknown: {error}")
    else:
        if "\0" in text:
            yield Problem(
                file, text.count("\n", 0, text.index("\0")) + 1, "it is not text: it has a null byte"
            )


def _python_encoding(data: bytes) -> str:
    return tokenize.detect_encoding(io.BytesIO(data).readline)[0]


def _xml_encoding(data: bytes) -> str:
    declared = _DECLARED.match(data)
    return declared[1].decode("ascii") if declared is not None else "utf-8"
