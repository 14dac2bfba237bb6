"""The argument `parameters` of `tarl.start` and `tarl.launch`: a mapping, or the path of a YAML file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pytest_tarl.errors import SettingsError

Parameters = Mapping[str, Any] | str | os.PathLike[str]


def parameters_of(given: Parameters | None, folder: Path, function: str) -> Mapping[str, Any]:
    """Return the parameters that a test passes to a function; paths are relative to the test's folder.

    Raise SettingsError for other types, and if the file cannot be read as a mapping.
    """
    if given is None:
        return {}
    if isinstance(given, Mapping):
        odd = next((name for name in given if not isinstance(name, str) or not name), None)
        if odd is not None:
            raise SettingsError(f"{function}: parameters maps names to values; {odd!r:.60} is not a name.")
        return given
    if not isinstance(given, str | os.PathLike):
        raise SettingsError(
            f"{function}: parameters takes a mapping or the path of a YAML file, not {given!r:.60}."
        )
    return _read(folder / given, function)


def _read(path: Path, function: str) -> Mapping[str, Any]:
    try:
        import yaml
    except ModuleNotFoundError:
        raise SettingsError(
            f"{function}: reading the parameters in {path} needs PyYAML: run pip install PyYAML."
        ) from None
    try:
        found = yaml.safe_load(path.read_text("utf-8"))
    except FileNotFoundError:
        raise SettingsError(
            f"{function}: there is no parameter file {path}. The path is relative to the test's folder."
        ) from None
    except (OSError, UnicodeDecodeError) as problem:
        raise SettingsError(f"{function}: cannot read the parameter file {path}: {problem}.") from None
    except (yaml.YAMLError, RecursionError, ValueError) as problem:
        reason = " ".join(str(problem).split())
        raise SettingsError(
            f"{function}: the parameter file {path} is not valid YAML: {reason:.200}."
        ) from None
    if not isinstance(found, dict) or not all(isinstance(name, str) for name in found):
        raise SettingsError(
            f"{function}: the parameter file {path} must contain a mapping from names to values, such as "
            "'gain: 0.5', or such mappings below names of nodes and ros__parameters."
        )
    return found
