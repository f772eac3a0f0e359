"""Which outcomes of a rule may have made a transition, and where each is wrong about other objects (§5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from cleancli.compiler.conflict import results
from cleancli.compiler.fluents import Fluent, Values, changeable_symbols
from cleancli.compiler.lifted import LiftedState, Names
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.model import Domain, Outcome, OutcomeKind, Value
from cleancli.learning.experience import Transition, remember

Changes = Mapping[Fluent, Value | None]
"""New values; None of a function that has none any more."""

SETS, MATCHES = 1 << 12, 1 << 14
"""What rules set, and matches, that are remembered."""


class Fit(NamedTuple):
    """What an outcome says of objects that its rule does not name, against what was seen of them.

    Of the changes that it announces, `hits` happened and `misses` did not; `strays` happened although it does
    not announce them, and `quiet` facts stayed as it says.
    """

    hits: int = 0
    misses: int = 0
    strays: int = 0
    quiet: int = 0


class Consequence(NamedTuple):
    """What an outcome sets: of objects about which no outcome may be wrong, and of others by its place among
    what outcomes of the rule set of them."""

    of_own: Mapping[Fluent, Value]
    of_others: int


@dataclass(frozen=True, slots=True, eq=False)
class Consequences:
    """Those of a rule's outcomes and what they set of others, each once; all `fluents` that they set; the
    objects about which none may be wrong, and all that count."""

    outcomes: tuple[Consequence, ...]
    of_others: tuple[Mapping[Fluent, Value], ...]
    fluents: tuple[Fluent, ...]
    own: frozenset[str]
    scope: frozenset[str]


class Comparison(NamedTuple):
    """A transition beside its rule: what its outcomes set, and what was seen.

    `names` are the objects that the rule's variables stand for. `of_own` and `of_others` are the fluents that
    changed, with their new values, of the objects about which no outcome may be wrong, and of others; `quiet`
    those of others that stayed.
    """

    rule: int | None
    names: tuple[str, ...]
    transition: Transition
    sets: Consequences
    of_own: Changes
    of_others: Changes
    quiet: Set[Fluent]


class Match(NamedTuple):
    """The outcomes of a rule beside a transition: `rule` is the covering rule's index in the domain, None for
    the default rule; `fits` has an entry per outcome, None where it cannot have made the transition."""

    rule: int | None
    fits: tuple[Fit | None, ...]


class Matcher:
    """Matches transitions with the outcomes of a domain's rules.

    An outcome is judged by what it would change beyond what held already, on the symbols that rules can
    change. What becomes of the objects that the rule names, as the action's arguments, in its references or
    as constants, decides strictly. Other objects count where an outcome of the rule would set something of
    them, and there an outcome may slip; where `strict`, it may not. What changes elsewhere explains nothing.

    Noise fits what no other outcome fits. It fits as well where nothing changed, since that is how it is
    planned for and simulated; where `strict`, it does not.
    """

    def __init__(self, domain: Domain, strict: bool = False) -> None:
        self._domain, self._strict = domain, strict
        self._changeable = changeable_symbols(domain)
        self._constants = frozenset(constant.name for constant in domain.constants)
        self._rules = LiftedRules(domain)
        self._missing = {symbol.name: self._rules.meaning.missing(symbol.name) for symbol in domain.symbols}
        self._noise = {
            rule: tuple(outcome.kind is OutcomeKind.NOISE for outcome in outcomes_of(domain, rule))
            for rule in (*range(len(domain.rules)), None)
        }
        self._matches: dict[tuple[object, ...], Match] = {}
        self._sets: dict[tuple[int | None, Names, tuple[tuple[Names, ...], ...]], Consequences] = {}

    def match(self, transition: Transition) -> Match:
        """The rule that covered the state before, and how its outcomes fit the state after.

        Raises `Refused` (E602) where an outcome of the rule gives something two values in the state before.
        """
        return self.fitting(self.compare(transition))

    def fitting(self, found: Comparison) -> Match:
        """Which outcomes may have made a transition that was compared already."""
        key = _all_that_matters(found)
        if key not in self._matches:
            remember(self._matches, key, self._fitting(found), MATCHES)
        return self._matches[key]

    def _fitting(self, found: Comparison) -> Match:
        slips = [self._slips(sets, found) for sets in found.sets.of_others]
        fits = [
            slips[outcome.of_others] if self._is_right(outcome.of_own, found) else None
            for outcome in found.sets.outcomes
        ]
        return Match(found.rule, self._with_noise(self._noise[found.rule], fits))

    def compare(self, transition: Transition) -> Comparison:
        """What the outcomes of the covering rule set, beside what was seen. Raises as `match` does."""
        state = self._rules.state(transition.objects, transition.before)
        rule, names = self._rules.covering(state, transition.action, transition.arguments) or (
            None,
            transition.arguments,
        )
        sets = self._consequences(state, rule, names)
        seen = self._seen(transition.before, transition.after, sets.own, sets.scope)
        return Comparison(rule, names, transition, sets, *seen)

    def announced(self, compared: Comparison, outcome: int) -> Changes:
        """What an outcome would change beyond what held already."""
        of_own, of_others = compared.sets.outcomes[outcome]
        sets = {**of_own, **compared.sets.of_others[of_others]}
        return self._changing(sets, compared.transition.before)

    def _consequences(self, state: LiftedState, rule: int | None, names: Names) -> Consequences:
        """What the outcomes of a rule set, found once for the same objects where no number is shifted."""
        lifted = None if rule is None else self._rules[rule]
        guards = () if lifted is None else lifted.guards
        key = rule, names, tuple([tuple(guard(state, names)) for guard in guards])
        if key in self._sets:
            return self._sets[key]
        found = self._divided(names, self._results(state, rule, names))
        if lifted is None or not lifted.shifts:
            remember(self._sets, key, found, SETS)
        return found

    def _results(
        self, state: LiftedState, rule: int | None, names: Names
    ) -> Sequence[Mapping[Fluent, Value]]:
        if rule is None:
            return ({},) * len(self._domain.default)
        return results(self._rules, state, rule, names)

    def _divided(self, names: Names, sets: Sequence[Mapping[Fluent, Value]]) -> Consequences:
        scope = frozenset(names).union(*[key[1] for each in sets for key in each])
        own = scope if self._strict else self._constants.union(names)
        outcomes: list[Consequence] = []
        others: list[Mapping[Fluent, Value]] = []
        for each in sets:
            of_own = {key: value for key, value in each.items() if own.issuperset(key[1])}
            of_others = {key: value for key, value in each.items() if key not in of_own}
            if of_others not in others:
                others.append(of_others)
            outcomes.append(Consequence(of_own, others.index(of_others)))
        fluents = tuple({key for each in sets for key in each})
        return Consequences(tuple(outcomes), tuple(others), fluents, own, scope)

    def _seen(
        self, before: Values, after: Values, own: frozenset[str], scope: frozenset[str]
    ) -> tuple[Changes, Changes, Set[Fluent]]:
        """What became of the changeable fluents of the objects in scope: of the rule's own and of others what
        changed, and of others what stayed."""
        changeable, missing = self._changeable, self._missing
        changed = {
            key: after.get(key, missing[key[0]])
            for key in {key for key, _ in before.items() ^ after.items()}
            if key[0] in changeable and scope.issuperset(key[1])
        }
        others = scope - own
        if not others:
            return changed, {}, frozenset()
        of_own = {key: value for key, value in changed.items() if others.isdisjoint(key[1])}
        of_others = {key: value for key, value in changed.items() if key not in of_own}
        concerned = {key for key in before if key[0] in changeable and not others.isdisjoint(key[1])}
        quiet = {key for key in concerned if scope.issuperset(key[1]) and key not in changed}
        return of_own, of_others, quiet

    def _is_right(self, sets: Mapping[Fluent, Value], seen: Comparison) -> bool:
        """Whether the rule's own objects are as an outcome that sets this leaves them."""
        if not seen.of_own.keys() <= sets.keys():
            return False
        after, missing = seen.transition.after, self._missing
        return all(after.get(key, missing[key[0]]) == value for key, value in sets.items())

    def _slips(self, sets: Mapping[Fluent, Value], seen: Comparison) -> Fit:
        """Where an outcome that sets this of other objects is right about them."""
        if not sets:
            return Fit(0, 0, len(seen.of_others), len(seen.quiet))
        announced = self._changing(sets, seen.transition.before)
        hits = len(announced.items() & seen.of_others.items())
        strays = len(seen.of_others.keys() - announced.keys())
        return Fit(hits, len(announced) - hits, strays, len(seen.quiet - announced.keys()))

    def _changing(self, sets: Mapping[Fluent, Value], before: Values) -> Changes:
        """What does not hold already."""
        missing = self._missing
        return {key: value for key, value in sets.items() if value != before.get(key, missing[key[0]])}

    def _with_noise(self, is_noise: Sequence[bool], fits: Sequence[Fit | None]) -> tuple[Fit | None, ...]:
        """The fits, those of noise being what noise may have made."""
        others = [None if noise else fit for noise, fit in zip(is_noise, fits, strict=True)]
        if not any(others):
            return tuple([Fit() if noise else None for noise in is_noise])
        return tuple(others if self._strict else fits)


def _all_that_matters(found: Comparison) -> tuple[object, ...]:
    """What decides which outcomes fit a transition."""
    before, after = found.transition.before, found.transition.after
    values = tuple(map(before.get, found.sets.fluents)), tuple(map(after.get, found.sets.fluents))
    return found.sets, *values, frozenset(found.of_own).union(found.of_others), len(found.quiet)


def outcomes_of(domain: Domain, rule: int | None) -> tuple[Outcome, ...]:
    """The outcomes of a rule by index, or of the default rule for None."""
    return domain.default if rule is None else domain.rules[rule].outcomes


def rule_name(domain: Domain, rule: int | None) -> str:
    """What a rule is called; the default rule has no name of its own."""
    return "default" if rule is None else domain.rules[rule].name


def prior_probabilities(outcomes: Sequence[Outcome]) -> tuple[Fraction, ...]:
    """What each outcome's probability was before anything was learned; `rest` takes what the others leave."""
    stated = [
        Fraction(0) if outcome.is_rest else (outcome.probability if outcome.prior is None else outcome.prior)
        for outcome in outcomes
    ]
    left = 1 - sum(stated, start=Fraction(0))
    return tuple(left if o.is_rest else prior for o, prior in zip(outcomes, stated, strict=True))
