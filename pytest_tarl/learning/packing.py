"""Pack columns of statistics into small arrays.

Integers are stored unchanged. A sum z is stored as its sign and round(2¹⁶·log₂|z|), minus a prediction, with a relative
error of at most 5.3e-6. In this form, proportional values (such as those of `delta` and `5 * delta`) differ by a
constant, which deflate compresses well. The prediction for a sum of squares is the squared sum divided by the count;
its error is at most 0.14 %. Packing the unpacked arrays again gives the same arrays.

Samples that are compared with a recording are rounded in the same way (`represented`). Otherwise a live world with
constant rewards would differ from the recorded one, just because of rounding.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.tables import START, Chain, Edges, Floats, Ints, ListSample, Sample, Visits, sum_by

Arrays = dict[str, NDArray[Any]]
Signs = NDArray[np.int8]

FINE = 1  # step of the stored logarithm of a sum, in units of 2⁻¹⁶
COARSE = 256  # step of the stored logarithm of a sum of squares, in units of 2⁻¹⁶
UNIT = 65536.0
ROUNDING = 5.3e-6  # maximum relative error of a packed sum: 2^(1/2 / UNIT) - 1


def represented(sample: Sample) -> Sample:
    """Return the sample rounded as in a recording; repeating this changes nothing."""
    lists = (
        unpacked_list("list", packed_list("list", one), one.width) if one.width else one
        for one in sample.lists
    )
    return replace(sample, chain=represented_chain(sample.chain), lists=tuple(lists))


def represented_chain(chain: Chain) -> Chain:
    """Return the chain rounded as in a recording."""
    return unpacked_chain(packed_chain(chain))


def packed_chain(chain: Chain) -> Arrays:
    """Return the packed arrays of a chain."""
    sums = (chain.reward, *chain.parts.T)
    foretold = np.zeros(chain.count.size, np.int64)
    whole = narrowed(np.stack([chain.episode, chain.cell, chain.next_cell, chain.count]))
    return {"chain": whole} | _stacked("chain", [_packed(one, foretold, FINE) for one in sums])


def unpacked_chain(arrays: Mapping[str, NDArray[Any]]) -> Chain:
    """Return the chain from its packed arrays. Raise KeyError if an array is missing."""
    episode, cell, next_cell, count = arrays["chain"].astype(np.int64)
    foretold = np.zeros(count.size, np.int64)
    sums = [_unpacked(one, foretold, FINE)[0] for one in _columns("chain", arrays)]
    parts = np.stack(sums[1:], axis=1) if len(sums) > 1 else np.zeros((count.size, 0))
    return Chain(episode, cell, next_cell, count, sums[0], parts)


def packed_list(name: str, recorded: ListSample) -> Arrays:
    """Return the packed arrays of a taint list, without visit counts, which follow from the edges."""
    edges, visits = recorded.edges, recorded.visits
    before = _before(visits, recorded.width)
    count = _logarithms(visits.count.astype(np.float64))
    nothing = np.zeros(count.size, np.int64)
    reward, scaled = _logarithms(visits.reward), _logarithms(visits.scaled)
    columns = [
        _packed(visits.reward, nothing, FINE),
        _packed(visits.scaled, np.where(before >= 0, scaled[before], 0), FINE),
        _packed(visits.reward_squared, 2 * reward - count, COARSE),
        _packed(visits.scaled_squared, 2 * scaled - count, COARSE),
    ]
    flow = recorded.flow.ravel()
    return (
        {name: narrowed(np.stack([edges.episode, edges.state, edges.next_state, edges.count]))}
        | _stacked(name, columns)
        | _stacked(f"{name}.flow", [_packed(flow, np.zeros(flow.size, np.int64), FINE)])
    )


def unpacked_list(name: str, arrays: Mapping[str, NDArray[Any]], width: int) -> ListSample:
    """Return a taint list from its packed arrays. Raise KeyError if an array is missing."""
    edges = Edges(*arrays[name].astype(np.int64))
    episode, state, count = _visited(edges)
    visits = Visits(episode, state, count, *(np.zeros(count.size) for _ in range(4)))
    counted = _logarithms(count.astype(np.float64))
    columns = _columns(name, arrays)
    nothing = np.zeros(count.size, np.int64)
    reward, reward_code = _unpacked(columns[0], nothing, FINE)
    scaled, scaled_code = _unpacked_in_turn(columns[1], _before(visits, width))
    reward_squared, _ = _unpacked(columns[2], 2 * reward_code - counted, COARSE)
    scaled_squared, _ = _unpacked(columns[3], 2 * scaled_code - counted, COARSE)
    (flows,) = _columns(f"{name}.flow", arrays)
    flow, _ = _unpacked(flows, np.zeros(flows[0].size, np.int64), FINE)
    sums = (reward, scaled, reward_squared, scaled_squared)
    return ListSample(width, edges, Visits(episode, state, count, *sums), flow.reshape(-1, width))


def packed_table(name: str, table: Floats) -> Arrays:
    """Return the packed arrays of a table of shape (cells, sites) that may contain NaN."""
    seen = ~np.isnan(table)
    values = np.where(seen, table, 0.0).ravel()
    arrays = _stacked(name, [_packed(values, np.zeros(values.size, np.int64), FINE)])
    return {f"{name}.seen": seen} | arrays


def unpacked_table(name: str, arrays: Mapping[str, NDArray[Any]]) -> Floats:
    """Return the table from its packed arrays, shape (cells, sites). Raise KeyError if an array is missing."""
    seen = arrays[f"{name}.seen"]
    (column,) = _columns(name, arrays)
    values, _ = _unpacked(column, np.zeros(seen.size, np.int64), FINE)
    return np.where(seen, values.reshape(seen.shape), np.nan)


def _visited(edges: Edges) -> tuple[Ints, Ints, Ints]:
    """Return the episode, state and count of all visits.

    Each visit has one outgoing edge, so the edges determine the counts. The edge of the last visit leads to END.
    """
    span = int(edges.state.max(initial=START)) + 1
    codes, inverse = np.unique(edges.episode * span + edges.state, return_inverse=True)
    count = sum_by(inverse, edges.count, codes.size).astype(np.int64)
    return codes // span, codes % span, count


def _before(visits: Visits, width: int) -> Ints:
    """Return the index of each row's previous row with the same cell and episode, or -1; shape (rows,)."""
    cell = (visits.state - 1) // max(width, 1)  # -1 for the start of an episode
    same = (np.diff(cell) == 0) & (np.diff(visits.episode) == 0)
    row = np.arange(cell.size, dtype=np.int64) - 1
    return np.where(np.append(False, same)[: cell.size], row, -1)


