"""Structural repairs, for drifts that no constant repairs: templates applied to the expressions ranked first.

Each parameter of a template at an expression is an operand like any other, so that the sweep can search it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from types import MappingProxyType

from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import FIELD, OF_SENSORS, Template, templates
from pytest_tarl.repairing.evident import STRONG, evident
from pytest_tarl.repairing.ledger import operands
from pytest_tarl.repairing.mission_pairs import NO_SIGNS, Signs
from pytest_tarl.repairing.plainer_templates import factors
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.telling_sensors import OVERLAP, telling, varies
from pytest_tarl.repairing.template_forms import fixed, forms
from pytest_tarl.repairing.template_places import Spot, spots
from pytest_tarl.searching.confirming import suffices
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.sensors import Sensor
from tarl_lint.model import Operand, Span

COMMANDED = ("stored", "sent", FIELD)  # kinds of expressions that go into a published message
# a statement responds if one of its constants gains at least this share of the wanted gain
RESPONDS = 0.2
SURE = 0.95  # minimum strength of a symptom whose templates are tried within the first steps of constants
SUREST = 3  # maximum number of parameters of these templates
FIRST = 2  # number of expressions tried first: the one ranked first, and the one nearest to a publish call
# minimum number of episodes for templates with a telling sensor (see `telling_sensors`), but never more than a third
# of the episodes left
LEAST = 50
# An exponent is a multiple of a half in most laws of physics. If such an exponent nearly earns enough, the law holds
# only roughly, and the exponent is moved in hundredths.
FINER = 0.02
# if the candidates of a group need more than their own episodes, this share of the remaining episodes stays reserved
# for later groups
KEPT = 0.6
WHOLE = ("number", FIELD)  # kinds of templates that change a whole command
COMMANDS = 3  # maximum number of commands that are scaled or shifted before all other changes
# minimum number of episodes for each of these changes, but never more than a third of the episodes left
LEAST_EACH = 4


@dataclass(frozen=True)
class _Group:
    """Operands that are searched together; `share` returns their episodes, given (equal share, remaining episodes)."""

    operands: Sequence[Operand]
    share: Callable[[int, int], int] = lambda share, _: share


class Structures:
    """A search over templates, cheapest first; for each kind, the best `FIRST` expressions come first.

    Changes that a symptom indicates (`signs`) come before all others. Templates of equal cost form a group. A group
    gets a part of the episodes, in proportion to its number of parameters. If one of its templates gains much, the
    group also gets half of the episodes left for the other groups. The statements whose constants gained come first
    (`effects`, by the statement's id), and the best of them has a group of its own. Changes of a whole command by a
    gain or an offset come before those without symptoms, because they compensate for an actuator whatever the node
    computes.
    """

    def __init__(
        self,
        order: Order,
        guards: Sequence[Guard],
        trials: Trials,
        effects: Mapping[str, Sequence[OperandEffect]] = MappingProxyType({}),
        signs: Signs = NO_SIGNS,
    ) -> None:
        self.order = order
        self.signs = signs
        self.responding = _responding(effects, order.goal.wanted)
        self.guards = guards
        self.trials = trials
        self._sweeps: list[Sweep] = []
        self._found: dict[Operand, Form] = {}
        # expressions at which factors were tried in place of a template with state
        self._scaled: set[Span] = set()
        # operands whose values nearly earned enough; their grid is finer
        self._fine: set[Operand] = set()

    def candidates(self) -> Iterator[Candidate]:
        """Yield confirmed candidates: first those with symptoms, then cheap templates. Raise BudgetSpentError."""
        known, places = (
            templates(self.order.root),
            list(spots(self.order, self.responding, self.signs.steady)),
        )
        first = [
            _Group(self._evident(known, places), lambda share, left: max(share, left // 2)),
            _Group(
                self._told(known, places, self._telling()),
                lambda share, left: min(max(share, LEAST), left // 3),
            ),
            self._once(known, places),
            self._at_commands(known, places),
            _Group(self._at_the_best(known, places), lambda share, left: max(share, left // 2)),
        ]
        yield from self._searched([group for group in first if group.operands] + self._groups(known, places))

    def early(self, most: int, once: bool = True) -> Iterator[Candidate]:
        """Yield confirmed candidates of the changes with symptoms; spend `most` episodes, more if one gains much.

        Templates that use a telling sensor are among them if the sensor varies, because no constant fits all its
        values. With `once`, the changes without parameters come first, one episode each. A group of changes ends after
        its first steps if none of them gains anything.
        """
        order = self.order
        known, places = templates(order.root), list(spots(order, steady=self.signs.steady))
        varying = [one for one in self._telling() if order.goal.ranged or varies(order, one)]
        found = [self._evident(known, places), self._told(known, places, varying)]
        bare = [self._once(known, places), self._gains_of_commands(known, places)] if once else []
        groups = [*bare, *(_Group(operands, lambda share, _: share // 2) for operands in found)]
        yield from self._briefly(groups, 2 * most)

    def surest(self, most: int, symptoms: bool = True) -> Iterator[Candidate]:
        """Yield confirmed candidates of factors on built fields, and of the changes with the clearest symptoms.

        Spend at most about `most` episodes.
        """
        known, places = templates(self.order.root), list(spots(self.order, steady=self.signs.steady))
        built = [spot for spot in places if spot.kind == FIELD]
        fields = [operand for one in known if one.on == FIELD for operand in self._at(one, built, first=None)]
        groups = [_Group(fields), _Group(self._evident(known, places, SURE)[:SUREST] if symptoms else [])]
        yield from self._briefly(groups, most)

    def _briefly(self, groups: Sequence[_Group], most: int) -> Iterator[Candidate]:
        """Search groups within `most` further episodes, then restore the budget of the trials.

        What the caller spends on a candidate that is yielded does not count.
        """
        trials = self.trials
        budget, reserve, worth = trials.budget, trials.reserve, trials.worth
        trials.budget = min(trials.spent + most, budget)
        try:
            for candidate in self._searched([group for group in groups if group.operands], brief=True):
                limit, spent = trials.budget, trials.spent
                trials.budget, trials.reserve, trials.worth = budget, reserve, worth
                yield candidate
                trials.budget, trials.reserve = min(limit + trials.spent - spent, budget), 0
        except BudgetSpentError:
            pass
        finally:
            trials.budget, trials.reserve, trials.worth = budget, reserve, worth

    def _searched(self, groups: Sequence[_Group], brief: bool = False) -> Iterator[Candidate]:
        """Search groups one after another, each with its share of the budget. Raise BudgetSpentError.

        If `brief` is true, a group ends after its first steps unless something gains.
        """
        whole = self.trials.budget
        sizes = [len(group.operands) for group in groups]
        for number, group in enumerate(groups):
            sweep = Sweep(
                group.operands,
                self.mutate,
                self.guards,
                self.trials,
                self.order.goal,
                proposed=True,
                weaker=self.weaker,
                given=self.given,
                finer=self._fine.add,
                responding=self.responding,
                brief=brief,
            )
            self._sweeps.append(sweep)
            left = whole - self.trials.spent
            share = group.share(left * sizes[number] // sum(sizes[number:]), left)
            limit = whole if number == len(groups) - 1 else whole - int(KEPT * (left - share))
            self.trials.budget = self.trials.spent + share
            self.trials.reserve, self.trials.worth = (left - share) // 2, self.order.goal
            yielded: set[frozenset[Operand]] = set()
            try:
                for candidate in sweep.candidates():
                    changed = operands(candidate)
                    if self.trials.spent > limit and changed in yielded:
                        # the next candidates only change the value of the same expression again, so they would be
                        # refused, too
                        break
                    yielded.add(changed)
                    yield from self._beyond_its_share(candidate, whole)
            except BudgetSpentError:
                if number == len(groups) - 1:
                    raise
            finally:
                self.trials.budget, self.trials.reserve = whole, 0

    def _beyond_its_share(self, candidate: Candidate, whole: int) -> Iterator[Candidate]:
        """Yield a candidate. If it keeps state, first yield a factor that has the same effect.

        To examine them, the caller may spend more episodes than the share of the candidate's group.
        """
        trials = self.trials
        budget, reserve, spent = trials.budget, trials.reserve, trials.spent
        trials.budget, trials.reserve = whole, 0
        yield from self._by_a_factor(candidate)
        yield candidate
        trials.budget = min(budget + trials.spent - spent, whole)
        trials.reserve = min(reserve, whole - trials.budget)

    def _by_a_factor(self, candidate: Candidate) -> Iterator[Candidate]:
        """Yield the smallest factor that is confirmed in place of a candidate with state."""
        for plain in factors(self.order, candidate):
            if plain.mutations[0].operand.span in self._scaled:
                return
            if suffices(plain, self.trials, self.order.goal):
                yield plain
                break
        self._scaled |= {one.operand.span for one in candidate.mutations}

    def effects(self) -> dict[str, list[OperandEffect]]:
        """Return the gains of the best values of each template, for each site."""
        found: dict[str, list[OperandEffect]] = {}
        for sweep in self._sweeps:
            for site, effects in sweep.effects().items():
                found.setdefault(site, []).extend(effects)
        return found

    def mutate(self, operand: Operand, factor: float) -> Mutation | None:
        """Return the mutation of one parameter by a factor; a template without parameters has only one mutation."""
        form = self._found[operand]
        if not form.parameter:
            return Mutation(operand, True, form=form)
        if factor == 1.0 and form.parameter != form.defaults[0][0]:
            # factor 1 is the same change for all parameters, so only the first parameter proposes this factor
            return None
        mine = next((one for one in form.template.parameters if one.name == form.parameter), None)
        grid = mine.grid if mine is not None else 0.0
        if operand in self._fine and grid < 1.0:  # counts stay integers
            grid *= FINER
        if grid:  # only the first parameter of a template has a grid
            start = dict(form.defaults)[form.parameter]
            factor = round(start * factor / grid) * grid / start
            if not factor:
                return None
        signed = form.template.on == "sensor" or (mine is not None and mine.signed)
        return Mutation(operand, factor, form=form) if factor > 0 or signed else None

    def weaker(self, operand: Operand, factor: float) -> bool:
        """Return whether a factor on a parameter makes the structural change weaker."""
        form = self._found[operand]
        growing = {one.name: one.stronger == "larger" for one in form.template.parameters}
        return 0.0 < factor != 1.0 and (factor < 1.0) == growing.get(form.parameter, factor > 1.0)

    def given(self, operand: Operand) -> list[Operand]:
        """Return the fixed parameters of a structural change, which are moved only after the change gained much."""
        form = self._found[operand]
        bare = replace(form, parameter="")
        return [
            other
            for other, its in self._found.items()
            if other.span == operand.span and replace(its, parameter="") == bare and fixed(its)
        ]

    def _evident(
        self, known: Sequence[Template], among: Sequence[Spot], least: float = STRONG
    ) -> list[Operand]:
        """Return the operands of the changes that a symptom of at least some strength indicates."""
        found = dict(evident(self.order, known, among, self.signs, least))
        self._found |= found
        return [operand for operand, form in found.items() if not fixed(form)]

    def _telling(self) -> list[Sensor]:
        """Return the telling sensors, except those whose values differ only because drifted missions end early."""
        return [one for one in telling(self.order) if self.signs.overlap(self.order, one) <= OVERLAP]

    def _told(
        self, known: Sequence[Template], among: Sequence[Spot], sensors: Sequence[Sensor]
    ) -> list[Operand]:
        """Return the operands of templates with one of the sensors, at all expressions."""
        found: list[Operand] = []
        for made in known if sensors else ():
            for each in forms(self.order, made, among) if made.on in OF_SENSORS else ():
                for operand, form in each:
                    if form.sensor in sensors and operand not in self._found:
                        self._found[operand] = form
                        found += [] if fixed(form) else [operand]
        return found

    def _once(self, known: Sequence[Template], among: Sequence[Spot]) -> _Group:
        """Return the operands of templates that have no parameters, such as `sign`, each at its first expressions.

        Each takes one episode, and none has a value that could be nearly right, so nothing leads the search to them.
        """
        bare = [one for one in known if not one.parameters and one.on not in OF_SENSORS]
        found = [operand for one in bare for operand in self._at(one, among, first=True)]
        return _Group(found, lambda share, left: min(max(share, len(found)), left))

    def _gains_of_commands(self, known: Sequence[Template], among: Sequence[Spot]) -> _Group:
        """Return the operands of a gain at the values that are published, for actuators that have become weaker."""
        nearest = _commands(among)
        fitting = [one for one in known if one.on in WHOLE and one.without != "term"]
        found = [operand for one in fitting for operand in self._at(one, nearest[:COMMANDS], first=None)]
        return _Group(found, lambda share, left: min(max(share, LEAST_EACH * len(found)), left // 3))

    def _at_commands(self, known: Sequence[Template], among: Sequence[Spot]) -> _Group:
        """Return the operands of the templates for any number at the values that are published."""
        nearest = _commands(among)
        # an offset also acts where the command should be 0, so offsets come after the factors
        fitting = sorted((one for one in known if one.on in WHOLE), key=lambda one: one.without == "term")
        found = [operand for one in fitting for operand in self._at(one, nearest[:COMMANDS], first=None)]
        return _Group(found, lambda share, left: min(max(share, LEAST_EACH * len(found)), left // 3))

    def _at_the_best(self, known: Sequence[Template], among: Sequence[Spot]) -> list[Operand]:
        """Return, at the statement that responds most, the operands of the templates that need no sensor."""
        here = [spot for spot in among if str(spot.site) in self.responding[:1]]
        fitting = [one for one in known if one.on not in OF_SENSORS]
        return [operand for one in fitting for operand in self._at(one, here, first=True)]

    def _groups(self, known: Sequence[Template], among: Sequence[Spot]) -> list[_Group]:
        groups: list[_Group] = []
        for first in (True, False):
            for _, same in groupby(known, key=lambda one: one.cost):
                operands = [operand for one in same for operand in self._at(one, among, first)]
                groups += [_Group(operands)] if operands else []
        return groups

    def _at(self, template: Template, among: Sequence[Spot], first: bool | None) -> Iterator[Operand]:
        """Yield a template's operands at the first expressions, at the later ones, or at all. Store their forms."""
        for number, each in enumerate(forms(self.order, template, among)):
            if first is None or (number < FIRST) == first:
                for operand, form in each:
                    if operand not in self._found:
                        self._found[operand] = form
                        if not fixed(form):
                            yield operand


def _commands(among: Sequence[Spot]) -> list[Spot]:
    """Return the values that are published, those nearest to the publish call first, fields before other values."""
    sent = [spot for spot in among if spot.kind in COMMANDED]
    return sorted(sent, key=lambda spot: (spot.away, spot.kind != FIELD))


def _responding(effects: Mapping[str, Sequence[OperandEffect]], wanted: float) -> tuple[str, ...]:
    """Return the IDs of the statements that respond (see RESPONDS), largest gain first.

    Operands without a known value are left out: they represent several constants, such as the parameters that a helper
    function looks up, so their gain does not show where to change the program.
    """
    known = {site: [one.effect for one in each if one.value is not None] for site, each in effects.items()}
    gains = {site: max(gains, default=0.0) for site, gains in known.items()}
    found = [site for site, gain in gains.items() if gain > 0.0 and gain >= RESPONDS * wanted]
    return tuple(sorted(found, key=lambda site: -gains[site]))
