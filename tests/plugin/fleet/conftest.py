"""Fixtures for the tests of fleets."""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module

# Imported before the first test: pytester forgets the modules that a test with it imports, and if they were imported
# again, their classes would be others than those in use.
for library in ("distributed", "fsspec.implementations.local", "importlib.metadata", "pandas", "tlz.curried"):
    with suppress(ModuleNotFoundError):  # an extra that is not installed
        import_module(library)
