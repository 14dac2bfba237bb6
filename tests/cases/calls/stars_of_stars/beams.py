from enum import IntEnum


class Beam(IntEnum):
    NONE = 0
    LEFT = 1
    RIGHT = 4


def decode(seen):
    for side in ("left", "right"):
        if seen[side] & 3:
            return Beam[side.upper()]
    return Beam.NONE
