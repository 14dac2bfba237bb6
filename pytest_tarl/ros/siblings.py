"""Import workspace packages as if they were installed, and modules generated from `.cfg` files."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType

from pytest_tarl.errors import UnsupportedModuleError
from pytest_tarl.ros.messages.node_workspaces import on_forget, packages
from tarl_lint.workspace.cfg_files import Configuration, configurations


def sibling(root: str) -> ModuleSpec | None:
    """Find a top-level module that a workspace package installs, or return None."""
    for package in packages().values():
        for module in package.modules:
            if module.name == root:
                return PathFinder.find_spec(root, [str(module.path.parent)])
    return None


def has_configurations(package: str) -> bool:
    """Return whether a workspace package has `.cfg` files."""
    known = packages().get(package)
    return known is not None and bool(known.configurations)


def is_generated(name: str) -> bool:
    """Return whether a module is `PACKAGE.cfg` or `PACKAGE.cfg.NAMEConfig` of a package with `.cfg` files."""
    package, _, rest = name.partition(".")
    return (rest == "cfg" or rest.startswith("cfg.")) and has_configurations(package)


def generated(name: str) -> ModuleType:
    """Create the module `PACKAGE.cfg.NAMEConfig` from its `.cfg` file.

    Raise UnsupportedModuleError if there is no such file.
    """
    package, _, rest = name.partition(".")
    module = ModuleType(name, f"Generated from the .cfg files of {package}.")
    wanted = rest.removeprefix("cfg").removeprefix(".")
    if not wanted:
        return module
    known = packages()[package]
    found = _of_package(known.configurations).get(wanted.removesuffix("Config"))
    if found is None:
        names = ", ".join(f"{one}Config" for one in sorted(_of_package(known.configurations))) or "none"
        raise UnsupportedModuleError(
            f"No .cfg file of {package} generates {wanted}; its files generate: {names}. The third argument of "
            "gen.generate has to be a constant."
        )
    _fill(module, found)
    return module


@cache
def _of_package(files: tuple[Path, ...]) -> Mapping[str, Configuration]:
    return {one.name: one for file in files for one in configurations(file)[0]}


def _fill(module: ModuleType, found: Configuration) -> None:
    """Define in a module the names that dynamic_reconfigure's template defines."""
    names = module.__dict__
    names.update(inf=float("inf"), config_description=found.description, all_level=0, **found.constants)
    names.update({name: {} for name in ("min", "max", "defaults", "level", "type")})
    groups = [found.description]
    while groups:
        group = groups.pop()
        groups += group["groups"]
        for one in group["parameters"]:
            names["all_level"] |= one["level"]
            for key, table in (("min", "min"), ("max", "max"), ("default", "defaults"), ("level", "level"),
                               ("type", "type")):  # fmt: skip
                names[table][one["name"]] = one[key]


on_forget(_of_package.cache_clear)
