"""Read arrays of numbers from an untrusted `.npz` file, with limits on their size and without pickle."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from typing import Any
from zipfile import ZipFile, ZipInfo

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from pytest_tarl.free_memory import available

FREE = 256_000_000  # unpacked bytes allowed for any file
RATIO = 100  # additional unpacked bytes allowed per byte of the file; recordings need 2 to 20
# bytes of memory needed per unpacked byte to read a recording (benchmarks/limits.py, case recording)
NEEDED = 9
KINDS = "biuf"  # numpy kinds: booleans, integers and floats
ENDING = ".npy"


class DamagedError(ValueError):
    """The archive is not a valid recording; the argument is the reason, as a clause without a full stop."""


class TooLargeError(ValueError):
    """There is too little memory to read an archive; the argument is a clause that says how much is needed."""


def read_arrays(content: bytes) -> dict[str, NDArray[Any]]:
    """Return the arrays by name, in the shapes given in the file.

    Raise TooLargeError before unpacking if there is too little memory, and DamagedError if the archive is not valid.
    Damaged zip and npy headers raise other exceptions.
    """
    with ZipFile(io.BytesIO(content)) as archive:
        members = archive.infolist()
        unpacked = sum(one.file_size for one in members)
        if unpacked > FREE + RATIO * len(content):
            raise DamagedError(
                f"its {len(content):,} bytes would unpack to {unpacked:,}, more than any recording"
            )
        free = available()
        if free is not None and NEEDED * unpacked > free:
            raise TooLargeError(
                f"takes about {NEEDED * unpacked / 1e9:.1f} GB of memory to read, and {free / 1e9:.1f} GB are free"
            )
        names = [one.filename for one in members]
        if len({*names}) < len(names):
            raise DamagedError("it contains a name twice")
        return {one.filename.removesuffix(ENDING): _array(archive, one) for one in members}


def numbers(arrays: Mapping[str, NDArray[Any]], name: str, *shape: int | None) -> NDArray[Any]:
    """Return an array; in `shape`, None stands for any length.

    Raise DamagedError if the array is missing or has another shape.
    """
    found = arrays.get(name)
    if found is None:
        raise DamagedError(f"it has no column {name!r}")
    fits = zip(found.shape, shape, strict=False)
    if found.ndim != len(shape) or any(wanted not in (None, size) for size, wanted in fits):
        raise DamagedError(f"its column {name!r} has the shape {found.shape}")
    return found


def _array(archive: ZipFile, member: ZipInfo) -> NDArray[Any]:
    if not member.filename.endswith(ENDING):
        raise DamagedError(f"its member {member.filename[:40]!r} is not an array")
    stream = io.BytesIO(archive.read(member))
    if npy.read_magic(stream) != (1, 0):
        raise DamagedError(f"its member {member.filename[:40]!r} has an unknown header")
    shape, by_columns, dtype = npy.read_array_header_1_0(stream)
    body = stream.read()
    whole = dtype.kind in KINDS and all(size >= 0 for size in shape)
    if not whole or math.prod(shape) * dtype.itemsize != len(body):
        raise DamagedError(f"its member {member.filename[:40]!r} has a length that does not match its shape")
    return np.frombuffer(body, dtype).reshape(shape, order="F" if by_columns else "C").copy()
