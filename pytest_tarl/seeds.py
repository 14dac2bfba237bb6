"""Random numbers: one seed determines all random streams, each of which has a name."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np


def episode_seed(seed: int, stream: str, index: int) -> int:
    """Return the seed (below 2⁶³) of a stream's episode `index`; streams share a seed only by chance."""
    return _hashed(f"{seed}/{stream}/{index}", 8) >> 1


def episode_seeds(seed: int, stream: str, count: int) -> tuple[int, ...]:
    """Return the first `count` seeds of a stream."""
    return tuple(episode_seed(seed, stream, index) for index in range(count))


def generator(seed: int, name: str) -> np.random.Generator:
    """Return the Philox stream with the key (seed, name), independent of other names and of earlier draws."""
    import numpy as np

    return np.random.Generator(np.random.Philox(key=_hashed(f"{seed}/{name}", 16)))


def uniform(seed: int, name: str) -> float:
    """Return a number from 0 to 1, determined by (seed, name), without numpy."""
    return _hashed(f"{seed}/{name}", 8) / 2**64


def _hashed(text: str, size: int) -> int:
    return int.from_bytes(
        hashlib.blake2b(text.encode(errors="surrogatepass"), digest_size=size).digest(), "little"
    )
