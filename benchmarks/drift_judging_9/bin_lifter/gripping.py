"""Forces of the bin lifter's clamp."""

import dataclasses

GRAVITY = 9.81
FULL_BIN = 78.0  # the arm's scale refuses heavier bins (kg)


@dataclasses.dataclass(frozen=True)
class ClampConfig:
    """Limits of the clamp, newtons."""

    friction: float = 0.62  # rubber pads on a plastic bin
    reserve: float = 1.25
    touch: float = 120.0
    most: float = 2600.0
    build_up: float = 140.0  # increase of the force per tick


def holding_force(config, mass):
    """Return the force with which two pads hold a bin of this mass."""
    needed = config.reserve * mass * GRAVITY / (2.0 * config.friction)
    return min(config.most, max(config.touch, needed))


def squeeze(config, now, wanted):
    """Return the next force on the way to the wanted one; the force rises slowly and falls quickly."""
    if wanted < now:
        return wanted
    return min(wanted, now + config.build_up)
