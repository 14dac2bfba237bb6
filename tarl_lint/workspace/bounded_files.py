"""Read a file that may be large or missing, up to a size limit."""

from __future__ import annotations

from pathlib import Path


class UnreadableError(Exception):
    """A file cannot be read or is too large. The message is the reason, without the name of the file."""


def read_bytes(path: Path, most: int) -> bytes:
    """Return the content of a file. Raises UnreadableError if the file has more than `most` bytes or cannot be read.

    A named pipe or a device is not opened: reading it can block or never end.
    """
    try:
        if path.exists() and not path.is_file():
            raise UnreadableError("it is a folder, a named pipe or a device, not a file")
        with path.open("rb") as file:
            data = file.read(most + 1)
    except OSError as error:
        raise UnreadableError(f"it cannot be read: {error.strerror}") from None
    if len(data) > most:
        raise UnreadableError(f"it has more than {most:,} bytes")
    return data


def read_text(path: Path, most: int) -> str:
    """Return the text of a file, with invalid UTF-8 replaced. Raises UnreadableError as `read_bytes` does."""
    return read_bytes(path, most).decode("utf-8", errors="replace")
