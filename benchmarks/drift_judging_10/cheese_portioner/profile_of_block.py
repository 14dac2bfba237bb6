"""Cross sections of a block from the heights that a line scanner measures."""

from collections import namedtuple

Section = namedtuple("Section", "area highest")

FLOOR = 0.15  # smaller heights belong to the belt, not to the block (cm)


def section(heights, spacing):
    """Return the area under the heights, in cm², and the greatest height, in cm."""
    solid = [height if height > FLOOR else 0.0 for height in heights]
    inner = sum(solid) - 0.5 * (solid[0] + solid[-1])
    return Section(inner * spacing, max(solid))