def _logarithms(values: Floats) -> Ints:
    """Return round(2¹⁶·log₂|z|), or 0 for zero; squares that overflowed stay infinite."""
    size = np.abs(values)
    with np.errstate(divide="ignore"):
        return np.where(size > 0, np.rint(np.minimum(np.log2(size), 1024.0) * UNIT), 0).astype(np.int64)


def _packed(values: Floats, foretold: Ints, step: int) -> tuple[Signs, Ints]:
    """Return the signs, and the difference of each logarithm from its prediction `foretold`, in steps."""
    signs = np.sign(values).astype(np.int8)
    away = np.rint((_logarithms(values) - foretold) / step).astype(np.int64)
    return signs, np.where(signs == 0, 0, away)


def _unpacked(column: tuple[Signs, Ints], foretold: Ints, step: int) -> tuple[Floats, Ints]:
    """Return the values and their logarithms in units of 2⁻¹⁶."""
    signs, away = column
    code = np.where(signs == 0, 0, foretold + away * step)
    return _values(signs, code), code


def _unpacked_in_turn(column: tuple[Signs, Ints], before: Ints) -> tuple[Floats, Ints]:
    """Unpack values that are predicted from the previous row.

    The prediction is 0 if there is no previous row, or its value is zero.
    """
    signs, away = column
    starts = (before < 0) | (np.append(0, signs[:-1])[: signs.size] == 0)
    whole = np.cumsum(away)
    first = np.maximum.accumulate(np.where(starts, np.arange(signs.size), 0))
    code: Ints = whole - (whole - away)[first] if signs.size else whole
    code = np.where(signs == 0, 0, code)
    return _values(signs, code), code


def _values(signs: Signs, code: Ints) -> Floats:
    values: Floats = signs.astype(np.float64) * np.exp2(code / UNIT)
    return values


def narrowed(whole: Ints) -> NDArray[Any]:
    """Return integers of any shape in the smallest sufficient type."""
    kinds = (np.int8, np.int16, np.int32, np.int64)
    low, high = whole.min(initial=0), whole.max(initial=0)
    return whole.astype(next(k for k in kinds if np.iinfo(k).min <= low and high <= np.iinfo(k).max))


def _stacked(name: str, columns: list[tuple[Signs, Ints]]) -> Arrays:
    """Return the signs, shape (columns, rows), and the numbers' bytes by significance, (columns, 4, rows).

    Most of the more significant bytes are 0, and compress well when stored together.
    """
    signs = np.stack([one for one, _ in columns])
    away = np.stack([one for _, one in columns])
    folded = ((away << 1) ^ (away >> 63)).astype("<u4")
    planes = folded.view(np.uint8).reshape(*folded.shape, 4).transpose(0, 2, 1)
    return {f"{name}.signs": signs, f"{name}.sums": np.ascontiguousarray(planes)}


def _columns(name: str, arrays: Mapping[str, NDArray[Any]]) -> list[tuple[Signs, Ints]]:
    signs, planes = arrays[f"{name}.signs"], arrays[f"{name}.sums"]
    together = np.ascontiguousarray(planes.transpose(0, 2, 1)).reshape(len(signs), -1)
    folded = together.view("<u4").reshape(signs.shape).astype(np.int64)
    return list(zip(signs, (folded >> 1) ^ -(folded & 1), strict=True))
