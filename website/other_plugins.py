"""Options that keep a pytest process from importing other projects' plugins, which takes it a second and more.

The development extra installs these plugins; a project of a user has few of them.
"""

from __future__ import annotations

import importlib.metadata

# `-p NAME` after these options loads a plugin again.
BLOCKED = " ".join(
    f"-p no:{name}"
    for name in sorted({entry.name for entry in importlib.metadata.entry_points(group="pytest11")})
    if name not in ("tarl", "xdist")
)
