"""Two domains side by side: which rules say the same, and where what they foretell differs."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cleancli.api.checks import check_least
from cleancli.api.experience_paths import experience_files
from cleancli.api.explanations import effect_text
from cleancli.api.inputs import GivenDomain, LoadedDomain, load_domain
from cleancli.api.plain import plain
from cleancli.api.tables import TextTable, preformatted, shown
from cleancli.compiler.fluents import Values
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import Action, Domain, Fact, Price, Variable
from cleancli.language.printing.printer import (
    print_fact,
    print_float,
    print_payments,
    print_price,
    print_reward,
)
from cleancli.learning.compared import RulePair, compared
from cleancli.learning.drawn_states import drawn_states
from cleancli.learning.experience import Transition, read_experience
from cleancli.learning.likeness import Likeness, vocabulary_differences
from cleancli.learning.variation import Paid, foretold_paid
from cleancli.planning.plan import BadOption

DRAWN = 1000
"""States that are drawn where no experience is given; chosen."""


@dataclass(frozen=True, slots=True)
class ForetoldChange:
    """What may change and be paid, each as an effect is written, and how likely; empty where nothing is."""

    probability: float
    changes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class StateOfDifference:
    """An action in a state, which has what it takes and nothing else: its objects beside constants with their
    types, the facts that hold, and what both domains foretell."""

    action: str
    objects: dict[str, str]
    state: tuple[str, ...]
    first: tuple[ForetoldChange, ...]
    second: tuple[ForetoldChange, ...]


@dataclass(frozen=True, slots=True)
class ComparedRules:
    """A rule of each domain, by their names, that cover an action in so many states; None where no rule does.

    `likeness` is that of their texts: "same", "probabilities" where nothing else differs, or "other".
    `variation` is the total variation of what they foretell, in the mean, and `largest` the most; `witness`
    is where it is the most, None where it is nowhere.
    """

    action: str
    first: str | None
    second: str | None
    likeness: str
    states: int
    variation: float | None
    largest: float | None
    witness: StateOfDifference | None


@dataclass(frozen=True, slots=True)
class RulesComparison:
    """The rules of two domains, and how far they are from each other in all states that were looked at."""

    rules: tuple[ComparedRules, ...]
    states: int
    variation: float
    notes: tuple[str, ...]

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli compare-rules --json` prints."""
        told = {"rules": plain(self.rules), "notes": list(self.notes)}
        return {"variation": self.variation, "states": self.states, **told}

    def table(self) -> TextTable:
        """A row for each pair of rules."""
        heads = ("action", "first", "second", "text", "states", "TV", "largest")
        rows = (
            (
                each.action,
                each.first or "-",
                each.second or "-",
                each.likeness,
                str(each.states),
                _number(each.variation),
                _number(each.largest),
            )
            for each in self.rules
        )
        return TextTable(heads, tuple(rows), (0, 1, 2, 3))

    def witnesses(self) -> str:
        """Where each pair of rules differs most."""
        return "\n".join(_told(each, each.witness) for each in self.rules if each.witness is not None)

    def __str__(self) -> str:
        parts = (str(self.table()), self.witnesses(), "\n".join(self.notes))
        return "\n\n".join(part for part in parts if part)

    def _repr_html_(self) -> str:
        told = "".join(f"<p>{shown(note)}</p>" for note in self.notes)
        return f"<div>{self.table().html()}{preformatted(self.witnesses())}{told}</div>"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:z.4f}"


def _told(pair: ComparedRules, witness: StateOfDifference) -> str:
    arguments = witness.action.partition("(")[2].rstrip(")").split(", ")
    others = [f"{name} - {of}" for name, of in witness.objects.items() if name not in arguments]
    beside = f" beside {', '.join(others)}" if others else ""
    state = f"where {', '.join(witness.state)}" if witness.state else "where no fact holds"
    lines = [f"{witness.action}{beside}, {state}: TV {_number(pair.largest)}"]
    for title, rule, said in (
        ("first", pair.first, witness.first),
        ("second", pair.second, witness.second),
    ):
        lines.append(f"  {title}, {rule or 'no rule'}")
        lines += [f"    {each.probability:z.4g}: {', '.join(each.changes) or 'nothing'}" for each in said]
    return "\n".join(lines)


def compare_rules(
    first: GivenDomain,
    second: GivenDomain,
    *experience: str | Path,
    states: int = DRAWN,
    seed: int = 0,
) -> RulesComparison:
    """Compare the rules of two domains that declare the same types, constants, symbols and actions.

    They are compared in the states of experience files or run folders, or where none is given in so many
    `states` that are drawn from `seed`. Raises Refused for mistakes in the texts and in the experience,
    ValueError for what makes no sense, and OSError.
    """
    check_least(1, states=states)
    check_least(0, seed=seed)
    both = load_domain(first), load_domain(second)
    return comparison(*both, [Path(each) for each in experience], states, seed)


