"""Find out how much memory this process may still use, where the system reports it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

_MEMINFO = Path("/proc/meminfo")  # Linux
_OWN_GROUPS = Path("/proc/self/cgroup")
_GROUPS = Path("/sys/fs/cgroup")
# for each cgroup version: file with the limit, file with the usage, and the statistic of the part of the file cache
# that can be dropped
_FILES = {
    1: ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
    2: ("memory.max", "memory.current", "inactive_file"),
}


def available() -> int | None:
    """Return the bytes available without swapping, or None if the system does not report this.

    In a container, this is at most what is left of the container's limit.
    """
    found = [one for one in (_of_machine(), *_of_groups()) if one is not None]
    return max(0, min(found)) if found else None


def _of_machine() -> int | None:
    try:
        found = re.search(r"^MemAvailable:\s+(\d+) kB$", _MEMINFO.read_text(), re.MULTILINE)
    except OSError:
        return None
    return None if found is None else int(found[1]) * 1024


def _of_groups() -> Iterator[int | None]:
    """Yield how many bytes each control group (cgroup) of this process has left, innermost first; None for no limit."""
    try:
        lines = _OWN_GROUPS.read_text().splitlines()
    except OSError:
        return
    for line in lines:
        _, _, rest = line.partition(":")
        controllers, _, path = rest.partition(":")
        if controllers and "memory" not in controllers.split(","):
            continue
        version, base = (1, _GROUPS / "memory") if controllers else (2, _GROUPS)
        own = base / path.lstrip("/")
        # in a container, the group's files may be at the root of the hierarchy, so parents are also read
        for folder in (own, *own.parents):
            if folder.is_relative_to(base):
                yield _left(folder, *_FILES[version])


def _left(folder: Path, limit: str, usage: str, droppable: str) -> int | None:
    """Return how many bytes a control group has left; None if it has no limit."""
    try:
        most, used = int((folder / limit).read_text()), int((folder / usage).read_text())
        found = re.search(rf"^{droppable} (\d+)$", (folder / "memory.stat").read_text(), re.MULTILINE)
    except (OSError, ValueError):  # ValueError if the file says "max" (unlimited)
        return None
    return most - used + (int(found[1]) if found else 0)
