"""What a test's world is by design: as its author wrote it, or with changes that were recorded as being for good.

The utility fixture names those changes, so that whoever has the fixture has the same world. Plain runs ask, too, so
nothing here needs numpy.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from zipfile import ZipFile

from pytest_tarl.drifts import Drift, combined, drawn
from pytest_tarl.errors import SettingsError
from pytest_tarl.files import slug

AS_WRITTEN = "none"  # the drift of a recording that goes back to the world as its author wrote it
_HEADER = "header.npy"
_PREFIX = 10  # bytes of .npy before the length of its own header is known, in version 1
_LARGEST = 100_000_000  # bytes of a header; 10,000 statements take 3 MB


def fixture_path(root: Path, test: str) -> Path:
    """Return where the utility fixture of a test is."""
    digest = hashlib.sha256(test.encode()).hexdigest()[:8]
    return root / ".tarl" / "utility" / f"{slug(test)}-{digest}.npz"


def adopted(path: Path) -> tuple[str, ...]:
    """Return the drifts that a fixture was recorded under; none where there is no fixture that can be read."""
    try:
        with ZipFile(path) as archive:
            content = archive.read(_HEADER) if archive.getinfo(_HEADER).file_size <= _LARGEST else b""
        start = _PREFIX + int.from_bytes(content[8:_PREFIX], "little")
        names = json.loads(content[start:]).get("design", ())
        return tuple(map(str, names)) if isinstance(names, list) else ()
    except Exception:  # zip and JSON can be damaged in many ways; whoever needs the fixture itself says which
        return ()


def adopting(design: tuple[str, ...], name: str | None, drifts: Mapping[str, Drift]) -> tuple[str, ...]:
    """Return the design once a recording was made under the drift `name`, which is asked for or None."""
    if name is None:
        return design
    if name == AS_WRITTEN and name not in drifts:
        return ()
    former = [each for each in design if each != name and _combines(drifts.get(each), drifts[name])]
    return (*former, name)


def value(drifts: Mapping[str, Drift], design: tuple[str, ...], scenario: str | None, seed: int) -> Any:
    """Return what `tarl_drift` is in the episode of a seed: the design, changed by the scenario; None for neither.

    Raises SettingsError where the marker no longer declares what is the design.
    """
    gone = next((name for name in design if name not in drifts), None)
    if scenario == AS_WRITTEN and scenario not in drifts:
        return None
    if gone is not None:
        raise SettingsError(
            f"The utility was recorded with the drift {gone!r} as the design, and the marker does not declare it any "
            f"more: declare it again, or go back to the world without it by `--tarl-record --tarl-drift {AS_WRITTEN}`."
        )
    names = [name for name in (*design, scenario) if name is not None]
    return combined([drawn(drifts[name], name, seed) for name in names]) if names else None


def replaced(drifts: Mapping[str, Drift], design: tuple[str, ...], scenario: str | None) -> str:
    """Return the change that is the design and is lost under a scenario, since the two do not combine; else ""."""
    if scenario is None or scenario in design:
        return ""
    return next((name for name in design if not _combines(drifts.get(name), drifts[scenario])), "")


def _combines(one: Drift | None, other: Drift) -> bool:
    return one is not None and isinstance(one.value, Mapping) and isinstance(other.value, Mapping)
