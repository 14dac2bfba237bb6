"""Give each program its own copies of the project's modules, as separate processes would have.

Otherwise two nodes in one interpreter would share modules: the second node's `import utils` would return the first
node's `utils`. Two nodes of the same program would share the globals of its modules.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from types import ModuleType


class SeparateModules:
    """Switch the modules in `sys.modules` and the search path whenever another program runs.

    `own` returns the names of the loaded modules that belong to programs.
    """

    def __init__(self, own: Callable[[], Iterable[str]]) -> None:
        self._own = own
        self._modules: dict[object, dict[str, ModuleType]] = {}
        self._paths: dict[object, list[str]] = {}
        self._running: object = None
        self._path = list(sys.path)

    def enter(self, program: object) -> None:
        """Install a program's modules and search path, and put away those of the previous program."""
        if program is self._running:
            return
        self._modules[self._running] = {name: sys.modules.pop(name) for name in tuple(self._own())}
        self._paths[self._running] = list(sys.path)
        self._running = program
        sys.modules.update(self._modules.get(program, {}))
        sys.path[:] = self._paths.get(program, self._path)
