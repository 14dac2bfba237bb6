"""Find the cells in which named parts of the reward are lost."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pytest_tarl.learning.packing import ROUNDING
from pytest_tarl.learning.permutation import max_statistic
from pytest_tarl.learning.tables import Floats, Sample, sum_by
from pytest_tarl.sensors import Cell

MATERIAL = 0.1  # minimum loss in a reported cell, as a share of the largest loss in any cell


def means(offline: Sample, online: Sample) -> dict[str, tuple[float, float]]:
    """Return the mean sum per episode of each part of the reward, in both worlds."""
    names = sorted({*offline.part_names, *online.part_names})
    return {
        name: (
            float(_by_cell(offline, name).sum(axis=1).mean()),
            float(_by_cell(online, name).sum(axis=1).mean()),
        )
        for name in names
    }


def lost(
    offline: Sample, online: Sample, alpha: float, generator: np.random.Generator
) -> Mapping[str, tuple[Cell, ...]]:
    """Return, for each part, the cells with a significant loss in the deployed world.

    Both samples must have the same table of cells. P-values are corrected over all cells of all parts. The result
    includes cells whose sum is lower only because episodes no longer reach them.
    """
    names = sorted({*offline.part_names, *online.part_names})
    if not names:
        return {}
    worlds = [np.concatenate([_by_cell(one, name) for name in names], axis=1) for one in (online, offline)]
    p_values = max_statistic(np.concatenate(worlds), online.episodes, generator, error=4 * ROUNDING)
    losses = worlds[1].mean(axis=0) - worlds[0].mean(axis=0)
    found = {}
    for number, name in enumerate(names):
        loss, p_value = (column.reshape(len(names), -1)[number] for column in (losses, p_values))
        chosen = (p_value < alpha) & (loss > 0) & (loss >= MATERIAL * loss.max(initial=0.0))
        found[name] = tuple(offline.cells[i] for i in np.flatnonzero(chosen))
    return found


def _by_cell(world: Sample, name: str) -> Floats:
    """Return the sums of a part, shape (episodes, cells); zeros if the world does not have the part."""
    shape = (world.episodes, len(world.cells))
    if name not in world.part_names:
        return np.zeros(shape)
    column = world.chain.parts[:, world.part_names.index(name)]
    return sum_by(world.chain.episode * shape[1] + world.chain.cell, column, shape[0] * shape[1]).reshape(
        shape
    )
