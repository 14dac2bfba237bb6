"""Import node files: instrument them, apply candidate repairs, and execute them again in each episode.

This is the only file that touches `sys.meta_path`.
"""

from __future__ import annotations

import ast
import builtins
import contextlib
import sys
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import lru_cache, partial
from importlib import import_module
from importlib.machinery import ModuleSpec, SourceFileLoader
from itertools import accumulate
from operator import attrgetter
from pathlib import Path
from types import CodeType, FrameType, MappingProxyType, ModuleType
from typing import Any

from pytest_tarl.instrumentation.codecache import CodeCache
from pytest_tarl.instrumentation.constants import bound
from pytest_tarl.instrumentation.launching import (
    importable,
    on_search_path,
    restored_interpreter,
    shown,
    workspace,
)
from pytest_tarl.instrumentation.nodecode import NodeCode
from pytest_tarl.instrumentation.separate_modules import SeparateModules
from pytest_tarl.instrumentation.sites import Position, Positions
from pytest_tarl.stale_modules import holders, of_tests, outlived

Bind = Callable[[CodeType], CodeType]
_INSTALLED = frozenset({"site-packages", "dist-packages"})
_OURS = frozenset({"pytest_tarl", "tarl_lint"})


class AlreadyImportedWarning(UserWarning):
    """A node file was imported before the episode, so it runs without instrumentation."""


