"""The same delivery by a node with two lines swapped: TARL has to find the same line at its new place."""

import pytest
from test_shuttle import MUD, TERRAIN, X, drive
from world import World

from pytest_tarl.episode import Tarl


@pytest.mark.tarl(nodes=["traveller_swapped.py"], sensors=[X, TERRAIN], drifts=MUD, min_success=0.98)
def test_delivers_swapped(tarl: Tarl, tarl_drift: float | None) -> None:
    """Bring one parcel from G1 to G2."""
    world = World(tarl.rng("world"), mud=tarl_drift or 1.0)
    drive(tarl, "traveller_swapped.py", world)
    assert world.delivered, world.failure
