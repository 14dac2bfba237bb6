"""The symptoms: each is a function of a statement's series in a few mission pairs.

A symptom returns its strength, from 0 (no sign) to 1. Values are compared with the designed missions, because a program
may be noisy or swing even in the designed world.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from statistics import fmean

import numpy as np

from pytest_tarl.instrumentation.trace import Floats
from pytest_tarl.symptoms.series import Pair, Series, scale

Symptom = Callable[[Sequence[Pair]], float]

TALL = 0.25  # minimum height of a spike, as a share of the range of the values
BACK = 0.5  # maximum change from before to after a spike, as a share of its height
SPIKES = 0.04  # strength 1 if the share of spikes grows by at least this
ROUGH = 0.01  # roughness is ignored up to this share of the range of the values
# factors by which the roughness grows: noise has a strength above 0 from the first on, and 1 from the second on
ROUGHER = (1.5, 6.0)
SWITCHES = 0.1  # strength 1 if the share of steps with a switch grows by at least this
JUMP = 0.4  # minimum change between two successive values to count as a jump, as a share of the range
SOON = 5  # maximum number of steps from a jump to a loss caused by it
LOSS = 0.02  # minimum additional loss of a step to count, as a share of a designed mission's reward
STEADY = 0.02  # a standard deviation at the end of a mission is ignored up to this share of the range
# factors by which this standard deviation grows: a swing has a strength above 0 from the first on, and 1 from the
# second on
SWINGS = (2.0, 6.0)
CROSSINGS = 3  # a swing crosses its mean at least this many times
ASIDE = 0.5  # strength 1 of an offset if the mean at the end grows by at least this share of the range
# strength 1 of an offset if values at the same time of a mission differ by at least this share of the range
BESIDE = 0.25
GROWTH = 0.2  # a runaway has strength 1 if (end - start) / (end + start) grows by at least this
PAST = 0.1  # an overshoot has strength 1 if the share by which a value passes zero grows by at least this
# a lag has a strength above 0 if the mean size at the end grows by more than the first factor, and its full strength
# from the second factor on
LAGS = (2.0, 6.0)
# full strength of a lag: it comes after other symptoms, because most drifts make errors larger
LAG = 0.9
FEWEST = 6  # minimum number of values in a series


def spikes(pairs: Sequence[Pair]) -> float:
    """Return the strength of spikes: single values that stick out between two similar values."""
    height = max(scale(pairs), scale([Pair(pair.drifted, pair.designed) for pair in pairs]))
    return _more(pairs, lambda series: _lone(series.values, height), SPIKES)


def noise(pairs: Sequence[Pair]) -> float:
    """Return how much rougher the values have become: the median of their absolute second differences."""
    least = ROUGH * scale(pairs)
    designed = fmean(_roughness(pair.designed.values) for pair in pairs)
    drifted = fmean(_roughness(pair.drifted.values) for pair in pairs)
    return _grown(designed + least, drifted + least, ROUGHER)


def chatter(pairs: Sequence[Pair]) -> float:
    """Return how much more often the values cross the middle of their range."""
    values = np.concatenate([one.values for pair in pairs for one in (pair.designed, pair.drifted)])
    if not values.size or values.min() == values.max():
        return 0.0
    middle = (values.min() + values.max()) / 2
    return _more(pairs, lambda series: _switches(series.values > middle), SWITCHES)


def hunting(pairs: Sequence[Pair]) -> float:
    """Return how much noisier values around zero have become, or how much more often they change their sign.

    Return 0 for values that never change their sign under the drift.
    """
    if not any(pair.drifted.values.size and np.ptp(np.sign(pair.drifted.values)) > 1 for pair in pairs):
        return 0.0
    often = _more(pairs, lambda series: _switches(series.values > 0.0), SWITCHES)
    return max(often, chatter(pairs), noise(pairs))


def jumps(pairs: Sequence[Pair]) -> float:
    """Return how much likelier losses become soon after a jump of the value.

    A value that also jumps without losses does not cause them. The result is therefore a difference: the share of
    losses that have a jump in the `SOON` steps before them, minus the same share for all steps of the designed
    missions.
    """
    height = JUMP * max(scale(pairs), max((_largest(pair.designed.values) for pair in pairs), default=0.0))
    after, usual = [], []
    for pair in pairs:
        shaken = _soon(pair.drifted, height)
        after += [float(shaken[step]) for step in losses(pair)]
        usual.append(float(_soon(pair.designed, height).mean()) if pair.designed.reward.size else 0.0)
    return max(fmean(after) - fmean(usual), 0.0) if after and height else 0.0


def offset(pairs: Sequence[Pair]) -> float:
    """Return how far the value stays on one side of zero in the second half, unlike in the designed world.

    The value may swing in the designed world as well, for example while a vehicle follows its course. A lasting offset
    then shows in the differences from the designed missions at the same time.
    """
    both = [pair.together() for pair in pairs]
    size = scale(both)
    ends = _ends(both)
    if not size or _short(ends, FEWEST // 2):
        return 0.0
    designed, drifted = (fmean(abs(float(each[at].mean())) for each in ends) for at in (0, 1))
    left = min(designed / max(_largest(pair.designed.values) for pair in both), 1.0)
    one_sided = fmean(_one_sided(other) for _, other in ends)
    aside = one_sided * float(np.clip((drifted - designed) / (ASIDE * size), 0.0, 1.0))
    return (1.0 - left) * max(aside, fmean(_apart(pair, size) for pair in both))


def swing(pairs: Sequence[Pair]) -> float:
    """Return how much the value swings slowly in the second half, compared with the designed missions."""
    least = STEADY * scale(pairs)
    ends = _ends(pairs)
    if not least or _short(ends, FEWEST):
        return 0.0
    designed, drifted = (fmean(float(each[at].std()) for each in ends) for at in (0, 1))
    return _grown(designed + least, drifted, SWINGS) * fmean(_smoothness(other) for _, other in ends)


def runaway(pairs: Sequence[Pair]) -> float:
    """Return how much the value's size grows during a mission, compared with the designed missions."""
    both = [pair.together() for pair in pairs]
    grown = fmean(_growth(pair.drifted.values) - max(_growth(pair.designed.values), 0.0) for pair in both)
    return float(np.clip(grown / GROWTH, 0.0, 1.0)) * fmean(
        _one_sided(_late(pair.drifted.values)) for pair in both
    )