def comparison(
    first: LoadedDomain, second: LoadedDomain, experience: Sequence[Path], states: int, seed: int
) -> RulesComparison:
    """What two domains foretell, side by side. Raises Refused, OSError, BadOption."""
    one, other = first.model, second.model
    differences = vocabulary_differences(one, other)
    if differences:
        told = "; ".join(differences)
        raise BadOption(f"only rules over one vocabulary can be compared: {told}")
    if experience:
        files, passed_over = experience_files(experience, one)
        given: Sequence[Transition] = [each for file in files for each in read_experience(file.path, one)]
        source = "; ".join((f"the states of {plural(len(given), 'transition')}", *passed_over))
    else:
        rng = np.random.default_rng(seed)
        given = list(itertools.islice(drawn_states((one, other), rng), states))
        source = f"{plural(len(given), 'state')} drawn with seed {seed}"
    found = compared(one, other, given)
    notes = [f"TV {_number(found.variation)} in the mean over {source}"]
    if found.conflict is not None:
        where = f"{found.conflict.message}, {found.conflict.label}"
        notes.append(
            f"{plural(found.unclear, 'state')} left out, where an outcome gives one fact two values (E602);"
            f" the first: {where}"
        )
    same = sum(pair.likeness is Likeness.SAME for pair in found.pairs)
    notes.append(f"{plural(same, 'rule')} of {len(one.rules)} and {len(other.rules)} say the same")
    notes += _beside_rules(one, other)
    rules = tuple(_row(one, other, pair) for pair in found.pairs)
    return RulesComparison(rules, found.states, round(found.variation, 6), tuple(notes))


def _beside_rules(one: Domain, other: Domain) -> Iterator[str]:
    """What pays or takes otherwise without being said by rules: the costs and durations of actions, and the
    reward."""
    seconds = {action.name: action for action in other.actions}
    for action in one.actions:
        like = _as_named(seconds[action.name], action.parameters)
        pairs = ("costs", _cost(action), _cost(like)), ("lasts", _lasting(action), _lasting(like))
        for does, first, second in pairs:
            if first != second:
                yield f"{action.name} {does} {first} in the first and {second} in the second, beside TV"
    rewards = [print_reward(sorted(domain.reward, key=str)) for domain in (one, other)]
    if rewards[0] != rewards[1]:
        yield f"the reward is `{rewards[0]}` in the first and `{rewards[1]}` in the second, beside TV"


def _as_named(action: Action, parameters: Sequence[Variable]) -> Action:
    """The action with parameters of other names."""
    return replace(action, cost=action.cost.renamed(dict(zip(action.parameters, parameters, strict=True))))


def _cost(action: Action) -> str:
    return print_price(action.cost)


def _lasting(action: Action) -> str:
    return "no time that is said" if action.duration is None else f"{print_float(action.duration)} s"


def _row(one: Domain, other: Domain, pair: RulePair) -> ComparedRules:
    return ComparedRules(
        pair.action,
        None if pair.first is None else one.rules[pair.first].name,
        None if pair.second is None else other.rules[pair.second].name,
        pair.likeness.value,
        pair.states,
        round(pair.total / pair.states, 6) if pair.states else None,
        None if not pair.states else round(pair.witness.distance, 6) if pair.witness else 0.0,
        None if pair.witness is None else _state_of(one, other, pair.witness.transition),
    )


def _state_of(one: Domain, other: Domain, transition: Transition) -> StateOfDifference:
    first, second = (_foretold(domain, transition) for domain in (one, other))
    objects = {each.name: each.type for each in transition.objects}
    action = f"{transition.action}({', '.join(transition.arguments)})"
    return StateOfDifference(action, objects, _facts(transition.before), first, second)


def _facts(values: Values) -> tuple[str, ...]:
    return tuple(print_fact(Fact(name, objects, value)) for (name, objects), value in sorted(values.items()))


def _foretold(domain: Domain, transition: Transition) -> tuple[ForetoldChange, ...]:
    """What a domain foretells, the likeliest first."""
    likely = foretold_paid(LiftedRules(domain), transition)
    found = [ForetoldChange(round(share, 6), _effects(result)) for result, share in likely.items() if share]
    return tuple(sorted(found, key=lambda each: (-each.probability, each.changes)))


def _effects(result: Paid) -> tuple[str, ...]:
    changes = sorted(effect_text(*key, value) for key, value in result.changes)
    return (*changes, *print_payments(Price(result.reward), Price(result.cost)))
