"""Restrict imports of `tarl-lint` to the standard library and installed packages; linted files are never imported.

Python searches the working directory (`python -m`), the directory of a script and the entries of `PYTHONPATH` before
its own library. Editable installations append source trees. A file `types.py` in any of these folders could be
imported. Only `sys` and `os`, which Python has already loaded, are imported here; even `from __future__` would import a
file.
"""

import os
import sys


def restrict() -> None:
    """Reduce `sys.path` to the entries of the interpreter and its installed packages."""
    trusted = {os.path.normcase(os.path.abspath(entry)) for entry in (*_standard(), *_site(), *_beside_us())}
    sys.path[:] = [e for e in sys.path if e and os.path.normcase(os.path.abspath(e)) in trusted]


def _standard() -> list[str]:
    """Return the directories of the standard library (or its archive) and of its extension modules."""
    library = os.path.dirname(os.__file__)
    return [library, os.path.join(library, "lib-dynload"), os.path.join(sys.base_prefix, "DLLs")]


def _site() -> list[str]:
    """Return the directories of installed packages; none if Python runs without `site`."""
    site = sys.modules.get("site")
    if site is None:
        return []
    user = [site.USER_SITE] if site.ENABLE_USER_SITE and site.USER_SITE else []
    return [*site.getsitepackages(), *user]


def _beside_us() -> list[str]:
    """Return the directory of this package if it was installed elsewhere, for example by `pip install --target`."""
    holder = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    installed = any(n.startswith("tarl-") and n.endswith(".dist-info") for n in os.listdir(holder))
    return [holder] if installed else []
