"""Write a repair at the definition of the constant if this test uses the definition, otherwise at the use."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.constant_definitions import (
    Place,
    alternatives,
    computed_at,
    configured,
    defined,
    package_files,
    parameter,
    users,
)
from pytest_tarl.patching.mutate import Mutation, located, redefinition
from pytest_tarl.patching.named_numbers import named_numbers
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.searching.search import Candidate, Trials
from tarl_lint.model import Operand

LOOKED_AT = 3  # number of seeds on which a repair must still pass after it is moved to the definition
MOST_PLACES = 6  # maximum number of configuration files or rows of a table to try for one constant
MOST_NAMED = 5  # maximum number of other users of a constant that a note names


class Placing:
    """Move mutations to the definitions of their constants; cache which definitions this test uses."""

    def __init__(self, mutants: Mutants) -> None:
        self.mutants = mutants
        self.order = mutants.order
        # keys: the definitions in the source, or the operand if there are none
        self._in_force: dict[Operand | tuple[Place, ...], tuple[Place, ...]] = {}
        self._why: dict[Operand, str] = {}

    def __call__(self, candidate: Candidate, trials: Trials) -> Candidate | None:
        """Move a candidate to its final places; return None if the place that `--tarl-edit` requires does not work."""
        edit = self.order.options.edit
        candidate = replace(candidate, mutations=tuple(map(located, candidate.mutations)))
        movable = [one for one in candidate.mutations if not _stays(one)]
        if edit == "use" or candidate.guard.conjuncts or not movable:
            return candidate
        try:
            moved = self._moved(candidate, trials)
        except RepairError:
            moved = None
        return moved or (None if edit == "definition" else candidate)

    def notes(self, candidate: Candidate) -> Iterator[str]:
        """Yield notes: why a constant is changed at its use, and which code uses a definition."""
        for mutation in candidate.mutations:
            if mutation.place is None and not candidate.guard.conjuncts and mutation.operand in self._why:
                yield self._why[mutation.operand]
        yield from self._unused(candidate)
        for place in dict.fromkeys(one.place for one in candidate.mutations if one.place is not None):
            yield from self._users(place, [m.operand for m in candidate.mutations if m.place == place])

    def _unused(self, candidate: Candidate) -> Iterator[str]:
        """Yield notes on the unchanged numbers of a changed variable, which this test does not use."""
        changed = {one.place for one in candidate.mutations if one.place is not None}
        for operand in dict.fromkeys(one.operand for one in candidate.mutations if one.place is not None):
            written = defined(self.order.analysis, operand)
            if len(written) < 2 or alternatives(self.order.analysis, written):
                continue
            spots = {(place.path, place.line) for place in changed}
            left = [f"{one.path}:{one.line}" for one in written if (one.path, one.line) not in spots]
            if left and len(left) < len(written):
                yield (
                    f"`{operand.code}` gets other numbers at {', '.join(left)}, which stay unchanged, because the "
                    "missions of this test do not use them"
                )

    def _moved(self, candidate: Candidate, trials: Trials) -> Candidate | None:
        """Move mutations to the definitions that the test uses; None if there are none or the moved repair fails."""
        mutations: list[Mutation] = []
        for mutation in candidate.mutations:
            places = () if _stays(mutation) else self._places(mutation, candidate, trials)
            mutations += _at(mutation, places) or [mutation]
        mutations = _united(mutations)
        values: dict[Place, object] = {}
        for mutation in mutations:
            if mutation.place and values.setdefault(mutation.place, redefinition(mutation)) != redefinition(
                mutation
            ):
                return None  # two uses of one constant need different values
        if not values or (self.order.options.edit == "definition" and not all(map(_stays, mutations))):
            return None
        moved = Candidate(tuple(mutations), candidate.guard)
        pairs = self.order.goal.pairs[:LOOKED_AT]
        first = pairs[0].seed
        if trials(moved, first) == trials(candidate, first):
            trials.equate(candidate, moved)
            return moved  # the rewards are equal, so nothing else in this test depends on the definition
        if all(trials.reaches(moved, pair.seed, self.order.goal) for pair in pairs):
            return moved
        for mutation in mutations:
            if mutation.place is not None:
                where = f"{mutation.place.path}:{mutation.place.line}"
                self._why[mutation.operand] = (
                    f"`{mutation.operand.code}` is changed at its use, because a change of its definition at {where} "
                    "does not restore the reward: other code uses the constant, too"
                )
        return None

    def _places(self, mutation: Mutation, candidate: Candidate, trials: Trials) -> tuple[Place, ...]:
        one = defined(self.order.analysis, mutation.operand) or mutation.operand
        if one not in self._in_force:
            self._in_force[one] = self._found(mutation, candidate, trials)
        return self._in_force[one]

    def _found(self, mutation: Mutation, candidate: Candidate, trials: Trials) -> tuple[Place, ...]:
        """Return the first places where a change affects the episode, which shows that the test uses them."""
        analysis, operand = self.order.analysis, mutation.operand
        name = parameter(analysis, operand)
        written = defined(analysis, operand)
        apart = alternatives(analysis, written)
        for places in [(one,) for one in written[:MOST_PLACES]] if apart else [written]:
            if self._moves(mutation, places, candidate, trials):
                return self._in_use(mutation, places, candidate, trials)
        lost = not written and not operand.setting  # the analysis cannot follow the constant
        for place in named_numbers(analysis, operand)[:MOST_PLACES] if lost else ():
            if self._moves(mutation, [place], candidate, trials):
                return (place,)
        if not name:
            return ()
        file = (self.order.root / operand.span.path).resolve()
        texts = package_files(self.order.root.resolve(), file)
        self.mutants.texts.update(texts)
        likely = [
            place
            for place in configured(name, texts)
            if isinstance(place.value, bool) == isinstance(operand.value, bool) or operand.value is None
        ]
        for place in likely[:MOST_PLACES]:
            if self._moves(mutation, [place], candidate, trials):
                return (place,)
        self._why[operand] = self._given(name, operand, computed_at(name, texts))
        return ()

    def _in_use(
        self, mutation: Mutation, places: Sequence[Place], candidate: Candidate, trials: Trials
    ) -> tuple[Place, ...]:
        """Return the places that missions of the test use. If this cannot be determined, return all places.

        A node may set a variable in several modes. If the test does not run a mode, its number stays as it is, because
        nothing shows that it should change. To find out, the whole change is compared with the change without one
        place. Trying the change at this place alone would not suffice, because the mission may fail before it reaches
        the place.
        """
        if not 1 < len(places) <= MOST_PLACES:
            return tuple(places)
        others = tuple(one for one in candidate.mutations if not _same_constant(one, mutation))
        seeds = [pair.seed for pair in self.order.goal.pairs[:LOOKED_AT]]

        def alike(kept: Sequence[Place]) -> bool:
            whole, part = (
                Candidate(tuple(_united([*others, *_at(mutation, some)])), candidate.guard)
                for some in (places, kept)
            )
            try:
                return all(trials(whole, seed).acts_like(trials(part, seed)) for seed in seeds)
            except RepairError:
                return False

        needed = tuple(place for place in places if not alike([one for one in places if one != place]))
        return needed if needed and (len(needed) == len(places) or alike(needed)) else tuple(places)

    def _moves(
        self, mutation: Mutation, places: Sequence[Place], candidate: Candidate, trials: Trials
    ) -> bool:
        """Return whether a change at these places alters the reward of an episode.

        The change alone may alter nothing because another constant hides it. It is then tried together with the other
        mutations of the candidate.
        """
        if not places:
            return False
        pair = self.order.goal.pairs[0]
        others = tuple(one for one in candidate.mutations if not _same_constant(one, mutation))
        moved = tuple(_at(mutation, places))
        alone, beside, without = (
            Candidate(changes, candidate.guard)
            for changes in (moved, tuple(_united([*others, *moved])), others)
        )
        try:
            if trials(alone, pair.seed).total != pair.total:
                return True
            return bool(others) and trials(beside, pair.seed).total != trials(without, pair.seed).total
        except RepairError:
            return False

    def _given(self, name: str, operand: Operand, computed: str) -> str:
        """Explain that the test, or the launch file that it starts, determines a parameter's value."""
        test = self.order.root / self.order.fixture.test.partition("::")[0]
        text = test.read_text("utf-8", "replace") if test.is_file() else ""
        key = re.escape(name.rpartition("/")[2].removeprefix("~"))
        start = (
            f"`{operand.code}` is changed at its use. The parameter {name!r} has a default and possibly a value in the "
            "package, but "
        )
        in_test = re.search(rf"""["'_]{key}\b""", text)
        if in_test is None and ".launch(" in text and computed:
            return f"{start}{computed}, where no number alone determines it. Change the parameter there"
        if in_test is None and ".launch(" in text:
            return f"{start}the launch file of the test sets it. Change the parameter there"
        who = "the test itself passes it (parameters=…, argv=…)" if in_test else "this test sets it"
        return f"{start}{who}, and TARL never edits tests. Change the parameter where your robot sets it"

    def _users(self, place: Place, used: Sequence[Operand]) -> Iterator[str]:
        others = users(self.order.analysis, used)
        others += _importers(self.order.root.resolve(), place, {*self.order.analysis.sources})
        if others:
            more = f" and {len(others) - MOST_NAMED} more" if len(others) > MOST_NAMED else ""
            yield (
                f"{place.name} at {place.path}:{place.line} is also used by {', '.join(others[:MOST_NAMED])}{more}; "
                "this run repeated the recorded tests that use it"
            )


