"""Fixtures for the tests of fleets."""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module

# These libraries are imported before the first test. Otherwise, pytester would remove them after the first test that
# imports them, and the next import would create other classes than those in use.
for library in (
    "distributed",
    "fsspec.implementations.local",
    "importlib.metadata",
    "pandas",
    "pyarrow.dataset",
    "tlz.curried",
):
    with suppress(ModuleNotFoundError):  # an extra that is not installed
        import_module(library)
