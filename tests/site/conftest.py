"""The site that TARL_SITE names, or else one that is built once for all processes of a test run."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the directory of a built site; only a site that TARL_SITE names may have the gallery."""
    if named := os.environ.get("TARL_SITE"):
        return Path(named).resolve()
    fcntl = pytest.importorskip("fcntl", reason="processes of a test run share the site by flock")
    pytest.importorskip(
        "zensical", reason='building the site needs pip install "tarl[docs]" on Python 3.11 or newer'
    )
    from website import assets, build

    missing = [package.name for package in assets.SHIPPED if not assets.available(package)]
    if missing:
        pytest.skip(f"run `make docs-assets` once: {', '.join(missing)} are not in build/assets")
    shared = tmp_path_factory.getbasetemp()
    shared = shared.parent if "PYTEST_XDIST_WORKER" in os.environ else shared
    with (shared / "site.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (shared / "site" / "done").exists():
            build.build(shared / "site", quick=True)
            (shared / "site" / "done").touch()
    return shared / "site" / "site"
