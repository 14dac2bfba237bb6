"""The parametric utility equals the table where tiles distinguish all cells, and generalises elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pytest_tarl import Sensor
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Chain
from pytest_tarl.learning.tiles import tiled, tiled_batch, tiled_chain
from pytest_tarl.learning.utility import batch, chain_utility
from tests.plugin.learning.test_utility import WALK, walk_trace

PLACE = Sensor("place", low=0, high=WALK, bins=WALK, tilings=2)


def walks() -> Chain:
    return merge([sample(walk_trace(seed), seed, True, ()) for seed in range(400)]).chain


def test_without_tilings_the_table_is_used() -> None:
    assert tiled([(0,), (1,)], [replace(PLACE, tilings=0)]) is None
    assert tiled_chain(walks(), WALK, None).tolist() == chain_utility(walks(), WALK).tolist()


def test_each_cell_lies_in_one_tile_per_grid() -> None:
    tiles = tiled([(i,) for i in range(8)], [replace(PLACE, bins=8, tilings=4)])
    assert tiles is not None
    assert tiles.of.shape == (8, 4)
    shared = [len({*tiles.of[0]} & {*tiles.of[i]}) for i in range(8)]
    assert shared == sorted(shared, reverse=True)
    assert shared[0] == 4
    assert shared[4:] == [0, 0, 0, 0]


def test_tiles_of_an_angle_wrap_around_its_range() -> None:
    heading = Sensor("heading", angle=True, bins=8, tilings=4)
    tiles = tiled([(i,) for i in range(8)], [heading])
    assert tiles is not None
    assert {*tiles.of[0]} & {*tiles.of[7]}


def test_tiles_learn_the_values_of_a_table() -> None:
    tiles = tiled([(i,) for i in range(WALK)], [PLACE])
    learned = tiled_chain(walks(), WALK, tiles, gamma=1.0)
    assert learned == pytest.approx(np.arange(1, 6) / 6, abs=0.08)
    assert learned == pytest.approx(chain_utility(walks(), WALK, gamma=1.0), abs=0.03)


def test_unvisited_cell_takes_values_of_neighbouring_tiles() -> None:
    chain = walks()
    cells = [(i,) for i in range(WALK + 3)]
    tiles = tiled(cells, [replace(PLACE, bins=WALK + 3)])
    learned = tiled_chain(chain, len(cells), tiles, gamma=0.9)
    assert not np.isnan(learned[:WALK]).any()
    assert np.isnan(learned[-1])  # outside all visited tiles
    apart = chain.cell != 2
    gap = Chain(*(column[apart & (chain.next_cell != 2)] for column in vars(chain).values()))
    assert np.isnan(chain_utility(gap, WALK)[2])
    assert not np.isnan(tiled_chain(gap, WALK, tiled(cells[:WALK], [PLACE]), gamma=0.9)[2])


def test_each_site_has_its_own_tiles() -> None:
    whole = merge([sample(walk_trace(seed), seed, True, ((0, 1),)) for seed in range(400)])
    tiles = tiled([(i,) for i in range(WALK)], [PLACE])
    table = tiled_batch(whole.lists[0], WALK, np.inf, tiles, gamma=0.9)
    assert table[:, 0] == pytest.approx(batch(whole.lists[0], WALK, np.inf, gamma=0.9)[:, 0], abs=0.1)
    assert np.isnan(table[:, 1]).all()


def test_a_sensor_with_tilings_needs_bins() -> None:
    from pytest_tarl.errors import SettingsError

    with pytest.raises(SettingsError, match="tilings must be at least 1 and needs a sensor with bins"):
        Sensor("mode", categories=("a", "b"), tilings=2)
