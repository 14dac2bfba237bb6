"""Compute the height of the nozzle from the plate under the laser."""

from __future__ import annotations

from collections import deque

from settings import Procedure


class HeightTracker:
    """Delay line: the torch reaches the place under the laser a few millimetres later."""

    def __init__(self, procedure: Procedure, period: float) -> None:
        self._stick_out = procedure.arc.stick_out
        steps = round(procedure.travel.laser_ahead / procedure.travel.speed / period)
        self._line: deque[float] = deque(maxlen=max(1, steps))

    def update(self, plate: float) -> float:
        """Return the height for the nozzle, mm."""
        self._line.append(plate)
        below = self._line[0]
        return below + self._stick_out
