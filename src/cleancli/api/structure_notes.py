"""What a person should know of whole rules that were learned, beside their text."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from cleancli.compiler.lifted import Test, further
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import Domain
from cleancli.language.printing.printer import print_condition, print_payments, symbols_of
from cleancli.learning.experience import Transition
from cleancli.learning.method import KNOWN
from cleancli.learning.structure.induce import Revised
from cleancli.learning.structure.score import together
from cleancli.learning.variation import foretold

_OLD = {False: "its old rules", True: "its rules that were left aside"}
"""What dropped rules of an action are called, by whether the domain was taken as a vocabulary."""


def notes_of(names: Sequence[str], found: Revised, vocabulary: bool) -> Iterator[str]:
    """How many rules were learned and dropped, what no outcome says, and which actions nothing is known of;
    `vocabulary`: the domain's own rules were left out."""
    scores = together(list(found.after.values()))
    yield (
        f"{plural(scores.transitions, 'transition')} of {plural(len(found.after), 'action')}:"
        f" {plural(len(found.added), 'rule')} learned, {plural(len(found.dropped), 'rule')} dropped"
    )
    if scores.unforetold:
        share = scores.unforetold / scores.transitions
        yield (
            f"in {plural(scores.unforetold, 'transition')} ({share:z.1%}) something happened that no outcome"
            " says: it counts as noise, or was seen wrongly"
        )
    for name in names:
        if name not in found.after:
            rules = "it has no rule" if vocabulary else "its rules stay as they are"
            yield f"{name}: the experience has no transition of it, so {rules}"


def about_held_out(number: int) -> Iterator[str]:
    """What the column of the transitions that were held out says, of which there were so many."""
    if number:
        yield (
            f"held out, each: the mean log-likelihood of {plural(number, 'transition')} that were held out,"
            " by the rules as they were, and by rules that were learned from the others; nearer to 0 is"
            " better"
        )


def unasked(
    model: Domain,
    dropped: Collection[str],
    new: Domain,
    transitions: Sequence[Transition],
    vocabulary: bool,
) -> Iterator[str]:
    """The conditions of dropped rules of which the transitions of their action hardly tell whether they
    matter: those that held before all, and those that did not hold before fewer than KNOWN of those of which
    one of the `new` rules foretells a change, none of which happened; `vocabulary` as in `notes_of`."""
    rules, told = LiftedRules(model), LiftedRules(new)
    asked = _asked(model, rules, dropped, transitions)
    for action in model.actions:
        own = [each for each in transitions if each.action == action.name]
        tests = asked.get(action.name, {})
        in_vain = {text: _in_vain(test, own, rules, told) for text, test in tests.items()}
        ask = f"{action.name}: {_OLD[vocabulary]} ask for"
        always = [f"`{text}`" for text, number in in_vain.items() if number == 0]
        if always:
            yield (
                f"{ask} {', '.join(always)}, and the new ones do not, because it held before every"
                " transition: add experience in which it does not, or write it into them"
            )
        for text, number in in_vain.items():
            if number is not None and 0 < number < KNOWN:
                yield (
                    f"{ask} `{text}`, and the new ones do not, because in only {number} of"
                    f" {plural(len(own), 'transition')} it did not hold where they apply: add experience in"
                    " which it does not, or write it into them"
                )


def _asked(
    model: Domain, rules: LiftedRules, dropped: Collection[str], transitions: Sequence[Transition]
) -> dict[str, dict[str, Test]]:
    """The conditions of the dropped rules of each action that there are transitions of, by their texts."""
    symbols = symbols_of(model)
    asked: dict[str, dict[str, Test]] = {each.action: {} for each in transitions}
    for rule in model.rules:
        if rule.name in dropped and rule.action in asked:
            for part in rule.condition:
                test = rules.meaning.test((part,), further({}, rule.variables))
                asked[rule.action][print_condition((part,), symbols)] = test
    return asked


def _in_vain(test: Test, own: Sequence[Transition], rules: LiftedRules, told: LiftedRules) -> int | None:
    """In how many transitions of an action a condition did not hold, nothing happened, and the new rules
    foretell a change; 0 where it held before all. None where the new rules say so otherwise, or where
    something happened without it."""
    without = [each for each in own if not test(rules.state(each.objects, each.before), each.arguments)]
    in_vain = [each for each in without if foretold(told, each).keys() - {frozenset()}]
    if any(each.changed for each in in_vain) or (without and not in_vain):
        return None
    return len(in_vain)


def unpaid(model: Domain, dropped: Collection[str], vocabulary: bool) -> Iterator[str]:
    """What outcomes of dropped rules paid: transitions do not say what was paid, so new rules pay nothing;
    `vocabulary` as in `notes_of`."""
    for action in model.actions:
        paid = dict.fromkeys(
            payment
            for rule in model.rules
            if rule.action == action.name and rule.name in dropped
            for outcome in rule.outcomes
            for payment in print_payments(outcome.reward, outcome.cost)
        )
        if paid:
            told = ", ".join(f"`{each}`" for each in paid)
            yield (
                f"{action.name}: outcomes of {_OLD[vocabulary]} paid {told}, and those of the new ones pay"
                " nothing, because experience does not tell what was paid: write it into them again"
            )
