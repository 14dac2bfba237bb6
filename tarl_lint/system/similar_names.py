"""Decide which topic and service names may be meant to be equal."""

from __future__ import annotations

from itertools import zip_longest
from typing import Final

from tarl_lint.system.model import Instance

_LONG: Final = 5  # names of at least this length are compared for a wrong letter
_CODE: Final = 2  # maximum length of words such as `fl`, which stand for a place
_SYNONYMS: Final = (
    frozenset(["state", "status"]),
    frozenset(["odom", "odometry"]),
    frozenset(["vel", "velocity"]),
)


def spelled_alike(one: str, other: str) -> bool:
    """Return whether two absolute names may be meant to be equal: by an additional namespace or by a different letter.

    `/robot/scan` may be meant to be `/scan`, but `/left/scan` and `/right/scan` are different names. Words of the last
    part may be abbreviated (`vel`, `cmd`). For differences of letters, see `misspelt`.
    """
    (above, last), (beyond, end) = (name.rpartition("/")[::2] for name in (one, other))
    if last == end and one != other and _within(*sorted((above.split("/"), beyond.split("/")), key=len)):
        return True
    return one != other and (misspelt(one, other) or (above == beyond and _abbreviated(last, end)))


def misspelt(one: str, other: str) -> bool:
    """Return whether the spelling alone shows that two absolute names were meant to be equal.

    A letter may be missing, wrong, or in the wrong place. Underscores and upper case make no difference. Words may
    be in another order. A slash may stand for an underscore (`water/current`). Words of the same meaning, such as
    `state` and `status`, are alike in the same namespace. Names that differ in a digit (`left_1`, `left_2`) or in a
    word of one or two letters (`imu_a`, `imu_b`; `wheel_fl`, `wheel_fr`) are different names. Names with fewer than
    five letters are different names as well, except if two letters are exchanged. A letter may also differ in a
    word of the namespace that has at least five letters.
    """
    (above, last), (beyond, end) = (name.rpartition("/")[::2] for name in (one, other))
    if last == end:
        return _namespace_apart(above.split("/"), beyond.split("/"))
    if one.strip("/").replace("/", "_") == other.strip("/").replace("/", "_"):
        return True
    if above != beyond:
        return False
    if _squeezed(last) == _squeezed(end) and (
        last.count("_") != end.count("_") or last.lower() == end.lower()
    ):
        return True
    words, others = last.split("_"), end.split("_")
    if len(words) == len(others):
        apart = [(a, b) for a, b in zip(words, others, strict=True) if a != b]
        if any(max(len(a), len(b)) <= _CODE or min(len(a), len(b)) == 1 for a, b in apart):
            return False
        if above and len(apart) == 1 and any(set(apart[0]) == pair for pair in _SYNONYMS):
            return True
    if len(words) > 1 and sorted(words) == sorted(others):
        return True
    return _one_apart(last, end) if min(len(last), len(end)) >= _LONG else _exchanged(last, end)


def _abbreviated(one: str, other: str) -> bool:
    """Return whether two names have the same words, perhaps abbreviated."""
    pairs = list(zip_longest(one.split("_"), other.split("_"), fillvalue=""))
    return all(a == b or _shortened(*sorted((a, b), key=len)) for a, b in pairs)


def _shortened(short: str, long: str) -> bool:
    """Return whether a word abbreviates another one, such as `vel` or `cmd`."""
    if len(short) < 3 or not long.isalpha():
        return False
    rest = iter(long[1:])
    consonants = short[0] == long[0] and not set(short[1:]) & set("aeiou")
    begins = long.startswith(short) and len(long) >= len(short) + 3  # `scan` does not abbreviate `scans`
    return begins or (consonants and all(letter in rest for letter in short[1:]))


def under_own_name(name: str, other: str, them: Instance) -> bool:
    """Return whether `other` is `name` as a private name of a node."""
    own = them.interface.name if them.interface is not None else ""
    rest = other.removeprefix(f"{them.name}/")
    above, _, last = them.name.rpartition("/")
    return bool(own) and own != last and rest != other and name == f"{above}/{own}/{rest}"


def in_private_names(one: str, other: str, *nodes: Instance) -> bool:
    """Return whether two names are private names of one of the nodes."""
    above, beyond = one.rpartition("/")[0], other.rpartition("/")[0]
    return one != other and above == beyond and above in [node.name for node in nodes]


def longer_alike(one: str, other: str, *, rooted: bool = False) -> bool:
    """Return whether two names in the same namespace differ by whole words: `open` and `open_door`.

    With `rooted`, this namespace may be the root.
    """
    (above, last), (beyond, end) = (name.rpartition("/")[::2] for name in (one, other))
    few, many = sorted((set(last.split("_")), set(end.split("_"))), key=len)
    return one != other and above == beyond and (rooted or above != "") and few <= many


def _squeezed(name: str) -> str:
    """Return a name without underscores and upper case: `e_stop` and `eStop` are alike."""
    return name.replace("_", "").lower()


def _within(few: list[str], many: list[str]) -> bool:
    """Return whether `many` contains all parts of `few` in the same order."""
    rest = iter(many)
    return all(part in rest for part in few)


def _namespace_apart(few: list[str], many: list[str]) -> bool:
    """Return whether two namespaces differ in nothing but one misspelt word."""
    if len(few) != len(many):
        return False
    parts = [(a.split("_"), b.split("_")) for a, b in zip(few, many, strict=True) if a != b]
    if len(parts) != 1 or len(parts[0][0]) != len(parts[0][1]):
        return False
    words = [(a, b) for a, b in zip(*parts[0], strict=True) if a != b]
    return len(words) == 1 and min(map(len, words[0])) >= _LONG and _one_apart(*words[0])


def _exchanged(one: str, other: str) -> bool:
    """Return whether names of four or more letters differ by two exchanged letters."""
    if len(one) != len(other) or len(one) < 4:
        return False
    places = [i for i, (a, b) in enumerate(zip(one, other, strict=True)) if a != b]
    if len(places) != 2 or places[1] != places[0] + 1 or not (one + other).replace("_", "").isalpha():
        return False
    first, second = places
    return one[first] == other[second] and one[second] == other[first]


def _one_apart(one: str, other: str) -> bool:
    if len(one) == len(other):
        places = [i for i, (a, b) in enumerate(zip(one, other, strict=True)) if a != b]
        letters = all(one[i].isalpha() and other[i].isalpha() for i in places)
        if len(places) == 1:
            # `imu_a` and `imu_b` differ on purpose
            return letters and not (places[0] == len(one) - 1 and len(one) < 6)
        first = places[0]
        swapped = len(places) == 2 and places[1] == first + 1
        return letters and swapped and one[first] == other[first + 1] and one[first + 1] == other[first]
    short, long = sorted((one, other), key=len)
    if len(long) != len(short) + 1:
        return False
    return any(long[:i] + long[i + 1 :] == short and long[i].isalpha() for i in range(len(long)))
