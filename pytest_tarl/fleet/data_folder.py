"""The folder of a data set, local or in an object store, accessed through fsspec."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fsspec

from pytest_tarl.errors import FleetError
from pytest_tarl.extras import install_command
from pytest_tarl.files import advice_on
from tarl_lint.files import write_atomically


@dataclass(frozen=True)
class Store:
    """The folder `root` in the file system `fs`; `protocol` is "file" for a local folder."""

    fs: Any
    root: str
    protocol: str

    def files(self, folder: str) -> list[str]:
        """Return the sorted Parquet files below a folder, relative to the root; none if the folder does not exist.

        Raise FleetError if the folder cannot be listed.
        """
        try:
            self.fs.invalidate_cache()
            found = self.fs.find(f"{self.root}/{folder}")
        except FileNotFoundError:
            return []
        except Exception as problem:  # each kind of store has its own exceptions
            raise FleetError(f"{self.shown(folder)} cannot be listed ({problem}): {ADVICE}") from problem
        start = len(self.root) + 1
        return sorted(one[start:] for one in found if one.endswith(".parquet"))

    def write(self, path: str, content: bytes) -> None:
        """Write a file atomically. Raise FleetError if it cannot be written."""
        try:
            if self.protocol == "file":
                write_atomically(Path(self.root) / path, content, parents=True)
            else:
                self.fs.pipe_file(f"{self.root}/{path}", content)
        except Exception as problem:
            local = self.protocol == "file"
            advice = advice_on(problem) if local and isinstance(problem, OSError) else ADVICE
            raise FleetError(f"{self.shown(path)} cannot be written ({problem}): {advice}") from problem

    def read(self, path: str) -> bytes:
        """Return the content of a file. Raise FleetError if the file cannot be read."""
        try:
            content: bytes = self.fs.cat_file(f"{self.root}/{path}")
        except Exception as problem:
            raise FleetError(f"{self.shown(path)} cannot be read ({problem}): {ADVICE}") from problem
        return content

    def holds(self, path: str) -> bool:
        """Return whether a file exists. Raise FleetError if the store does not respond."""
        try:
            return bool(self.fs.exists(f"{self.root}/{path}"))
        except Exception as problem:
            raise FleetError(f"{self.shown(path)} cannot be read ({problem}): {ADVICE}") from problem

    def opened(self, path: str) -> Any:
        """Open a file for reading, with random access."""
        return self.fs.open(f"{self.root}/{path}", "rb")

    def address(self, path: str) -> str:
        """Return the address for opening a file in DuckDB."""
        return f"{self.root}/{path}" if self.protocol == "file" else f"{self.protocol}://{self.root}/{path}"

    def shown(self, path: str) -> str:
        """Return the name of a file as shown in messages."""
        return self.address(path)


ADVICE = (
    "check the address, the connection and your credentials, and run the command again; no mission is "
    "counted twice."
)


def store(address: str) -> Store:
    """Return the store for an address: a folder, or a URL such as `s3://bucket/folder`.

    Raise FleetError if the package for the URL is missing or the store refuses access.
    """
    try:
        fs, root = fsspec.core.url_to_fs(address)
    except ImportError as problem:
        command = (
            install_command("s3") if address.startswith("s3:") else "install the package that the error names"
        )
        raise FleetError(f"{address} cannot be opened ({problem}): {command}.") from problem
    except Exception as problem:  # each kind of store has its own exceptions
        raise FleetError(f"{address} cannot be opened ({problem}): {ADVICE}") from problem
    protocol = fs.protocol if isinstance(fs.protocol, str) else fs.protocol[0]
    return Store(fs, str(root).rstrip("/"), protocol)
