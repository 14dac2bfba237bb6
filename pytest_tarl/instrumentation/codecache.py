"""Keep the compiled code of instrumented files below `.tarl/cache` between runs.

The name of an entry is a digest of everything that its code depends on. The entry contains a digest of its contents; it
is written to a temporary file, which is then renamed. An entry that is damaged, foreign or cannot be written only costs
a compilation.
"""

from __future__ import annotations

import contextlib
import hashlib
import marshal
import os
import sys
from collections.abc import Iterable
from importlib.util import MAGIC_NUMBER
from pathlib import Path
from types import CodeType

from tarl_lint.files import write_atomically

FORMAT = b"tarl-code-1\n"
KEPT = 8  # maximum number of entries per source file; each set of recorded statements has its own entry
# maximum number of entries in memory; a repair search runs many edited versions of a file
REMEMBERED = 256
_HEADER = len(FORMAT) + len(MAGIC_NUMBER) + hashlib.sha256().digest_size


class CodeCache:
    """Code objects by entry name, in memory and (if there is a directory) on disk."""

    def __init__(self, directory: Path | None) -> None:
        self._directory = directory
        self._codes: dict[str, CodeType] = {}

    def load(self, name: str) -> CodeType | None:
        """Return the code stored under this name, or None if there is no valid entry."""
        code = self._codes.get(name)
        if code is None and self._directory is not None:
            code = _read(self._directory / name)
            if code is not None:
                self._remember(name, code)
        return code

    def store(self, name: str, code: CodeType, *, keep: bool = True) -> None:
        """Store code under a name from `entry_name`; with `keep=False`, only in memory."""
        self._remember(name, code)
        if keep and self._directory is not None and not sys.dont_write_bytecode:
            with contextlib.suppress(OSError):
                _write(self._directory / name, code)

    def _remember(self, name: str, code: CodeType) -> None:
        self._codes[name] = code
        while len(self._codes) > REMEMBERED:
            del self._codes[next(iter(self._codes))]


def entry_name(path: Path, depends_on: Iterable[object]) -> str:
    """Return the entry name of a file's code: a digest of `depends_on`, whose items need an unambiguous `repr`."""
    digest = hashlib.sha256(repr(tuple(depends_on)).encode()).hexdigest()
    return f"{path.stem}-{_place(path)}-{digest[:32]}.pyc"


def _place(path: Path) -> str:
    return hashlib.sha256(os.fsencode(path)).hexdigest()[:8]


def _read(entry: Path) -> CodeType | None:
    try:
        data = entry.read_bytes()
    except OSError:
        return None
    payload = data[_HEADER:]
    if data[:_HEADER] != _header(payload):
        return None
    code = marshal.loads(payload)  # noqa: S302 - as Python does with a .pyc; the digest was checked
    return code if isinstance(code, CodeType) else None


def _write(entry: Path, code: CodeType) -> None:
    payload = marshal.dumps(code)
    write_atomically(entry, _header(payload) + payload, parents=True)
    _forget_old(entry)


def _header(payload: bytes) -> bytes:
    return FORMAT + MAGIC_NUMBER + hashlib.sha256(payload).digest()


def _forget_old(entry: Path) -> None:
    """Remove all but the KEPT newest entries of the same file."""
    same = entry.parent.glob(f"{entry.name[:-37]}-*.pyc")
    by_age = sorted(same, key=lambda path: path.stat().st_mtime_ns, reverse=True)
    for old in by_age[KEPT:]:
        old.unlink(missing_ok=True)
