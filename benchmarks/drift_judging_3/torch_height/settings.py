"""Welding procedure of the cell; one entry per wire."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Arc:
    """Wire and arc."""

    stick_out: float = 12.0  # distance between nozzle and plate (mm)
    start_delay: float = 0.4  # time until the pool stands (s)
    crater_fill: float = 0.3  # time at the end of the seam (s)


@dataclass(frozen=True)
class Travel:
    """The motion of the torch along the seam."""

    speed: float = 10.0  # mm/s
    laser_ahead: float = 3.0  # distance of the laser in front of the torch (mm)


@dataclass(frozen=True)
class Procedure:
    """All settings of a seam."""

    arc: Arc = field(default_factory=Arc)
    travel: Travel = field(default_factory=Travel)