def _stays(mutation: Mutation) -> bool:
    """Return whether a mutation is at a literal, at a definition, or a new expression."""
    return mutation.operand.literal or mutation.form is not None or mutation.place is not None


def _same_constant(one: Mutation, other: Mutation) -> bool:
    """Return whether two mutations change uses of one constant."""
    same = one.operand.definition is not None and one.operand.definition == other.operand.definition
    return one.operand == other.operand or same


def _at(mutation: Mutation, places: Sequence[Place]) -> list[Mutation]:
    """Return a mutation once for each place."""
    return [replace(mutation, place=place) for place in places]


def _united(mutations: Sequence[Mutation]) -> list[Mutation]:
    """Unite a changed literal and a factor on its use: `rate = 0.1` and `3 * rate` become `rate = 0.3`."""
    used: dict[tuple[str, int, object], Place] = {
        (place.path, place.line, place.value): place for one in mutations if (place := one.place) is not None
    }
    changed: dict[Place | None, float] = {}
    kept: list[Mutation] = []
    for mutation in mutations:
        operand = mutation.operand
        place = used.get((operand.span.path, operand.span.line, operand.value))
        literal = operand.literal and mutation.form is None and not isinstance(operand.value, bool)
        if place is not None and literal and operand.value:
            changed[place] = float(mutation.value) / float(operand.value)
        else:
            kept.append(mutation)
    return [
        replace(one, value=one.value * changed[one.place]) if one.place in changed else one for one in kept
    ]


def _importers(root: Path, place: Place, analysed: set[str]) -> list[str]:
    """Return Python files outside the analysis that contain the names of the constant and of its module."""
    if not place.path.endswith(".py"):
        return []
    module, found = Path(place.path).stem, []
    for path in sorted(root.rglob("*.py")):
        shown = path.relative_to(root).as_posix()
        if shown in analysed or any(
            part.startswith(".") or part == "venv" for part in path.relative_to(root).parts
        ):
            continue
        words = set(_words(path))
        if place.name.partition("[")[0].rpartition(".")[2] in words and module in words:
            found.append(shown)
    return found


def _words(path: Path) -> Iterator[str]:
    try:
        yield from re.findall(r"\w+", path.read_text("utf-8", "replace"))
    except OSError:
        return
