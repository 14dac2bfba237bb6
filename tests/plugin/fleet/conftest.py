"""Shared by the tests of fleets."""

# Imported before the first test: pytester forgets the modules that a test with it imports, and if they were imported
# again, the classes of file systems and tasks would be others than those that are in use.
import importlib.metadata

import distributed
import fsspec.implementations.local
import tlz.curried

LIBRARIES = (distributed, fsspec.implementations.local, importlib.metadata, tlz.curried)
