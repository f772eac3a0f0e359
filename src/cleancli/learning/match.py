"""Which outcomes of a rule may have made a transition, and where each is wrong about other objects (§5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from cleancli.compiler.conflict import results
from cleancli.compiler.fluents import Fluent, Values, changeable_symbols
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.model import Domain, Outcome, OutcomeKind, Value
from cleancli.learning.experience import Transition

Changes = Mapping[Fluent, Value | None]
"""New values; None of a function that has none any more."""


class Fit(NamedTuple):
    """What an outcome says of objects that its rule does not name, against what was seen of them.

    Of the changes that it announces, `hits` happened and `misses` did not; `strays` happened although it does
    not announce them, and `quiet` facts stayed as it says.
    """

    hits: int = 0
    misses: int = 0
    strays: int = 0
    quiet: int = 0


class Comparison(NamedTuple):
    """A transition beside its rule: what each outcome announces beyond what held already, and what was seen.

    `names` are the objects that the rule's variables stand for, `own` those about which no outcome may be
    wrong. `of_own` and `of_others` are the fluents that changed, with their new values; `quiet` those of
    others that stayed.
    """

    rule: int | None
    names: tuple[str, ...]
    announced: tuple[Changes, ...]
    own: set[str]
    of_own: Changes
    of_others: Changes
    quiet: set[Fluent]


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

    def match(self, transition: Transition) -> Match:
        """The rule that covered the state before, and how its outcomes fit the state after.

        Raises `Refused` (E602) where an outcome of the rule gives something two values in the state before.
        """
        return self.fitting(self.compare(transition))

    def fitting(self, found: Comparison) -> Match:
        """Which outcomes may have made a transition that was compared already."""
        fits = [_fit(announced, found) for announced in found.announced]
        return Match(found.rule, self._with_noise(self._noise[found.rule], fits))

    def compare(self, transition: Transition) -> Comparison:
        """What the outcomes of the covering rule announce, beside what was seen. Raises as `match` does."""
        state, before = self._rules.state(transition.objects, transition.before), transition.before
        rule, names = self._rules.covering(state, transition.action, transition.arguments) or (
            None,
            transition.arguments,
        )
        sets: Sequence[Changes] = ({},) * len(outcomes_of(self._domain, rule))
        if rule is not None:
            sets = results(self._rules, state, rule, names)
        scope = {*names}.union(*[key[1] for each in sets for key in each])
        own = scope if self._strict else {*names, *self._constants}
        announced = tuple([self._announced(each, before) for each in sets])
        return Comparison(rule, names, announced, own, *self._seen(before, transition.after, scope, own))

    def _seen(
        self, before: Values, after: Values, scope: set[str], own: set[str]
    ) -> tuple[Changes, Changes, set[Fluent]]:
        """What became of the changeable fluents of the objects in scope: of the rule's own and of others what
        changed, and of others what stayed."""
        changeable, missing = self._changeable, self._missing
        of_own: dict[Fluent, Value | None] = {}
        of_others: dict[Fluent, Value | None] = {}
        quiet: set[Fluent] = set()
        for key in before.keys() | after.keys():
            if key[0] in changeable and scope.issuperset(key[1]):
                changed = before.get(key) != after.get(key)
                if own.issuperset(key[1]):
                    if changed:
                        of_own[key] = after.get(key, missing[key[0]])
                elif changed:
                    of_others[key] = after.get(key, missing[key[0]])
                else:
                    quiet.add(key)
        return of_own, of_others, quiet

    def _announced(self, sets: Changes, before: Values) -> Changes:
        """What an outcome would change beyond what holds already."""
        missing = self._missing
        return {key: value for key, value in sets.items() if value != before.get(key, missing[key[0]])}

    def _with_noise(self, is_noise: Sequence[bool], fits: Sequence[Fit | None]) -> tuple[Fit | None, ...]:
        """The fits, those of noise being what noise may have made."""
        others = [None if noise else fit for noise, fit in zip(is_noise, fits, strict=True)]
        if not any(others):
            return tuple([Fit() if noise else None for noise in is_noise])
        return tuple(others if self._strict else fits)


def _fit(announced: Changes, seen: Comparison) -> Fit | None:
    """What was seen of what was announced; None where the rule's own objects contradict it."""
    if announced == seen.of_own:
        return Fit(0, 0, len(seen.of_others), len(seen.quiet))
    own = seen.own
    of_own = {key: value for key, value in announced.items() if own.issuperset(key[1])}
    if of_own != seen.of_own:
        return None
    of_others = {key: value for key, value in announced.items() if key not in of_own}
    hits = len(of_others.items() & seen.of_others.items())
    strays = len(seen.of_others.keys() - of_others.keys())
    return Fit(hits, len(of_others) - hits, strays, len(seen.quiet - of_others.keys()))


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