class NodeImports:
    """Compile and execute a node, with the modules that it imports, for one episode.

    `plan` has the sites of each file. `overlay` maps files to replacement texts, in which sites keep their lines where
    possible. Inside a `with` block, this object handles the imports of all files in both; at its end, it removes the
    project modules that a node imported. `bind` (see `Recorder.bind`) gives code its hook and its buffer; without it,
    code gets only `hook`.
    """

    def __init__(
        self,
        root: Path,
        plan: Mapping[Path, Positions],
        hook: Callable[[int, Any], Any],
        overlay: Mapping[Path, str] = MappingProxyType({}),
        *,
        publishes: Collection[int] = (),
        bind: Bind | None = None,
    ) -> None:
        self._projects = {_resolved(root), *(workspace(path) for path in (*plan, *overlay))}
        self._code = NodeCode(
            plan, overlay, publishes, inline=bind is not None, cache=code_cache(_resolved(root))
        )
        self._overlay = overlay
        self._bind = bind or partial(bound, hook=hook)
        self._tails = {_tail(path) for path in self._code.files}
        self._executed: set[Path] = set()
        self._imported: set[str] = set()  # modules of this episode
        self._namespaces: list[dict[str, Any]] = []
        self._open = contextlib.ExitStack()
        self._before: set[str] = set()  # modules that were imported before the episode
        # edited files whose text before the edit was executed; set on exit
        self.older: tuple[Path, ...] = ()

    def __enter__(self) -> NodeImports:
        """Start handling imports."""
        early = self._early()
        self._before = set(sys.modules)
        self._open.callback(self._look_for_older, early)
        self._open.callback(self._warn, early)
        self._open.callback(self._forget_modules)
        self._open.enter_context(restored_interpreter())
        for path, text in self._overlay.items():
            self._open.enter_context(shown(path, text))
        sys.meta_path.insert(0, self)
        self._open.callback(sys.meta_path.remove, self)
        return self

    def __exit__(self, *_: object) -> None:
        """Restore sys.modules, sys.path and `__main__`."""
        self._open.close()

    @property
    def unrecorded(self) -> Mapping[Path, tuple[Position, ...]]:
        """Return, by file, the positions of sites at which nothing could be recorded."""
        return self._code.unrecorded

    def separate(self) -> SeparateModules:
        """Return an object that gives each program its own copies of the project's modules."""
        belonging: dict[str, tuple[ModuleType, bool]] = {}

        def own() -> Iterator[str]:
            for name in self._imported:
                module = sys.modules.get(name)
                if module is None:
                    continue
                known = belonging.get(name)
                if known is None or known[0] is not module:
                    known = belonging[name] = module, self._belongs(module)
                if known[1]:
                    yield name

        return SeparateModules(own)

    def compile_file(self, path: Path) -> CodeType:
        """Compile a file that records its sites. Raise SyntaxError or OSError, as an import does."""
        code = self._code.compile(path)
        return self._bind(code) if self._code.recorded(path.resolve()) else code

    def run(self, path: Path, entry: str | None = None) -> None:
        """Run a node's file as a script, or call the function named by its entry point."""
        __tracebackhide__ = True
        if entry is None:
            self.run_script(path)
        else:
            self.run_entry(path, entry)

    def run_script(self, path: Path, name: str = "__main__") -> ModuleType:
        """Execute a file as `python path` does, in a new module that `sys.modules` lists as `name`.

        Set `__package__` as `python -m` does, so that relative imports work.
        """
        __tracebackhide__ = True
        root, full_name = importable(path)
        package = full_name.rpartition(".")[0]
        module = ModuleType(name)
        loader = NodeLoader(name, str(path), self)
        module.__file__ = str(path)
        module.__loader__ = loader
        module.__dict__.update(__builtins__=builtins, __cached__=None)
        if package:
            module.__spec__ = ModuleSpec(full_name, loader, origin=str(path))
            module.__package__ = package
        code = self.compile_file(path)
        sys.modules[name] = module
        on_search_path(root)
        if (
            package
            and (path.parent / f"{package.partition('.')[0]}.py").is_file()
            and _imports_relatively(path)
        ):
            # import the package first: a module of the same name beside the script would hide it
            import_module(package)
        on_search_path(path.parent)
        self.prepare(module, path)
        exec(code, module.__dict__)  # noqa: S102 - running the node is the purpose
        return module

    def run_entry(self, path: Path, entry: str) -> None:
        """Import a file under its own name and call its function `entry`, as a `console_scripts` entry point does.

        Raise SystemExit with the function's return value, if that is true.
        """
        __tracebackhide__ = True
        root, name = importable(path)
        on_search_path(root)
        for part in accumulate(name.split("."), "{}.{}".format):
            self._imported.add(part)
        found = attrgetter(entry)(import_module(name))()
        if found:
            raise SystemExit(found)

    def prepare(self, module: ModuleType, path: Path) -> None:
        """Register a module whose code is about to be executed."""
        file = path.resolve()
        self._executed.add(file)
        self._projects.add(workspace(file))
        self._namespaces.append(module.__dict__)

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        """Find a file of the plan or the overlay; for any other import, only note whether a node asked for it."""
        if fullname.rpartition(".")[2] not in self._tails:
            if fullname.partition(".")[0] not in _OURS and self._asked_by_node(sys._getframe(1)):
                self._imported.add(fullname)
            return None
        spec = self._found_by_others(fullname, path, target)
        if spec is None or spec.origin is None or type(spec.loader) is not SourceFileLoader:
            return spec
        file = Path(spec.origin).resolve()
        if file in self._code.files:
            spec.loader = NodeLoader(fullname, spec.origin, self)
            self._imported.add(fullname)
        elif self._asked_by_node(sys._getframe(1)):
            self._imported.add(fullname)
        return spec

    def edited(self, path: Path) -> bytes | None:
        """Return the replacement text of a file, or None if it is unchanged."""
        return self._code.edited(path.resolve())

    def _found_by_others(self, fullname: str, path: Any, target: Any) -> ModuleSpec | None:
        for finder in sys.meta_path:
            if finder is not self and hasattr(finder, "find_spec"):
                spec = finder.find_spec(fullname, path, target)
                if spec is not None:
                    return spec
        return None

    def _asked_by_node(self, frame: FrameType | None) -> bool:
        """Return whether a node or a module of this episode is on the call stack."""
        while frame is not None:
            space = frame.f_globals
            if space.get("__name__") in self._imported or any(space is known for known in self._namespaces):
                return True
            frame = frame.f_back
        return False

    def _early(self) -> dict[Path, str]:
        """Return the files of the plan and the overlay that were already imported, with their module names."""
        early: dict[Path, str] = {}
        endings = tuple(self._tails)
        names = "\n".join(sys.modules) + "\n"
        if not any(f"{ending}\n" in names for ending in endings):
            return early  # ten times faster than checking every name, as below
        for name in [name for name in sys.modules if name.endswith(endings)]:
            file = (
                sys.modules[name].__dict__.get("__file__") if name.rpartition(".")[2] in self._tails else None
            )
            path = Path(file).resolve() if isinstance(file, str) else None
            if path is not None and path in self._code.files:
                early[path] = name
        return early

    def _warn(self, early: Mapping[Path, str]) -> None:
        for path in sorted(early.keys() - self._executed):
            warnings.warn(
                f"{path.name} was imported (as {early[path]}) before the episode began, so it ran without "
                "instrumentation and nothing was recorded in it: import it inside the test function, or start it "
                "with tarl.start.",
                AlreadyImportedWarning,
                stacklevel=2,
            )

    def _look_for_older(self, early: Mapping[Path, str]) -> None:
        """Collect the edited files whose old text ran: they were in use, but were not executed again."""
        missed = {path.resolve() for path in self._overlay} - self._executed
        if missed:
            self.older = tuple(sorted({*outlived(missed), *(missed & early.keys())}))

    def _forget_modules(self) -> None:
        """Remove from `sys.modules` the project's modules, and modules of this episode that refer to them."""
        own = [name for name in self._imported if name in sys.modules and self._belongs(sys.modules[name])]
        new = sys.modules.keys() - self._before - set(own) if own else set()
        others = holders((sys.modules[name] for name in own), sorted(new))
        for name in sorted((*own, *others), reverse=True):  # submodules before their packages
            module = sys.modules.pop(name)
            package, _, tail = name.rpartition(".")
            outer = sys.modules.get(package)
            if outer is not None and outer.__dict__.get(tail) is module:
                delattr(outer, tail)

    def _belongs(self, module: ModuleType) -> bool:
        """Return whether a module's source file is in the workspace of the node or the tests."""
        spec = module.__dict__.get("__spec__")
        if spec is None or not isinstance(spec.loader, SourceFileLoader) or not spec.origin:
            return False
        file = Path(spec.origin).resolve()
        if file in self._code.files:
            return True
        within = any(file.is_relative_to(project) for project in self._projects)
        return within and _INSTALLED.isdisjoint(file.parts) and not of_tests(file)


