"""What each transition counted for, and which outcomes would explain what counts as noise (§5)."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from cleancli.compiler.fluents import Fluent
from cleancli.language.model import Domain, OutcomeKind, Value, Variable
from cleancli.learning.expectation import Beliefs, largest, shares
from cleancli.learning.experience import Transition
from cleancli.learning.match import Changes, Comparison, Matcher, outcomes_of

RESULTS_OF_NOISE = 100
"""Results that noise is taken to have, all alike likely, where an outcome of its own is compared with it.
Chosen."""


@dataclass(frozen=True, slots=True)
class Wrong:
    """A fluent that an outcome is wrong about: the value that it leads to, and the one that was seen."""

    fluent: Fluent
    announced: Value | None
    seen: Value | None


@dataclass(frozen=True, slots=True)
class Counted:
    """What a transition counted for: to how much for each outcome of the covering rule (None: the default
    rule). `likeliest` of them slips in `slips`; where that is noise, `nearest` is the outcome that is wrong
    about the fewest things, None where there is no other, and `wrong` says about which. `changed` are the new
    values of the rule's own objects, where none is of a symbol that rules change of others, and `names` what
    its variables stand for."""

    transition: Transition
    rule: int | None
    shares: tuple[float, ...]
    likeliest: int | None
    slips: tuple[Wrong, ...]
    nearest: int | None
    wrong: tuple[Wrong, ...]
    names: tuple[str, ...]
    changed: Changes

    def is_noise(self, domain: Domain) -> bool:
        """Whether it was something that the rule does not model."""
        if self.likeliest is None:
            return True
        return outcomes_of(domain, self.rule)[self.likeliest].kind is OutcomeKind.NOISE


def counted_for(
    domain: Domain, transitions: Iterable[Transition], beliefs: Beliefs, strict: bool
) -> Iterator[Counted]:
    """What each transition counted for, by what is believed now. Raises `Refused` (E602)."""
    matcher = Matcher(domain, strict)
    for transition in transitions:
        compared = matcher.compare(transition)
        found = shares(matcher.fitting(compared), beliefs)
        likeliest = largest(found)
        outcomes = outcomes_of(domain, compared.rule)
        models = [index for index, each in enumerate(outcomes) if each.kind is not OutcomeKind.NOISE]
        is_noise = likeliest not in models
        about = {index: tuple(_wrong(compared, matcher.announced(compared, index))) for index in models}
        nearest = min(models, key=lambda index: len(about[index]), default=None) if is_noise else None
        yield Counted(
            transition,
            compared.rule,
            found,
            likeliest,
            () if likeliest is None or is_noise else about[likeliest],
            nearest,
            () if nearest is None else about[nearest],
            compared.names,
            compared.of_own or _of_statics(compared),
        )


def _of_statics(compared: Comparison) -> Changes:
    """What became of the rule's own objects by symbols that no rule changes so far."""
    before, after = compared.transition.before, compared.transition.after
    changed = {key for key, _ in before.items() ^ after.items() if compared.sets.own.issuperset(key[1])}
    return {key: after.get(key, False) for key in changed if key in after or before[key] is True}


def _wrong(compared: Comparison, announced: Changes) -> Iterator[Wrong]:
    """What was announced otherwise than it was, in order."""
    seen = {**compared.of_own, **compared.of_others}
    for key in sorted(announced.keys() | seen.keys()):
        stayed: Value | None = compared.transition.before.get(key, False)
        says, was = announced.get(key, stayed), seen.get(key, stayed)
        if says != was:
            yield Wrong(key, says, was)


@dataclass(frozen=True, slots=True)
class Suggestion:
    """An outcome that a rule lacks, as a text to paste; of its `examples` so many are `noise`, and of these
    it `explains` so many. `gain` in log-likelihood, against noise with `RESULTS_OF_NOISE` results."""

    rule: int
    effects: str
    explains: int
    noise: int
    examples: int
    gain: float


class Suggestions:
    """Outcomes that would explain some of the noise better than noise does; of results that are added one
    after the other, however many there are."""

    def __init__(self, domain: Domain) -> None:
        self._domain = domain
        self._examples: Counter[int] = Counter()
        self._noise: Counter[int] = Counter()
        self._effects: Counter[tuple[int, str]] = Counter()

    def add(self, counted: Counted) -> None:
        """One more result."""
        if counted.rule is None:
            return
        self._examples[counted.rule] += 1
        if counted.is_noise(self._domain):
            self._noise[counted.rule] += 1
            text = _effects(self._domain, counted)
            if text:
                self._effects[counted.rule, text] += 1

    def found(self) -> tuple[Suggestion, ...]:
        """Those with a gain, of what happened more than once, the greatest first."""
        found = []
        for (rule, text), number in self._effects.items():
            examples, noise = self._examples[rule], self._noise[rule]
            gain = number * math.log(number * RESULTS_OF_NOISE / noise)
            if number > 1 and gain > 0:
                found.append(Suggestion(rule, text, number, noise, examples, gain))
        return tuple(sorted(found, key=lambda each: (-each.gain, each.rule, each.effects)))


def _effects(domain: Domain, counted: Counted) -> str:
    """What happened to the rule's own objects, as the effects of an outcome."""
    assert counted.rule is not None
    rule = domain.rules[counted.rule]
    variables = [*rule.variables, *(v for reference in rule.references for v in reference.variables)]
    stands = _standing(variables, counted.names)
    return ", ".join(_effect(key, counted.changed[key], stands) for key in sorted(counted.changed))


def _standing(variables: Iterable[Variable], names: Iterable[str]) -> dict[str, str]:
    """How each object is called in the rule; of two variables for one object, by the first."""
    stands: dict[str, str] = {}
    for variable, name in zip(variables, names, strict=True):
        stands.setdefault(name, f"?{variable.name}")
    return stands


def _effect(key: Fluent, value: Value | None, stands: dict[str, str]) -> str:
    symbol, objects = key
    application = f"{symbol}({', '.join(stands.get(name, name) for name in objects)})"
    if isinstance(value, bool):
        return application if value else f"not {application}"
    return f"{application} := {value}"
