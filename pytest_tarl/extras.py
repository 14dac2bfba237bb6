"""Packages that the plugin and the commands need besides those of the linter, and messages if they are missing."""

from __future__ import annotations

import json
import sys
from importlib.metadata import PackageNotFoundError, distribution
from importlib.util import find_spec
from urllib.parse import urlsplit
from urllib.request import url2pathname

NEEDED = ("greenlet", "libcst", "numpy", "pytest")
SERVER = ("pygls",)
FLEET = ("dask", "duckdb", "fsspec", "pyarrow", "threadpoolctl")
STRESS = ("cma", "hypothesis", "threadpoolctl")
SOBOL = ("SALib",)


def missing_packages() -> list[str]:
    """Return the packages of the extra `pytest` that are not installed, without importing them."""
    return [name for name in NEEDED if find_spec(name) is None]


def missing_extra(what: str) -> str | None:
    """Return a sentence that names the packages missing for `what`; None if all are installed."""
    return _sentence(what, missing_packages(), "pytest") or no_lock(what)


def missing_server(what: str) -> str | None:
    """Return a hint that `what` needs the extra `lsp`, or None if it is installed."""
    return _sentence(what, [name for name in SERVER if find_spec(name) is None], "lsp")


def missing_fleet(what: str) -> str | None:
    """Return a hint that `what` needs the extras `pytest` and `fleet`, or None if both are installed."""
    return missing_extra(what) or _sentence(
        what, [name for name in FLEET if find_spec(name) is None], "fleet"
    )


def missing_stress(what: str) -> str | None:
    """Return a hint that `what` needs the extra `stress`, or None if it is installed."""
    return _sentence(what, [name for name in STRESS if find_spec(name) is None], "stress")


def missing_sobol(what: str) -> str | None:
    """Return a hint that `what` needs the extra `sobol`, or None if it is installed."""
    return _sentence(what, [name for name in SOBOL if find_spec(name) is None], "sobol")


def install_command(extra: str) -> str:
    """Return the command that installs an extra, from the local source tree if tarl comes from one."""
    origin = _source_tree()
    if origin is None:
        return f'pip install "tarl[{extra}]"'
    tree, editable = origin
    return f'pip install {"--editable " if editable else ""}"{tree}[{extra}]"'


def _source_tree() -> tuple[str, bool] | None:
    """Return the local folder that pip installed tarl from, and whether the install is editable (PEP 610)."""
    try:
        record = json.loads(distribution("tarl").read_text("direct_url.json") or "{}")
        url = urlsplit(record["url"])
        editable = bool(record["dir_info"].get("editable"))
    except (PackageNotFoundError, ValueError, KeyError, TypeError):
        return None  # installed from an index, an archive or a repository: there is no local clone
    return (url2pathname(url.path), editable) if url.scheme == "file" else None


def _sentence(what: str, missing: list[str], extra: str) -> str | None:
    if not missing:
        return None
    verb = "is" if len(missing) == 1 else "are"
    return f"{what} needs {_listed(missing)}, which {verb} not installed: run {install_command(extra)}."


def no_lock(what: str) -> str | None:
    """Return a sentence if Python runs without a global interpreter lock (3.13t, 3.14t), or None.

    Recording needs the lock, because one thread appends events while another removes them.
    """
    enabled = getattr(sys, "_is_gil_enabled", None)  # exists since Python 3.13
    if enabled is None or enabled():
        return None
    return f"{what} needs the global interpreter lock, which is off in this Python: set PYTHON_GIL=1 and run it again."


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
