"""The designed world of a test: the world as its author wrote it, plus permanent drifts that were adopted.

The recording stores the names of these drifts, so that everyone who uses it runs the same world. Plain test runs also
read the recording, so this module does not import numpy.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from zipfile import ZipFile

from pytest_tarl.drifts import Drift, combined, drawn, drawn_point
from pytest_tarl.errors import SettingsError
from pytest_tarl.files import slug
from pytest_tarl.spaces import Fault, Point, Space

AS_WRITTEN = "none"  # drift name for the world as its author wrote it
_HEADER = "header.npy"
_PREFIX = 10  # bytes before the header of a version 1 .npy file
# maximum bytes of a header (10,000 statements take 3 MB); a larger one counts as damaged
_LARGEST = 100_000_000


def fixture_path(root: Path, test: str) -> Path:
    """Return the path of a test's recording."""
    digest = hashlib.sha256(test.encode()).hexdigest()[:8]
    return root / ".tarl" / "utility" / f"{slug(test)}-{digest}.npz"


def adopted(path: Path) -> tuple[str, ...]:
    """Return the permanent drifts named in a recording; none if there is no readable recording."""
    try:
        with ZipFile(path) as archive:
            content = archive.read(_HEADER) if archive.getinfo(_HEADER).file_size <= _LARGEST else b""
        start = _PREFIX + int.from_bytes(content[8:_PREFIX], "little")
        names = json.loads(content[start:]).get("design", ())
        return tuple(map(str, names)) if isinstance(names, list) else ()
    except Exception:  # damaged zip or JSON; reported when the recording is loaded
        return ()


def adopting(design: tuple[str, ...], name: str | None, drifts: Mapping[str, Drift]) -> tuple[str, ...]:
    """Return the design's drifts after a recording under drift `name`; without a name, they are unchanged."""
    if name is None:
        return design
    if name == AS_WRITTEN and name not in drifts:
        return ()
    former = [each for each in design if each != name and _combines(drifts.get(each), drifts[name])]
    return (*former, name)


def value(
    drifts: Mapping[str, Drift],
    design: tuple[str, ...],
    scenario: str | None,
    seed: int,
    point: Point | None = None,
) -> Any:
    """Return an episode's `tarl_drift`: the design's value, changed by the scenario; None if there is neither.

    The design includes the nominal values of all spaces. If the scenario is a space, its values are those of `point`
    or, without one, of a random point determined by the seed. Raise SettingsError if the design has a drift that the
    marker no longer declares.
    """
    gone = next((name for name in design if name not in drifts), None)
    nominal = [one.world(one.nominal) for one in spaces(drifts).values()]
    if scenario == AS_WRITTEN and scenario not in drifts:
        return combined(nominal) if nominal else None
    if gone is not None:
        raise SettingsError(
            f"The recording has the drift {gone!r} as part of the design, but the marker no longer declares it: "
            f"declare it again, or record the world without it by `--tarl-record --tarl-drift {AS_WRITTEN}`."
        )
    names = [name for name in (*design, scenario) if name is not None]
    values = [*nominal, *(drawn(drifts[name], name, seed, point) for name in names)]
    return combined(values) if values else None


def spaces(drifts: Mapping[str, Drift]) -> Mapping[str, Space]:
    """Return the drifts that are spaces, by name."""
    return {name: one.value for name, one in drifts.items() if isinstance(one.value, Space)}


def faults(
    drifts: Mapping[str, Drift], scenario: str | None, seed: int, point: Point | None = None
) -> Mapping[str, tuple[Fault, float]]:
    """Return an episode's faults and their sizes by direction; the design has no faults."""
    space = spaces(drifts).get(scenario or "")
    if space is None or scenario is None:
        return {}
    return space.active(drawn_point(space, scenario, seed) if point is None else point)


def replaced(drifts: Mapping[str, Drift], design: tuple[str, ...], scenario: str | None) -> str:
    """Return the design's drift that the scenario replaces, or ""; two dictionaries are merged instead."""
    if scenario is None or scenario in design:
        return ""
    return next((name for name in design if not _combines(drifts.get(name), drifts[scenario])), "")


def _combines(one: Drift | None, other: Drift) -> bool:
    return one is not None and isinstance(one.value, Mapping) and isinstance(other.value, Mapping)
