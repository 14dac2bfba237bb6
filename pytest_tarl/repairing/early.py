"""Try structural changes that recorded symptoms suggest during the search of constants.

Changing a constant repairs most drifts within a few episodes. If it does not, a structural change that a symptom
suggests is more likely to help than further constants.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from pytest_tarl.errors import RepairError, TarlError
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.repairing.entered_statements import entered
from pytest_tarl.repairing.measured import hints
from pytest_tarl.repairing.mission_pairs import Recorded, Signs, mission_pairs, recorded, signs
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.reached_limits import reached_limits
from pytest_tarl.repairing.readings import corrections
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.rescaled_messages import rescaled
from pytest_tarl.repairing.structural import Structures
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.confirming import confirmed
from pytest_tarl.searching.limits_in_turn import Limit
from pytest_tarl.searching.search import Candidate, Trials
from pytest_tarl.searching.suggestions import Hint
from tarl_lint.model import Operand

SOON = 15  # number of episodes before the changes with the clearest symptoms are tried
FEW = 10  # number of episodes for all these changes together; half as many again if one gains much
# number of episodes before the changes are tried: the mean length of a search that succeeds with a constant
FROM = 60
# used instead of FROM if a constant gains at least `PARTLY`: the constant may only need another value, or a second
# constant
LATER = 100
PARTLY = 0.2  # share of the wanted gain that a constant must reach for `LATER`
# number of seeds on which a correction of a reading is tried: two, because one seed may be hard in any world
SEEDS = 2
HALF = 0.5  # corrections of readings are tried if no constant gains at least this share of the wanted gain
MOST = 45  # number of episodes for all these changes together; half as many again if one gains much


class Early:
    """The structural changes of a search of constants, tried once; `spent` counts their episodes.

    `waiting` becomes true when a candidate is yielded, and false when the search continues. So it stays true if that
    candidate is accepted.
    """

    def __init__(self, order: Order, guards: Sequence[Guard], trials: Trials) -> None:
        self.order = order
        self.guards = guards
        self.trials = trials
        self.spent = 0
        self.waiting = False
        self._recorded: tuple[Recorded, ...] | None = None
        self._traces: dict[Candidate, Trace] = {}  # changed program → its recorded mission
        self._signs: Signs | None = None
        self._structures: Structures | None = None
        # the changes with the clearest symptoms; None before they are tried
        self._surest: Structures | None = None
        self._corrected = False  # whether the readings were corrected

    def candidates(self, best: float = 0.0) -> Iterator[Candidate]:
        """Yield confirmed candidates if the search has already run `FROM` (or `LATER`) episodes, else nothing.

        `best` is the largest gain of a constant so far.
        """
        if self._recorded and best < HALF * self.order.goal.wanted:
            yield from self.corrected()
        partly = self._partly(best)
        if self._recorded and self.trials.spent >= SOON:
            yield from self._surely(symptoms=not partly)
        if not self.due(best):
            return
        begun = self.trials.spent
        found = self.signs(self.trials)
        self.spent += self.trials.spent - begun
        self._structures = Structures(self.order, self.guards, self.trials, signs=found)
        yield from self._counted(self._structures.early(MOST, once=not partly))

    def due(self, best: float) -> bool:
        """Return whether the changes begin now; `best` is the largest gain of a constant so far."""
        return self._structures is None and self.trials.spent >= (LATER if self._partly(best) else FROM)

    def _partly(self, best: float) -> bool:
        return best >= PARTLY * self.order.goal.wanted

    def before_extreme(self) -> Iterator[Candidate]:
        """Before an extreme change of a constant, yield likelier changes: corrected readings and scaled commands.

        A constant that is far too large can hide a wrong sensor reading or a weak actuator, but it suits only some
        missions.
        """
        yield from self.corrected()
        yield from self._surely(symptoms=False)

    def _surely(self, symptoms: bool) -> Iterator[Candidate]:
        """Yield factors on published fields and, with `symptoms`, changes with clear symptoms. This is done once."""
        if self._surest is None:
            self._surest = Structures(self.order, self.guards, self.trials, signs=self.signs(self.trials))
            yield from self._counted(self._surest.surest(FEW, symptoms=symptoms))

    def _counted(self, changes: Iterator[Candidate]) -> Iterator[Candidate]:
        """Yield structural changes and count their episodes."""
        begun, before = self.trials.spent, self.spent
        try:
            for candidate in changes:
                self.spent = before + self.trials.spent - begun
                self.waiting = True
                yield candidate
                self.waiting = False
        finally:
            self.spent = before + self.trials.spent - begun

    def corrected(self) -> Iterator[Candidate]:
        """Yield the corrections of readings that are confirmed; the first call records the mission pairs."""
        if self._corrected:
            return
        self._corrected = True
        goal, trials = self.order.goal, self.trials
        begun, before = trials.spent, self.spent
        pairs = self._pairs(trials)
        found = [*rescaled(self.order, pairs), *((one,) for one in corrections(self.order, pairs))]
        for mutations in dict.fromkeys(found):
            candidate, seeds = Candidate(mutations, ALWAYS), [pair.seed for pair in goal.pairs[:SEEDS]]
            try:
                reached = [at for at, seed in enumerate(seeds) if goal.reached(trials(candidate, seed), seed)]
                holds = bool(reached) and confirmed(candidate, trials, goal, reached[0])
            except RepairError:
                continue
            self.spent = before + trials.spent - begun
            if holds:
                self.waiting = True
                yield candidate
                self.waiting = False

    def signs(self, trials: Trials) -> Signs:
        """Return the symptoms of the mission pairs; the first call records them and charges the given trials."""
        if self._signs is None:
            self._signs = signs(self.order, self._pairs(trials))
        return self._signs

    def measured(self, operands: Sequence[Operand]) -> list[Hint]:
        """Return the changes of constants that the mission pairs suggest."""
        return hints(self.order, self._pairs(self.trials), operands)

    def reached(self, mutants: Mutants, candidate: Candidate) -> Sequence[Limit]:
        """Return the limits that only drifted missions reach when a candidate's change is applied.

        A changed mission is recorded with the seed of the first pair and charged.
        """
        pairs, order = self._pairs(self.trials), self.order
        if not candidate.mutations or not pairs:
            return reached_limits(order, pairs)
        (designed, drifted), *_ = pairs
        trace = self._changed(mutants, candidate)
        return reached_limits(order, [(designed, trace)], drifted) if trace is not None else []

    def entered(self, mutants: Mutants, candidate: Candidate) -> Sequence[Operand]:
        """Return the constants of the statements that a drifted mission enters only with a candidate's change.

        Return none if no pairs are recorded. A changed mission is charged when it is recorded.
        """
        pairs = self._pairs(self.trials)
        trace = self._changed(mutants, candidate) if pairs else None
        return entered(self.order, pairs, trace) if trace is not None else []

    def _changed(self, mutants: Mutants, candidate: Candidate) -> Trace | None:
        """Record the drifted mission of the first pair's seed with a change; return None if it cannot run."""
        if candidate not in self._traces:
            order = self.order
            try:
                overlay = mutants.source(candidate)
                self.trials.charge()
                trace = recorded(order, order.goal.pairs[0].seed, order.drift, overlay)
            except TarlError:
                return None
            self._traces[candidate] = trace
        return self._traces[candidate]

    def _pairs(self, trials: Trials) -> tuple[Recorded, ...]:
        if self._recorded is None:
            self._recorded = mission_pairs(self.order, trials)
        return self._recorded

    def effects(self) -> Mapping[str, Sequence[OperandEffect]]:
        """For each site, return the gain of each template's best values."""
        found: dict[str, list[OperandEffect]] = {}
        for structures in (self._surest, self._structures):
            for site, effects in structures.effects().items() if structures is not None else ():
                found.setdefault(site, []).extend(effects)
        return found
