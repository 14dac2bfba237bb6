"""Set the project's addresses in a wheel's metadata.

A release sets SITE_URL, the address of the documentation, and REPOSITORY_URL. A wheel built without them has no
addresses, so that a fork does not send its users to this project's pages.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface


class ProjectUrls(MetadataHookInterface):
    """Add the addresses given by environment variables."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set the project's `urls`. Raise ValueError for an invalid address."""
        metadata["urls"] = urls(os.environ)


def urls(environment: Mapping[str, str]) -> dict[str, str]:
    """Return the project's addresses by label. Raise ValueError unless all of them begin with https://."""
    found: dict[str, str] = {}
    site, repository = (_address(name, environment) for name in ("SITE_URL", "REPOSITORY_URL"))
    if site:
        found |= {"Documentation": f"{site}/"}
    if repository:
        found |= {
            "Source": repository,
            "Issues": f"{repository}/issues",
            "Changelog": f"{repository}/blob/main/CHANGELOG.md",
        }
    return found


def _address(name: str, environment: Mapping[str, str]) -> str:
    address = environment.get(name, "").strip().rstrip("/")
    if address and not address.startswith("https://"):
        raise ValueError(f"{name} must be an address that begins with https://, got {address!r}.")
    return address
