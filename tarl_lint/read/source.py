"""Read and parse files: the result is a `Module` or a `SourceError`; a bad file is a value, not an exception."""

from __future__ import annotations

import ast
import io
import re
import stat
import tokenize
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

# maximum size of a file (bytes); Python's parser takes about 200 times as much memory
LARGEST: Final = 2_000_000
TOO_DEEP: Final = "The code is nested too deeply to be {}: split the expression, or exclude the file."


@dataclass(frozen=True)
class Module:
    """One Python file. `path` is the displayed path, `name` the dotted name from the nearest import root."""

    path: str
    name: str
    text: str
    tree: ast.Module
    is_package: bool = False
    started: tuple[str, ...] = ()  # entry points declared by the package
    # whether the file is installed; installed files are neither started nor reported
    installed: bool = False

    def answer(self, question: Callable[[str], bool]) -> bool:
        """Return the answer of a function that reads the text.

        The analysis reads the text only here, so that an editor session knows which edits change no answer.
        """
        return question(self.text)

    def contains(self, word: str) -> bool:
        """Return whether the text contains a word."""
        return self.answer(lambda text: word in text)

    def matches(self, pattern: re.Pattern[str]) -> bool:
        """Return whether a pattern occurs in the text."""
        return self.answer(lambda text: occurs(pattern, text))


@lru_cache(maxsize=2048)
def occurs(pattern: re.Pattern[str], text: str) -> bool:
    """Return whether a pattern occurs in the text of a file, which may be part of many programs."""
    return pattern.search(text) is not None


@dataclass(frozen=True)
class Script:
    """A module before parsing."""

    path: str
    name: str
    text: str
    is_package: bool = False
    started: tuple[str, ...] = ()
    installed: bool = False


@dataclass(frozen=True)
class SourceError:
    """The reason why a file cannot be analysed: a sentence and a line (from 1). `bug` marks an internal error."""

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
    """Decode according to PEP 263 and parse. Never raises."""
    script = read(path, data, name)
    return parsed(script) if isinstance(script, Script) else script


def contents(place: Path, path: str, typed: bytes | None = None) -> bytes | SourceError:
    """Read a file, unless its text came from standard input. Pipes and devices, which may never end, are not read."""
    try:
        data = typed if typed is not None else _whole(place)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        return SourceError(path, 1, f"This file cannot be read: {reason}. Make it readable, or exclude it.")
    if data is None:
        return SourceError(
            path, 1, "This is not a regular file: exclude it, or pipe its text to tarl-lint -."
        )
    if len(data) > LARGEST:
        return SourceError(
            path,
            1,
            f"The file has more than {LARGEST // 1_000_000} MB: move data out of the code, or exclude the file.",
        )
    return data


def _whole(place: Path) -> bytes | None:
    """Read a regular file of at most the maximum size; return None for anything else."""
    if not stat.S_ISREG(place.stat().st_mode):
        return None
    with place.open("rb") as file:
        return file.read(LARGEST + 1)


def read(path: str, data: bytes, name: str) -> Script | SourceError:
    """Decode according to PEP 263. Never raises."""
    if path.endswith(".ipynb"):
        return SourceError(
            path, 1, "This is a notebook: convert it with jupyter nbconvert --to script and lint the result."
        )
    decoded = _decode(path, data)
    if isinstance(decoded, SourceError):
        return decoded
    if "\0" in decoded:
        line = decoded.count("\n", 0, decoded.index("\0")) + 1
        return SourceError(
            path, line, "The file contains a null byte, so it is not Python source: exclude it."
        )
    return Script(path, name, decoded, path.rpartition("/")[2] == "__init__.py")


def parsed(script: Script) -> Module | SourceError:
    """Parse a file. Never raises."""
    path = script.path
    try:
        with warnings.catch_warnings():
            # warnings about invalid escapes and the like are left to other linters
            warnings.simplefilter("ignore")
            tree = ast.parse(script.text)
    except SyntaxError as error:
        return _syntax_error(path, script.text, error)
    except (RecursionError, MemoryError):
        return SourceError(path, 1, TOO_DEEP.format("parsed"))
    except ValueError as error:
        return SourceError(path, 1, f"The file cannot be parsed ({error}): fix it, or exclude it.")
    return Module(path, script.name, script.text, tree, script.is_package, script.started, script.installed)


def _decode(path: str, data: bytes) -> str | SourceError:
    """Return the text with normalised line ends and without byte order mark."""
    try:
        encoding, _ = tokenize.detect_encoding(io.BytesIO(data).readline)
        text = data.decode(encoding)
    except SyntaxError as error:
        return SourceError(path, 1, f"Unknown encoding: {error}. Save the file as UTF-8.")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        return SourceError(
            path,
            line,
            f"The bytes are not valid {error.encoding}: name the encoding in the first line or save as UTF-8.",
        )
    # encodings such as rot13, which do not decode bytes to text, raise a LookupError
    except (LookupError, UnicodeError) as error:
        return SourceError(path, 1, f"Unknown encoding: {error}. Save the file as UTF-8.")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _syntax_error(path: str, text: str, error: SyntaxError) -> SourceError:
    """Return the error of an unparsable file; recognise Python 2."""
    line = max(error.lineno or 1, 1)
    if PYTHON_2.search(text):
        return SourceError(path, line, "This is Python 2, which is not analysed: port the file to Python 3.")
    reason = (error.msg or "invalid syntax").rstrip(".")
    return SourceError(
        path, line, f"The file is not valid Python ({reason}): fix this line, or exclude the file."
    )
