"""Arithmetic of a spoked wheel: which nipple to turn, which way, and how far."""

RIGHT, LEFT = 1, -1

QUARTER = 0.25  # turns
TURNS_PER_MM = 0.9
LARGEST = 1.5  # turns at a time


def side_of(spoke):
    """Return the flange to which a spoke leads; even spokes lead to the right one."""
    return RIGHT if spoke % 2 == 0 else LEFT


def worst(profile):
    """Return the index of the largest offset of a rim, of which `profile` holds the offsets in mm at its spokes."""
    return max(range(len(profile)), key=lambda spoke: abs(profile[spoke]))


def puller(profile, spoke):
    """Return the spoke at a place, or its neighbour, that pulls the rim back to the middle when it is tightened."""
    away = RIGHT if profile[spoke] > 0.0 else LEFT
    if side_of(spoke) != away:
        return spoke
    count = len(profile)
    before, after = (spoke - 1) % count, (spoke + 1) % count
    return before if abs(profile[before]) > abs(profile[after]) else after


def turns_for(offset):
    """Return the turns of a nipple that take a rim back by an offset in mm."""
    turns = TURNS_PER_MM * abs(offset)
    return max(0.1 * QUARTER, min(LARGEST, turns))
