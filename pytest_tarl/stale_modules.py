"""Find modules and functions that would run old code after an edit of their source."""

from __future__ import annotations

import dis
import gc
import sys
from collections import deque
from collections.abc import Collection, Iterable, Iterator
from functools import cached_property
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import resolve_name
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import cast

_IMPORT = dis.opmap["IMPORT_NAME"]
_OURS = frozenset({"pytest_tarl", "tarl_lint", "_pytest", "pytest"})


def holders(gone: Iterable[ModuleType], among: Iterable[str]) -> list[str]:
    """Return the modules in `among` that refer to a module in `gone` or to its contents, even indirectly.

    The result has only modules that can be imported again: Python source files that are not tests.
    """
    going = {id(module): module for module in gone}
    left = [name for name in among if _renewable(sys.modules.get(name))]
    imports = {name: _Imports(sys.modules[name]) for name in left}
    found: list[str] = []
    grew = True
    while grew:
        names = {str(module.__dict__.get("__name__")) for module in going.values()}
        more = [name for name in left if _holds(sys.modules[name], going, names, imports[name])]
        going.update((id(sys.modules[name]), sys.modules[name]) for name in more)
        left = [name for name in left if name not in more]
        found += more
        grew = bool(more)
    return found


def outlived(files: Collection[Path]) -> list[Path]:
    """Return the files with functions that are still in memory, and therefore still run the text before the edit."""
    wanted = {str(file): file for file in files}
    gc.collect()
    codes = (one.__code__.co_filename for one in gc.get_objects() if type(one) is FunctionType)
    return sorted({wanted[name] for name in codes if name in wanted})


def of_tests(file: Path) -> bool:
    """Return whether pytest itself imports this file, as it does test modules and conftest.py."""
    return file.name == "conftest.py" or file.name.startswith("test_") or file.name.endswith("_test.py")


class _Imports:
    """The dotted names that a module imports anywhere; needed because a constant does not refer to its module.

    Imports inside functions count: a function called at module level may return such a constant.
    """

    def __init__(self, module: ModuleType) -> None:
        self._spec: ModuleSpec = module.__dict__["__spec__"]

    def any_of(self, names: Collection[str]) -> bool:
        """Return whether the module imports one of the names.

        For speed, only code that uses the last part of a name is decoded.
        """
        last = {name.rpartition(".")[2] for name in names}
        return any(
            not last.isdisjoint(one.rpartition(".")[2] for one in code.co_names)
            and any(name in names for name in _imported_by(code, self._spec))
            for code in self._importing
        )

    @cached_property
    def _importing(self) -> list[CodeType]:
        """Return the module's code objects that may import; inline caches in bytecode can look like imports."""
        code = cast(SourceFileLoader, self._spec.loader).get_code(self._spec.name)
        return [one for one in _nested(code) if _IMPORT in one.co_code[::2]] if code is not None else []


def _nested(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _nested(constant)


def _imported_by(code: CodeType, spec: ModuleSpec) -> Iterator[str]:
    # arguments of the two instructions before IMPORT_NAME: the level and the imported names
    before: deque[object] = deque((None, None), 2)
    for one in dis.get_instructions(code):
        if one.opname == "IMPORT_NAME":
            level, taken = before
            dots = "." * level if isinstance(level, int) else ""
            base = (
                resolve_name(f"{dots}{one.argval}", spec.parent) if dots and spec.parent else str(one.argval)
            )
            yield base
            yield from (f"{base}.{name}" for name in (taken if isinstance(taken, tuple) else ()))
        before.append(one.argval)


def _renewable(module: ModuleType | None) -> bool:
    spec = module.__dict__.get("__spec__") if isinstance(module, ModuleType) else None
    if spec is None or not isinstance(spec.loader, SourceFileLoader) or not spec.origin:
        return False
    return spec.name.partition(".")[0] not in _OURS and not of_tests(Path(spec.origin))


def _holds(module: ModuleType, going: Collection[int], names: set[str], imports: _Imports) -> bool:
    if id(module) in going:
        return False
    if imports.any_of(names):
        return True
    for value in list(module.__dict__.values()):
        if id(value) in going:
            return True
        kind = value if isinstance(value, type | FunctionType) else type(value)
        home = kind.__dict__.get("__module__") if isinstance(kind, type) else kind.__module__
        if isinstance(home, str) and home in names:
            return True
    return False
