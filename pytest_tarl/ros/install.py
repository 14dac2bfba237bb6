"""Make the stand-ins importable for nodes, and undo this after the episode."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache, lru_cache, partial
from importlib import import_module
from importlib.machinery import ModuleSpec, PathFinder
from types import CodeType, FrameType, ModuleType
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.environment import set_variables, variables_restored
from pytest_tarl.ros.eventloops import virtual_event_loops
from pytest_tarl.ros.exiting import exits_of_nodes
from pytest_tarl.ros.hosttime import virtual_host_time
from pytest_tarl.ros.interpreter_state import interpreter_kept
from pytest_tarl.ros.keyboard import terminals
from pytest_tarl.ros.messages.installed_packages import asked_kind, installed_kind
from pytest_tarl.ros.messages.node_workspaces import packages
from pytest_tarl.ros.messages.package_modules import PARTS, could_be_package, is_package, package_module
from pytest_tarl.ros.messages.type_definitions import Kind
from pytest_tarl.ros.missing import as_read_by, refuse, unsupported_module
from pytest_tarl.ros.node_output import output_of_nodes
from pytest_tarl.ros.opencv_windows import windows_discarded
from pytest_tarl.ros.reexports import is_reexported, reexported
from pytest_tarl.ros.siblings import generated, has_configurations, is_generated, sibling
from pytest_tarl.ros.standins import MISSING, STANDALONE, STANDINS, TALKING
from pytest_tarl.ros.threads import threads_as_tasks
from pytest_tarl.ros.unix_signals import signals_of_nodes
from pytest_tarl.stale_modules import holders

if TYPE_CHECKING:
    from pytest_tarl.ros.process import Process
    from pytest_tarl.ros.scheduler import Scheduler
    from pytest_tarl.ros.uninstalled import UninstalledFinder

_HOME = "pytest_tarl.ros."
_IMPORT_DATA = ("__name__", "__spec__", "__loader__", "__file__", "__cached__", "__path__", "__package__",
                "__builtins__")  # fmt: skip


class StandinFinder:
    """A finder for `sys.meta_path`; each episode gets its own module objects."""

    def __init__(self) -> None:
        self.loaded: list[str] = []
        self.hidden: dict[str, ModuleType] = {}
        self.before = set(sys.modules)
        self._kind: Kind | None = None

    def find_spec(
        self, name: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find a stand-in; return None to leave the name to other finders."""
        root = name.partition(".")[0]
        if root == "genpy" and _has_genpy():
            # installed message classes of genpy need the real genpy
            return None
        if name in STANDINS and root not in STANDALONE:
            return self._spec(name)
        if root in TALKING or root in MISSING:
            return self._talking_spec(name)
        if root in STANDALONE:
            return None if PathFinder.find_spec(root) is not None else self._spec(name)
        if is_generated(name):
            return self._spec(name)
        if could_be_package(root) and self._holds_messages(name):
            return self._spec(name)
        return self._installed_by_workspace(name) if name == root else None

    def _holds_messages(self, name: str) -> bool:
        """Return whether a module is a message package, or the message part of a node's package."""
        root, _, part = name.partition(".")
        kind = self._kind_of_importer()
        if installed_kind(root) == kind or not is_package(kind, root):
            return False
        if part.partition(".")[0] in PARTS:
            return True
        return not _is_ordinary_package(root) and sibling(root) is None

    def _installed_by_workspace(self, root: str) -> ModuleSpec | None:
        """Find a module of a workspace package, unless the search path has one of the same name."""
        if not packages() or _is_ordinary_package(root):
            return None
        return sibling(root) or (self._spec(root) if has_configurations(root) else None)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Create a new module object."""
        name = spec.name
        if name in STANDINS:
            module = ModuleType(name)
            contents = _contents(_HOME + STANDINS[name])
            inner = {key for key, value in contents.items() if isinstance(value, ModuleType)}
            hidden = {
                key for key in inner if f"{name}.{key}" in STANDINS
            }  # names of submodules with their own stand-in
            module.__dict__.update((key, value) for key, value in contents.items() if key not in hidden)
            module.__dict__["__getattr__"] = partial(_attribute, name, module.__dict__.get("__getattr__"))
        elif is_generated(name):
            module = generated(name)
        elif has_configurations(name) and not is_package(self._kind or "ros1", name):
            module = ModuleType(name, "A package of the workspace without Python modules of its own.")
        else:
            made = package_module(self._kind or "ros2", name)
            if made is None:
                raise unsupported_module(name)
            module = made
        module.__path__ = []
        self.loaded.append(name)
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Do nothing: the module is complete."""

    def _talking_spec(self, name: str) -> ModuleSpec:
        """Return the module of a package's `msg`, `srv` or `action`. Raise UnsupportedModuleError if there is none."""
        root, _, part = name.partition(".")
        kind = self._kind or "ros1"
        if part.partition(".")[0] in PARTS and is_package(kind, root):
            return self._spec(name)
        if name == root and is_package(kind, root):
            return self._spec(name)
        raise unsupported_module(name)

    def _spec(self, name: str) -> ModuleSpec:
        root = name.partition(".")[0]
        if self._kind is None and root in ("rospy", "rclpy"):
            self._settle_kind("ros1" if root == "rospy" else "ros2")
        if root in STANDALONE and name not in STANDINS:
            raise unsupported_module(name)
        return ModuleSpec(name, self, origin="pytest_tarl.ros", is_package=True)  # type: ignore[arg-type]

    def _kind_of_importer(self) -> Kind:
        """Return the importer's ROS generation, from the client library that its code names."""
        asked = asked_kind()
        if asked is not None:
            # this look-up is for a single class and says nothing about the episode's nodes
            return asked
        if self._kind is None:
            return self._settle_kind(_kind_named_by(sys._getframe(2)) or "ros2")
        return self._kind

    def _settle_kind(self, kind: Kind) -> Kind:
        """Set the ROS generation of this episode's messages; hide installed messages of the other one."""
        self._kind = kind
        set_variables(kind)
        if installed_kind("std_msgs") not in (None, kind):
            self.hidden.update(_hide({name for name in sys.modules if could_be_package(name)}))
        return kind