def _imports_relatively(path: Path) -> bool:
    """Return whether a file has relative imports."""
    tree = ast.parse(path.read_bytes())
    return any(isinstance(node, ast.ImportFrom) and node.level > 0 for node in ast.walk(tree))


class NodeLoader(SourceFileLoader):
    """A loader like Python's that loads instrumented code."""

    def __init__(self, fullname: str, path: str, imports: NodeImports) -> None:
        super().__init__(fullname, path)
        self._imports = imports

    def get_code(self, fullname: str) -> CodeType:  # noqa: ARG002 - the base class names it
        """Return the instrumented code."""
        return self._imports.compile_file(Path(self.path))

    def get_data(self, path: Any) -> bytes:
        """Return the text that runs, so that `get_source` shows it."""
        edited = self._imports.edited(Path(path))
        return super().get_data(path) if edited is None else edited

    def exec_module(self, module: ModuleType) -> None:
        """Execute the module."""
        self._imports.prepare(module, Path(self.path))
        super().exec_module(module)


@lru_cache(maxsize=8)
def _resolved(root: Path) -> Path:
    return root.resolve()


@lru_cache(maxsize=8)
def code_cache(root: Path) -> CodeCache:
    """Return a project's code cache, which all its episodes share."""
    return CodeCache(root / ".tarl" / "cache")


def _tail(path: Path) -> str:
    """Return the last part of a file's module name."""
    return path.parent.name if path.stem == "__init__" else path.stem
