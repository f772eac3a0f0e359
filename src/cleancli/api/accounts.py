"""What each transition of some experience counted for, and outcomes that a domain's rules lack."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cleancli.api.experience_paths import experience_files
from cleancli.api.inputs import LoadedDomain
from cleancli.api.lessons import Counting
from cleancli.language.load import located_in
from cleancli.language.model import Domain
from cleancli.language.printing.printer import print_fraction, print_result
from cleancli.learning.experience import read_experience
from cleancli.learning.explained import Counted, Suggestion, Suggestions, Wrong, counted_for
from cleancli.learning.gathered import gather
from cleancli.learning.learn import learned_from
from cleancli.learning.match import outcomes_of, rule_name


@dataclass(frozen=True, slots=True)
class Account:
    """A transition by the name of its file and its number there, and what it counted for."""

    file: str
    number: int
    counted: Counted


class Accounts:
    """The transitions of some files one after the other, as they are read, and what noise could have been.

    Iterating raises Refused and OSError; `suggestions` are of what was passed so far. `notes`: on files that
    were passed over.
    """

    def __init__(self, domain: LoadedDomain, experience: Sequence[Path], counting: Counting) -> None:
        self.model = domain.model
        self._sources, self._counting = domain.sources, counting
        self._files, self.notes = experience_files(experience, domain.model)
        self._suggestions = Suggestions(domain.model)

    def __iter__(self) -> Iterator[Account]:
        method = self._counting.method(self.model)
        with located_in(*self._sources):
            gathered = gather(self.model, self._files, method.is_strict, adding=False, replacing=True)
            beliefs = learned_from(self.model, gathered.evidence, method).beliefs
            for file in self._files:
                transitions = read_experience(file.path, self.model)
                counted = counted_for(self.model, transitions, beliefs, method.is_strict)
                for number, each in enumerate(counted, start=1):
                    self._suggestions.add(each)
                    yield Account(file.name, number, each)

    @property
    def suggestions(self) -> tuple[Suggestion, ...]:
        """Outcomes that would explain noise, the best first."""
        return self._suggestions.found()


def told(domain: Domain, account: Account) -> Iterator[str]:
    """A transition as lines for people."""
    counted, transition = account.counted, account.counted.transition
    call = f"{transition.action}({', '.join(transition.arguments)})"
    yield f"{account.file}, {account.number}. {call}, by {rule_name(domain, counted.rule)}"
    for index, share in enumerate(counted.shares):
        if share > _SMALL:
            yield f"  {share:z.2f}: {_outcome(domain, counted.rule, index)}"
    if counted.likeliest is None:
        yield "  no outcome explains it, and there is no noise to count it to"
    for wrong in counted.slips:
        yield f"  though {_wrong(domain, wrong)}"
    if counted.nearest is not None and counted.wrong:
        because = ", ".join(_wrong(domain, wrong) for wrong in counted.wrong)
        yield f"  nearest: {_outcome(domain, counted.rule, counted.nearest)}, but {because}"


_SMALL = 0.005
"""A share that is shown as 0.00."""


def suggested(domain: Domain, found: Suggestion) -> str:
    """A suggestion as a line for people; its probability is the share of the rule's examples."""
    name, share = rule_name(domain, found.rule), found.explains / found.examples
    return (
        f"{name}: `{share:z.2f}: {found.effects}` would explain {found.explains} of {found.noise} results"
        f" that count as noise (log-likelihood + {found.gain:z.1f})"
    )


def as_data(domain: Domain, account: Account) -> dict[str, object]:
    """A transition for programs."""
    counted = account.counted
    return {
        "file": account.file,
        "number": account.number,
        "action": counted.transition.action,
        "arguments": list(counted.transition.arguments),
        "rule": None if counted.rule is None else domain.rules[counted.rule].name,
        "shares": [round(share, 6) for share in counted.shares],
        "outcome": counted.likeliest,
        "slips": [_data(wrong) for wrong in counted.slips],
        "nearest": counted.nearest,
        "wrong": [_data(wrong) for wrong in counted.wrong],
    }


def _outcome(domain: Domain, rule: int | None, index: int) -> str:
    outcome = outcomes_of(domain, rule)[index]
    symbols = {symbol.name: symbol for symbol in domain.symbols}
    chance = "rest" if outcome.is_rest else print_fraction(outcome.probability)
    return f"`{chance}: {print_result(outcome, symbols)}`"


def _wrong(domain: Domain, wrong: Wrong) -> str:
    """What was seen where the outcome says otherwise."""
    (symbol, objects), value = wrong.fluent, wrong.seen
    application = f"{symbol}({', '.join(objects)})"
    if any(each.name == symbol and each.is_predicate for each in domain.symbols):
        return application if value else f"not {application}"
    return f"{application} = {value}" if value is not None else f"{application} without value"


def _data(wrong: Wrong) -> dict[str, object]:
    symbol, objects = wrong.fluent
    return {"fact": [symbol, list(objects)], "announced": wrong.announced, "seen": wrong.seen}
