"""Codes of all rules, from the file names in `rules`, without importing them."""

from __future__ import annotations

import os
import re


def rule_codes() -> tuple[str, ...]:
    """Return the codes of all rules, sorted: every file in `rules` named `tarl` and a number is a rule."""
    directory = os.path.join(os.path.dirname(__file__), "rules")  # noqa: PTH118, PTH120 - pathlib takes long to import
    try:
        names = os.listdir(directory)  # noqa: PTH208
    except OSError:  # the package is inside an archive, such as a zip file
        import pkgutil

        names = [f"{module.name}.py" for module in pkgutil.iter_modules([directory])]
    return tuple(sorted(name[:-3].upper() for name in names if re.fullmatch(r"tarl\d+\.py", name)))