def overshoot(pairs: Sequence[Pair]) -> float:
    """Return how much farther than in the designed missions values go beyond zero to the other side.

    A mission may end because of an overshoot, before the value can swing.
    """
    series = [one for pair in pairs for one in (pair.designed, pair.drifted)]
    if not series or any(one.values.size < FEWEST for one in series):
        return 0.0
    grown = min(_past_zero(pair.drifted.values) - _past_zero(pair.designed.values) for pair in pairs)
    return float(np.clip(grown / PAST, 0.0, 1.0))


def lag(pairs: Sequence[Pair]) -> float:
    """Return how much larger the value's size is in the second half, if it changes slowly.

    An error that grows while its target moves faster shows that the controller only follows.
    """
    least = STEADY * scale(pairs)
    ends = _ends(pairs)
    if not least or _short(ends, FEWEST):
        return 0.0
    designed, drifted = (fmean(float(np.abs(each[at]).mean()) for each in ends) for at in (0, 1))
    return LAG * _grown(designed + least, drifted, LAGS) * fmean(_slowness(other) for _, other in ends)


SYMPTOMS: Mapping[str, Symptom] = {
    "chatter": chatter,
    "hunting": hunting,
    "jumps": jumps,
    "lag": lag,
    "noise": noise,
    "offset": offset,
    "overshoot": overshoot,
    "runaway": runaway,
    "spikes": spikes,
    "swing": swing,
}
RECEIVED = ("noise", "spikes")  # symptoms that are treated where a value is received, not where it is sent


def losses(pair: Pair) -> list[int]:
    """Return the drifted mission's steps that lose more than any step of the designed one."""
    designed = pair.designed.reward
    if not designed.size:
        return []
    least = designed.min() - LOSS * abs(designed.sum())
    return np.flatnonzero(pair.drifted.reward < least).tolist()


def _more(pairs: Sequence[Pair], share: Callable[[Series], float], certain: float) -> float:
    """Return the growth of a share, divided by `certain`, the growth for strength 1."""
    grown = fmean(share(pair.drifted) for pair in pairs) - fmean(share(pair.designed) for pair in pairs)
    return float(np.clip(grown / certain, 0.0, 1.0))


def _grown(before: float, after: float, growth: tuple[float, float]) -> float:
    """Return the position of the ratio after / before between the factors in `growth`: 0 to 1 on a log scale."""
    if before <= 0.0 or after <= 0.0:
        return 0.0
    low, high = np.log(growth)
    return float(np.clip((np.log(after / before) - low) / (high - low), 0.0, 1.0))


