"""Print the lowest versions that pyproject.toml allows, one `name==version` a line, as constraints for pip.

`python .ci/lower_bounds.py [EXTRA ...]` covers the requirements of the distribution and of the named extras.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

try:
    import tomllib
except ImportError:
    import tomli as tomllib

_REQUIREMENT = re.compile(r"([A-Za-z0-9._-]+)(?:\[[^]]*\])?>=([0-9.]+)")


def bounds(extras: list[str]) -> list[str]:
    """Return the constraints, with the environment markers of the requirements."""
    project = tomllib.loads(Path(__file__).parent.parent.joinpath("pyproject.toml").read_text())["project"]
    found = []
    for line in [*project["dependencies"], *requirements(project["optional-dependencies"], extras)]:
        requirement, _, marker = line.partition(";")
        match = _REQUIREMENT.fullmatch(requirement.strip())
        if match is None:
            sys.exit(f"pyproject.toml: {line!r} has no lower bound.")
        found.append(f"{match[1]}=={match[2]}" + (f" ; {marker.strip()}" if marker else ""))
    return found


def requirements(declared: dict[str, list[str]], extras: list[str]) -> list[str]:
    """Return the requirements of these extras and of the extras that they include, each once."""
    found: dict[str, None] = {}
    for extra in extras:
        for line in declared[extra]:
            included = re.fullmatch(r"tarl\[([^]]*)\]", line)
            lines = requirements(declared, included[1].split(",")) if included else [line]
            found.update(dict.fromkeys(lines))
    return list(found)


if __name__ == "__main__":
    print("\n".join(bounds(sys.argv[1:])))
