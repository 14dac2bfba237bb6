"""Maps as masked arrays of ros_numpy: only unknown cells are masked."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.ros import ros_numpy


@pytest.mark.parametrize("cells", [[0, 100, -1, 50, -2, 1], [-1] * 6, [0] * 6])
def test_unknown_cells_of_a_map_are_masked(cells: list[int]) -> None:
    message: Any = SimpleNamespace(data=cells, info=SimpleNamespace(height=2, width=3))
    found = ros_numpy.occupancygrid_to_numpy(message)
    assert (found.shape, found.dtype.name, int(found.fill_value)) == ((2, 3), "int8", -1)
    assert found.mask.ravel().tolist() == [cell == -1 for cell in cells]
    assert found.filled().ravel().tolist() == cells
