"""The address of the documentation, which a release states in its metadata."""

from __future__ import annotations

from functools import cache
from importlib.metadata import PackageNotFoundError, metadata

LABEL = "Documentation"


@cache
def site() -> str:
    """Return the address of the documentation, with a slash at its end; "" if the installed version states none."""
    try:
        stated = metadata("tarl").get_all("Project-URL") or []
    except PackageNotFoundError:  # tarl-lint runs from a source tree that is not installed
        return ""
    for one in stated:
        label, _, address = str(one).partition(",")
        if label.strip() == LABEL:
            return f"{address.strip().rstrip('/')}/"
    return ""


def rule_page(code: str) -> str:
    """Return the address of a rule's page; "" if there is none."""
    return f"{site()}rules/{code}/" if site() else ""
