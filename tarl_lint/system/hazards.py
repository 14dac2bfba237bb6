"""Places and identities of a system's hazards, which the rules TARL3xx find."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from itertools import zip_longest
from typing import Final, Protocol, cast

from tarl_lint.files import shown
from tarl_lint.fingerprints import OfHazard
from tarl_lint.model import RULES, Finding, Span
from tarl_lint.settings.config import Config
from tarl_lint.system.model import Endpoint, Instance, System


class Rule(Protocol):
    """A rule about systems: a file `rules/tarl3xx.py`."""

    CODE: str

    def findings(self, system: System) -> Iterator[Finding]:
        """Yield the hazards of a system."""


ARCHITECTURE: Final = tuple(code for code in RULES if code.startswith("TARL3"))


def hazards(system: System, config: Config) -> tuple[Finding, ...]:
    """Return the hazards of the enabled rules, with fingerprints, sorted by place."""
    found: set[Finding] = set()
    for code in ARCHITECTURE:
        if config.enabled(code):
            rule = cast("Rule", import_module(f"tarl_lint.rules.{code.lower()}"))
            found |= {_identified(one) for one in rule.findings(system)}
    return tuple(sorted(found, key=lambda one: (one.span, one.code, one.message)))


def _identified(finding: Finding) -> Finding:
    fingerprint = OfHazard(finding.package, finding.code, finding.about, finding.place)
    return replace(finding, fingerprint=fingerprint.digest())


def at_node(code: str, instance: Instance, message: str, about: str) -> Finding:
    """Return a hazard at the place where a launch file starts a node; `about` contains names from the code."""
    node = instance.node
    span = Span(shown(node.file), max(node.line, 1), 1, max(node.line, 1), 2)
    return Finding(
        code, span, message, about=about, place=f"{node.package}/{node.executable}", package=node.package
    )


def at_end(code: str, instance: Instance, endpoint: Endpoint, message: str, about: str) -> Finding:
    """Return a hazard at the code of an endpoint."""
    package = instance.interface.package if instance.interface is not None else instance.node.package
    return Finding(code, endpoint.span, message, about=about, place=endpoint.place, package=package)


def single(endpoint: Endpoint) -> str:
    """Return the type of an endpoint; "" if it is unknown or may be one of several."""
    return "" if " | " in endpoint.type or endpoint.type == "AnyMsg" else endpoint.type


def differ(one: Endpoint, other: Endpoint) -> bool:
    """Return whether two endpoints certainly have different types; packages are compared where both are known."""
    if not single(one) or not single(other):
        return False
    whole = one.whole_type and other.whole_type
    return one.whole_type != other.whole_type if whole else one.type != other.type


def spelled_alike(one: str, other: str) -> bool:
    """Return whether two absolute names may be meant to be equal: one has a namespace more, or a letter differs.

    `/robot/scan` may be meant to be `/scan`, but `/left/scan` and `/right/scan` are different names. A letter may be
    missing, wrong, or in the wrong place; underscores and upper case make no difference. Names with fewer than five
    letters, and names that differ in a digit (`left_1`, `left_2`), are different names. A slash may stand for an
    underscore (`water/current`), and words of the last part may be abbreviated (`vel`, `cmd`).
    """
    (above, last), (beyond, end) = (name.rpartition("/")[::2] for name in (one, other))
    if last == end:
        return one != other and _within(*sorted((above.split("/"), beyond.split("/")), key=len))
    if one.strip("/").replace("/", "_") == other.strip("/").replace("/", "_"):
        return True
    if above != beyond:
        return False
    if _squeezed(last) == _squeezed(end) and (
        last.count("_") != end.count("_") or last.lower() == end.lower()
    ):
        return True
    return (min(len(last), len(end)) >= 5 and _one_apart(last, end)) or _abbreviated(last, end)


def _abbreviated(one: str, other: str) -> bool:
    """Return whether names have the same words, some of which are abbreviated in one of them."""
    pairs = list(zip_longest(one.split("_"), other.split("_"), fillvalue=""))
    return all(a == b or _shortened(*sorted((a, b), key=len)) for a, b in pairs)


def _shortened(short: str, long: str) -> bool:
    """Return whether a word abbreviates another one: its beginning (`vel`), or some of its consonants (`cmd`)."""
    if len(short) < 3 or not long.isalpha():
        return False
    rest = iter(long[1:])
    consonants = short[0] == long[0] and not set(short[1:]) & set("aeiou")
    begins = long.startswith(short) and len(long) >= len(short) + 3  # `scan` does not abbreviate `scans`
    return begins or (consonants and all(letter in rest for letter in short[1:]))


def under_own_name(name: str, other: str, them: Instance) -> bool:
    """Return whether `other` is a private name of a node and `name` what it is without the launch file's node name."""
    own = them.interface.name if them.interface is not None else ""
    rest = other.removeprefix(f"{them.name}/")
    above, _, last = them.name.rpartition("/")
    return bool(own) and own != last and rest != other and name == f"{above}/{own}/{rest}"


def in_private_names(one: str, other: str, *nodes: Instance) -> bool:
    """Return whether two names are private names of the same node, which is one of the given ones."""
    above, beyond = one.rpartition("/")[0], other.rpartition("/")[0]
    return one != other and above == beyond and above in [node.name for node in nodes]


def longer_alike(one: str, other: str) -> bool:
    """Return whether two names in the same namespace, not the root, differ by whole words: `open` and `open_door`."""
    (above, last), (beyond, end) = (name.rpartition("/")[::2] for name in (one, other))
    few, many = sorted((set(last.split("_")), set(end.split("_"))), key=len)
    return one != other and above == beyond != "" and few <= many


def _squeezed(name: str) -> str:
    """Return a name without underscores and upper case: `e_stop` and `eStop` are alike."""
    return name.replace("_", "").lower()


def _within(few: list[str], many: list[str]) -> bool:
    """Return whether another namespace contains all parts of this one, in the same order."""
    rest = iter(many)
    return all(part in rest for part in few)


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
