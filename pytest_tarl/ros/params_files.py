"""Read parameter files (`--ros-args --params-file`): parameters by node, as YAML."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pytest_tarl.ros.missing import unsupported


def read(filename: str) -> dict[str, Any]:
    """Return a file's parameters by node name or `/**`. Raise RuntimeError, as ROS does, if it cannot be read."""
    try:
        import yaml
    except ModuleNotFoundError:
        raise unsupported("--params-file without PyYAML (pip install PyYAML)") from None
    said = f"failed to initialize: Couldn't parse params file: '--params-file {filename}'. Error:"
    try:
        found = yaml.safe_load(Path(filename).read_text("utf-8"))
    except (OSError, UnicodeDecodeError) as problem:
        raise RuntimeError(f"{said} Error opening YAML file ({problem})") from problem
    except yaml.YAMLError as problem:
        raise RuntimeError(f"{said} {problem}") from problem
    if not isinstance(found, dict):
        raise RuntimeError(f"{said} it holds no parameters by node")
    return found
