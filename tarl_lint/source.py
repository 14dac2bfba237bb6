"""Bytes become a `Module`, or a `SourceError` that says why not: a bad file is a value, not an exception."""

from __future__ import annotations

import ast
import io
import re
import stat
import tokenize
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Final

LARGEST: Final = 2_000_000  # bytes; Python's own parser takes 200 times as much memory
TOO_DEEP: Final = "The code is nested too deeply to be {}: split the expression, or exclude the file."


@dataclass(frozen=True)
class Module:
    """One Python file. `path` is as shown to people, `name` dotted from the nearest import root."""

    path: str
    name: str
    text: str
    tree: ast.Module
    is_package: bool = False
    started: tuple[str, ...] = ()  # names that others start, as the package says
    installed: bool = False  # of a package that is only followed: nothing in it is started or reported


@dataclass(frozen=True)
class Script:
    """The same as far as it is known before it is parsed."""

    path: str
    name: str
    text: str
    is_package: bool = False
    started: tuple[str, ...] = ()
    installed: bool = False


@dataclass(frozen=True)
class SourceError:
    """Why a file cannot be analysed: a sentence, and the line it is about. `bug` when the reason is ours."""

    path: str
    line: int
    message: str
    bug: bool = False


PYTHON_2 = re.compile(
    r"""^\s*(?: print\s+["'\w%(]           # print statement
              | print\s*>>                 # print to a stream
              | exec\s+["'\w]
              | raise\s+[\w.]+\s*,         # raise Error, "text"
              | except\s+[\w.()\s,]+,\s*\w+\s*:
        )""",
    re.VERBOSE | re.MULTILINE,
)


def parse(path: str, data: bytes, name: str) -> Module | SourceError:
    """Decode as PEP 263 says and parse. Never raises."""
    script = read(path, data, name)
    return parsed(script) if isinstance(script, Script) else script


def contents(place: Path, path: str, typed: bytes | None = None) -> bytes | SourceError:
    """Read a file, unless its text was typed. Pipes and devices, which may never end, are not read."""
    try:
        data = typed if typed is not None else _whole(place)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        return SourceError(path, 1, f"This file cannot be read: {reason}. Make it readable, or exclude it.")
    if data is None:
        return SourceError(path, 1, "This is no regular file: leave it out, or pipe its text to tarl-lint -.")
    if len(data) > LARGEST:
        return SourceError(
            path,
            1,
            f"The file has more than {LARGEST // 1_000_000} MB: move data out of the code, or exclude the file.",
        )
    return data


def _whole(place: Path) -> bytes | None:
    """Read a regular file as far as it is not too large; None for anything else."""
    if not stat.S_ISREG(place.stat().st_mode):
        return None
    with place.open("rb") as file:
        return file.read(LARGEST + 1)


def read(path: str, data: bytes, name: str) -> Script | SourceError:
    """Decode as PEP 263 says. Never raises."""
    if path.endswith(".ipynb"):
        return SourceError(
            path, 1, "This is a notebook: lint what jupyter nbconvert --to script makes of it."
        )
    decoded = _decode(path, data)
    if isinstance(decoded, SourceError):
        return decoded
    if "\0" in decoded:
        line = decoded.count("\n", 0, decoded.index("\0")) + 1
        return SourceError(
            path, line, "The file holds a null byte, so it is not Python source: leave it out."
        )
    return Script(path, name, decoded, path.rpartition("/")[2] == "__init__.py")


def parsed(script: Script) -> Module | SourceError:
    """Parse a file. Never raises."""
    path = script.path
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # invalid escapes and the like are another linter's business
            tree = ast.parse(script.text)
    except SyntaxError as error:
        return _syntax_error(path, script.text, error)
    except (RecursionError, MemoryError):
        return SourceError(path, 1, TOO_DEEP.format("parsed"))
    except ValueError as error:
        return SourceError(path, 1, f"The file cannot be parsed ({error}): mend it, or exclude it.")
    return Module(path, script.name, script.text, tree, script.is_package, script.started, script.installed)


def _decode(path: str, data: bytes) -> str | SourceError:
    """Return the text with line feeds at the ends of lines and without byte order mark."""
    try:
        encoding, _ = tokenize.detect_encoding(io.BytesIO(data).readline)
        text = data.decode(encoding)
    except SyntaxError as error:
        return SourceError(path, 1, f"The encoding is not known: {error}. Save the file as UTF-8.")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        return SourceError(
            path,
            line,
            f"The bytes are not valid {error.encoding}: name the encoding in the first line or save as UTF-8.",
        )
    except (LookupError, UnicodeError) as error:  # such as rot13, which makes no text of bytes
        return SourceError(path, 1, f"The encoding is not known: {error}. Save the file as UTF-8.")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _syntax_error(path: str, text: str, error: SyntaxError) -> SourceError:
    """Say what is wrong, and whether it is Python 2 rather than a mistake."""
    line = max(error.lineno or 1, 1)
    if PYTHON_2.search(text):
        return SourceError(path, line, "This is Python 2, which is not analysed: port the file to Python 3.")
    reason = (error.msg or "invalid syntax").rstrip(".")
    return SourceError(
        path, line, f"The file is not valid Python ({reason}): mend this line, or exclude the file."
    )