def _attribute(module: str, otherwise: Callable[[str], Any] | None, name: str) -> Any:
    """Return a submodule of a stand-in or a re-exported name."""
    inner = f"{module}.{name}"
    if inner in sys.modules:
        return sys.modules[inner]
    if inner in STANDINS:
        return import_module(inner)
    if is_reexported(module, name):
        return reexported(module, name)
    if otherwise is not None:
        with suppress(AttributeError):
            return otherwise(name)
    raise as_read_by(sys._getframe(1), refuse(module, name))


@cache
def _contents(home: str) -> Mapping[str, object]:
    """Return the namespace of a stand-in; the module of each episode gets a copy."""
    return {key: value for key, value in vars(import_module(home)).items() if key not in _IMPORT_DATA}


def _is_ordinary_package(root: str) -> bool:
    return _is_ordinary_on(root, tuple(sys.path))


@lru_cache(maxsize=256)
def _is_ordinary_on(root: str, _path: tuple[str, ...]) -> bool:
    spec = PathFinder.find_spec(root)
    return (
        spec is not None
        and spec.loader is not None
        and spec.origin is not None
        and installed_kind(root) is None
    )


@cache
def _has_genpy() -> bool:
    return PathFinder.find_spec("genpy") is not None


def _kind_named_by(frame: FrameType | None) -> Kind | None:
    while frame is not None:
        named = _imports(frame.f_code)
        if "rospy" in named:
            return "ros1"
        if "rclpy" in named:
            return "ros2"
        frame = frame.f_back
    return None


def kind_of_caller() -> Kind:
    """Return the caller's ROS generation, from the client library that its code names."""
    return _kind_named_by(sys._getframe(1)) or "ros1"


def _imports(code: CodeType) -> set[str]:
    return {name.partition(".")[0] for name in code.co_names}


@contextmanager
def standins_installed(
    scheduler: Scheduler, uninstalled: UninstalledFinder, processes: Sequence[Process]
) -> Iterator[None]:
    """Install stand-ins, virtual clock and terminals; undo everything on exit."""
    finder = StandinFinder()
    finder.hidden = _hide(root for root in TALKING if root != "genpy" or not _has_genpy())
    sys.meta_path.insert(0, finder)
    sys.meta_path.append(uninstalled)
    try:
        with (
            virtual_host_time(scheduler),
            virtual_event_loops(scheduler),
            threads_as_tasks(),
            terminals(processes),
            windows_discarded(),
            variables_restored(),
            exits_of_nodes(),
            signals_of_nodes(),
            interpreter_kept(),
            output_of_nodes(),
        ):
            yield
    finally:
        sys.meta_path.remove(finder)
        sys.meta_path.remove(uninstalled)
        gone = [sys.modules[name] for name in finder.loaded if name in sys.modules]
        for name in holders(gone, sorted(sys.modules.keys() - finder.before - set(finder.loaded))):
            del sys.modules[
                name
            ]  # refers to a stand-in of this episode, so the next episode must import it again
        for name in finder.loaded:
            sys.modules.pop(name, None)
        sys.modules.update(finder.hidden)


def _hide(roots: Iterable[str]) -> dict[str, ModuleType]:
    """Remove modules of a real ROS or of another stand-in from `sys.modules`, and return them."""
    present = {root for root in roots if root in sys.modules}
    names = [name for name in sys.modules if name.partition(".")[0] in present and not _is_given(name)]
    return {name: sys.modules.pop(name) for name in names}


def _is_given(name: str) -> bool:
    """Return whether the test put this module, or a package that contains it, into `sys.modules`.

    A stand-in for a whole package, such as rospy, takes precedence over the test's module.
    """
    root = name.partition(".")[0]
    of_a_test = root in sys.modules and getattr(sys.modules[root], "__spec__", None) is None
    whole = root not in STANDINS and of_a_test
    return (name not in STANDINS or whole) and getattr(sys.modules[name], "__spec__", None) is None