def _lone(values: Floats, height: float) -> float:
    """Return the share of values that lie above or below both neighbours by at least `TALL` times `height`."""
    if values.size < FEWEST or not height:
        return 0.0
    before, value, after = values[:-2], values[1:-1], values[2:]
    up, down = value - before, value - after
    tall = np.where(up * down > 0.0, np.minimum(np.abs(up), np.abs(down)), 0.0)
    return float(np.mean((tall >= TALL * height) & (np.abs(after - before) <= BACK * tall)))


def _roughness(values: Floats) -> float:
    return float(np.median(np.abs(np.diff(values, 2)))) if values.size >= FEWEST else 0.0


def _switches(above: np.ndarray) -> float:
    return float(np.mean(above[1:] != above[:-1])) if above.size >= FEWEST else 0.0


def _soon(series: Series, height: float) -> np.ndarray:
    """Return for each step whether the value jumped in it or in the `SOON` steps before; shape (steps,)."""
    found = np.zeros(len(series.reward), dtype=bool)
    # the first value counts as a jump from zero, like a command to a robot at rest
    jumped = np.abs(np.diff(series.values, prepend=0.0)) >= height
    for step in set(series.step[jumped].tolist()):
        found[step : step + SOON + 1] = True
    return found


def _largest(values: Floats) -> float:
    return float(np.abs(values).max()) if values.size else 0.0


def _apart(pair: Pair, size: float) -> float:
    """Return how far a value stays on one side of its designed course in the second half, away from zero.

    Strength 1 requires a difference of at least the share `BESIDE` of the range of the values, and of at least their
    root mean square in the designed world. Only values that swing in the designed world are examined; for others, the
    mean is enough.
    """
    steps = min(pair.designed.values.size, pair.drifted.values.size)
    designed, drifted = (_late(one.values[:steps]) for one in (pair.designed, pair.drifted))
    swings = steps > 0 and float(designed.std()) > STEADY * size
    if not swings or abs(float(drifted.mean())) <= abs(float(designed.mean())):
        return 0.0
    apart, least = drifted - designed, max(float(np.sqrt((designed**2).mean())), BESIDE * size)
    return _one_sided(apart) * min(abs(float(apart.mean())) / least, 1.0)


def _past_zero(values: Floats) -> float:
    """Return the largest value beyond zero, relative to the largest value on the side of the start.

    A median of three removes single outliers.
    """
    smooth = np.median(np.stack([values[:-2], values[1:-1], values[2:]]), axis=0)
    toward = smooth * float(np.sign(smooth[0]))
    far = float(toward.max())
    return max(-float(toward.min()), 0.0) / far if far > 0.0 else 0.0


def _ends(pairs: Sequence[Pair]) -> list[tuple[Floats, Floats]]:
    """Return the second halves of the designed and of the drifted values, for each pair."""
    return [(_late(pair.designed.values), _late(pair.drifted.values)) for pair in pairs]


def _short(ends: Sequence[tuple[Floats, Floats]], least: int) -> bool:
    return any(one.size < least or other.size < least for one, other in ends)


def _late(values: Floats) -> Floats:
    return values[values.size // 2 :]


def _one_sided(values: Floats) -> float:
    """Return |mean| / root mean square: 1 if all values are equal, 0 if they lie evenly around zero."""
    size = float(np.sqrt((values**2).mean())) if values.size else 0.0
    return abs(float(values.mean())) / size if size else 0.0


def _smoothness(values: Floats) -> float:
    """Return the correlation of successive values; 0 if they cross their mean fewer than `CROSSINGS` times."""
    around = values - values.mean()
    spread = float((around**2).mean())
    if not spread or int((around[1:] * around[:-1] < 0.0).sum()) < CROSSINGS:
        return 0.0
    return max(float((around[1:] * around[:-1]).mean()) / spread, 0.0)


def _slowness(values: Floats) -> float:
    """Return the correlation of successive values, around zero: 1 for values that hardly change from call to call."""
    size = float((values**2).mean())
    return max(float((values[1:] * values[:-1]).mean()) / size, 0.0) if size else 0.0


def _growth(values: Floats) -> float:
    """Return (end - start) / (end + start), for the mean size in the last and the first third of the values."""
    if values.size < FEWEST:
        return 0.0
    part = values.size // 3
    start, end = float(np.abs(values[:part]).mean()), float(np.abs(values[-part:]).mean())
    return (end - start) / (end + start) if end + start else 0.0
