"""What a person should know of whole rules that were learned, beside their text."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from cleancli.compiler.lifted import Test, further
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import Domain
from cleancli.language.printing.printer import print_condition, print_payments, symbols_of
from cleancli.learning.experience import Transition
from cleancli.learning.structure.induce import Revised
from cleancli.learning.structure.score import together

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
    model: Domain, dropped: Collection[str], transitions: Sequence[Transition], vocabulary: bool
) -> Iterator[str]:
    """The conditions of dropped rules that held before all transitions of their action, so that the search
    could not see that they matter; `vocabulary` as in `notes_of`."""
    rules, symbols = LiftedRules(model), symbols_of(model)
    asked: dict[str, dict[str, Test]] = {each.action: {} for each in transitions}
    for rule in model.rules:
        if rule.name in dropped and rule.action in asked:
            for part in rule.condition:
                test = rules.meaning.test((part,), further({}, rule.variables))
                asked[rule.action][print_condition((part,), symbols)] = test
    for each in transitions:
        state = rules.state(each.objects, each.before)
        held = asked[each.action].items()
        asked[each.action] = {text: test for text, test in held if test(state, each.arguments)}
    for name in (action.name for action in model.actions if asked.get(action.name)):
        parts = ", ".join(f"`{text}`" for text in asked[name])
        yield (
            f"{name}: {_OLD[vocabulary]} ask for {parts}, and the new ones do not, because it held before"
            " every transition: add experience in which it does not, or write it into them"
        )


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
