"""Whether the product refused rightly what it refused."""

from __future__ import annotations

from random import Random

from cleancli.language.diagnostics.diagnostic import Diagnostic
from support.differential.abstract import Outcome, Rule
from support.differential.comparison import Comparison, shown
from support.differential.interpreter import Meaning, State, TwoValues

SAMPLED = 200
"""States that are drawn to see whether a refusal by the checker is right."""

TOO_LARGE = ("E604", "E605", "E606")
"""Refusals that speak of the product's memory and not of the meaning."""


def drawn_state(meaning: Meaning, random: Random) -> State:
    return tuple(random.choice(meaning.symbols[symbol].values or (False, True)) for symbol, _ in meaning.keys)


def judge_check(comparison: Comparison, meaning: Meaning, errors: list[Diagnostic], random: Random) -> None:
    """A refusal by the checker must not be contradicted by any of many states.

    E305: the rule never covers. E309: the outcomes do the same. E307: of some pair of rules of an action
    both cover somewhere, which is only looked for. Anything else is no refusal that a drawn domain deserves.
    """
    for error in errors:
        code, message = error.code, error.message
        comparison.compared[f"refused {code}"] += 1
        if code not in ("E305", "E306", "E307", "E308", "E309", "E602"):
            comparison.differ("check", f"{code} {message}")
    states = [meaning.initial(), *(drawn_state(meaning, random) for _ in range(SAMPLED))]
    for error in errors:
        code, message = error.code, error.message
        for rule in meaning.domain.rules:
            if f"`{rule.name}`" in message and code == "E305":
                judge_never(comparison, meaning, rule, states)
    if {error.code for error in errors} == {"E309"}:
        judge_same_results(comparison, meaning, states)


def judge_never(comparison: Comparison, meaning: Meaning, rule: Rule, states: list[State]) -> None:
    for state in states:
        for asked in meaning.calls():
            if asked[0] == rule.action and meaning.bound(rule, asked, state) is not None:
                comparison.differ("E305", f"{rule.name} covers {asked} in {shown(meaning, state)}")
                return


def judge_same_results(comparison: Comparison, meaning: Meaning, states: list[State]) -> None:
    """Some rule has two outcomes that come to the same wherever it covers."""
    for rule in meaning.domain.rules:
        pairs = {
            (one, other)
            for one in range(len(rule.outcomes))
            for other in range(one)
            if (rule.outcomes[one].idle == "noise") == (rule.outcomes[other].idle == "noise")
        }
        for state in states:
            for asked in meaning.calls():
                binding = meaning.bound(rule, asked, state) if asked[0] == rule.action else None
                if binding is not None:
                    pairs = {
                        (one, other)
                        for one, other in pairs
                        if result(meaning, rule.outcomes[one], binding, state)
                        == result(meaning, rule.outcomes[other], binding, state)
                    }
        if pairs:
            return
    comparison.differ("E309", "no rule has two outcomes that do the same in all states drawn")


def result(meaning: Meaning, outcome: Outcome, binding: dict[str, str], state: State) -> State | None:
    try:
        return meaning.after(outcome, binding, state)
    except TwoValues:
        return None


def judge_ground(
    comparison: Comparison, meaning: Meaning, codes: tuple[str, ...], met: frozenset[str], random: Random
) -> None:
    """Grounding may refuse what only states show that are not reached; but some state must show it."""
    for code in codes:
        comparison.compared[f"refused {code}"] += 1
        if code in met or code in TOO_LARGE:
            continue
        comparison.compared[f"refused {code}, in no state reached"] += 1
        if code not in ("E602", "E603") or not shown_by_some(meaning, code, random):
            comparison.differ("grounding", f"{code}, and no state shows it")


def shown_by_some(meaning: Meaning, code: str, random: Random) -> bool:
    """Whether some drawn state shows it: two rules that cover (E603), or one, whatever others cover as well,
    with an outcome that contradicts itself (E602)."""
    for _ in range(5 * SAMPLED):
        state = drawn_state(meaning, random)
        for asked in meaning.calls():
            covering = [
                (rule, binding)
                for rule in meaning.domain.rules
                if rule.action == asked[0] and (binding := meaning.bound(rule, asked, state)) is not None
            ]
            if code == "E603" and len(covering) > 1:
                return True
            if code == "E602" and any(
                result(meaning, outcome, binding, state) is None
                for rule, binding in covering
                for outcome in rule.outcomes
            ):
                return True
    return False
