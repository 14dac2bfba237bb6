"""Welding procedure of the cell; one entry per wire."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Arc:
    """Wire and arc."""

    stick_out: float = 12.0  # mm between nozzle and plate
    start_delay: float = 0.4  # s, until the pool stands
    crater_fill: float = 0.3  # s, at the end of the seam


@dataclass(frozen=True)
class Travel:
    """The motion of the torch along the seam."""

    speed: float = 10.0  # mm/s
    laser_ahead: float = 3.0  # mm by which the laser measures the plate ahead of the torch


@dataclass(frozen=True)
class Procedure:
    """All settings of a seam."""

    arc: Arc = field(default_factory=Arc)
    travel: Travel = field(default_factory=Travel)
