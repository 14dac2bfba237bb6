"""Every module of tarl_lint belongs to a layer of the import contract, and inheritance is shallow."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import re
from pathlib import Path

import tarl_lint

ROOT = Path(__file__).parents[2]
DEPTH = 3  # levels of inheritance below `object`


def modules() -> list[str]:
    found = pkgutil.walk_packages(tarl_lint.__path__, "tarl_lint.")
    return [m.name for m in found if m.name != "tarl_lint.__main__"]


def floors() -> list[str]:
    """Return the names in the contract, without a TOML parser, which Python 3.10 lacks."""
    text = (ROOT / "pyproject.toml").read_text("utf-8")
    layers = text.partition('name = "tarl_lint floors"')[2].partition("layers = [")[2].partition("\n]")[0]
    lines = re.findall(r'"([^"]*)"', layers)
    return [f"tarl_lint.{name.strip()}" for line in lines for name in re.split(r"[|:]", line)]


def test_every_module_is_in_the_contract():
    named = floors()
    packages = {m.name for m in pkgutil.walk_packages(tarl_lint.__path__, "tarl_lint.") if m.ispkg}
    missing = [
        m for m in modules() if m not in packages and not any(m == n or m.startswith(f"{n}.") for n in named)
    ]
    assert missing == []


def test_the_contract_names_only_existing_modules():
    known = {*modules(), "tarl_lint.__main__"}
    assert [name for name in floors() if name not in known] == []


def test_inheritance_has_a_bounded_depth():
    deep = [
        cls
        for name in modules()
        for cls in vars(importlib.import_module(name)).values()
        if inspect.isclass(cls)
        and sum(base.__module__.startswith("tarl_lint") for base in cls.__mro__) > DEPTH
    ]
    assert deep == []


def test_the_cache_key_covers_all_packages_that_influence_findings():
    from tarl_lint.run.cache import PACKAGES

    packages = {m.name for m in pkgutil.walk_packages(tarl_lint.__path__, "tarl_lint.") if m.ispkg}
    shown = {f"tarl_lint.{p.replace('/', '.')}" for p in PACKAGES}
    assert packages - shown == {
        "tarl_lint.report",
        "tarl_lint.queries",
        "tarl_lint.workspace",
        "tarl_lint.workspace.python",
    }
