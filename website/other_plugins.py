"""pytest options that block other projects' plugins, whose import takes a second or more.

The development extra installs these plugins; users have few of them.
"""

from __future__ import annotations

import importlib.metadata

# `-p NAME` after these options loads a plugin again
BLOCKED = " ".join(
    f"-p no:{name}"
    for name in sorted({entry.name for entry in importlib.metadata.entry_points(group="pytest11")})
    if name not in ("tarl", "xdist")
)
