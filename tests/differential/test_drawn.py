"""Every construct of the language occurs in the drawn domains, and what is right is mostly accepted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from random import Random

import pytest

from support.differential.abstract import (
    FREE,
    AnyOf,
    Closure,
    Comparison,
    Definition,
    Domain,
    Equality,
    Every,
    Exists,
    ForEach,
    Literal,
    Part,
    Price,
    Problem,
    Rule,
    Shift,
    Truth,
)
from support.differential.drawing import draw
from support.differential.writing import Writer

DRAWN = 300


def parts_of(domain: Domain, problem: Problem) -> Iterator[tuple[str, Part]]:
    for rule in domain.rules:
        yield from (("rule", part) for part in rule.condition)
        yield from (("reference", part) for each in rule.references for part in each.body)
        for effect in effects_of(rule):
            if isinstance(effect, ForEach):
                yield from (("forall effect", part) for part in effect.guard)
    for count in domain.counts:
        yield from (("count", part) for part in count.condition)
    for derived in domain.derived:
        if isinstance(derived, Definition):
            yield from (("definition", part) for part in derived.condition)
    yield from (("goal", part) for part in problem.goal)


def effects_of(rule: Rule) -> Iterator[object]:
    return (effect for outcome in rule.outcomes for effect in outcome.effects)


def constructs(domain: Domain, problem: Problem) -> Iterator[str]:
    derived = {each.name for each in domain.derived}
    for where, part in parts_of(domain, problem):
        yield f"{where}: {type(part).__name__}"
        literals: tuple[Literal, ...] = (part,) if isinstance(part, Literal) else ()
        if isinstance(part, AnyOf):
            literals = part.literals
        elif isinstance(part, Exists):
            yield f"{where}: exists {part.holds}"
            literals = part.body
        elif isinstance(part, Every):
            yield f"{where}: forall, guarded {bool(part.guard)}"
            literals = (*part.guard, part.then)
        for literal in literals:
            if isinstance(literal, Truth) and literal.symbol in derived:
                yield f"{where}: derived"
            if isinstance(literal, Comparison):
                yield f"relation {literal.relation}"
            if isinstance(literal, Equality):
                yield f"equality {literal.same}"
    yield from constructs_of_rules(domain)
    yield from constructs_of_declarations(domain, problem)


def constructs_of_rules(domain: Domain) -> Iterator[str]:
    for rule in domain.rules:
        yield f"{len(rule.references)} references"
        yield f"rule with {len(rule.parameters)} parameters"
        yield f"{len(rule.outcomes)} outcomes"
        for outcome in rule.outcomes:
            yield f"outcome {outcome.idle or 'change'}"
            pays = (outcome.reward, outcome.cost) != (FREE, FREE)
            yield from ("an outcome that only pays" for _ in range(pays and not outcome.effects))
            yield from constructs_of_prices("reward", outcome.reward, rule)
            yield from constructs_of_prices("outcome's cost", outcome.cost, rule)
            yield f"probability {'number' if outcome.said[0].isdigit() else outcome.said}"
            yield from (word for word in ("prior", "seen", "fixed") if word in outcome.marks)
            yield from ("rest counted" for _ in range(outcome.said == "rest" and "seen" in outcome.marks))
            yield from ("counted in part" for _ in range("." in outcome.marks.partition("seen")[2]))
            yield from ("probability 0" for _ in range(not outcome.probability))
            shifts = [effect.symbol for effect in outcome.effects if isinstance(effect, Shift)]
            yield from ("shifts of one symbol" for _ in range(len(shifts) > len(set(shifts))))
        for effect in effects_of(rule):
            yield f"effect {type(effect).__name__}"
            if isinstance(effect, ForEach):
                kind = "forall" if effect.variables else "if"
                yield f"{kind} of {len(effect.settings)} effects, guarded {bool(effect.guard)}"


def constructs_of_prices(what: str, price: Price, rule: Rule | None = None) -> Iterator[str]:
    signs = [
        "-" if number < 0 else "+" for number in (price.number, *(p.weight for p in price.parts)) if number
    ]
    yield from (f"{what} {sign}=" for sign in signs)
    yield from (f"{what} of both signs" for _ in range(len(set(signs)) > 1))
    yield from (f"{what} of a number and functions" for _ in range(bool(price.number and price.parts)))
    yield from (f"{what} of {len(price.parts)} functions" for _ in range(bool(price.parts)))
    symbols = [part.symbol for part in price.parts]
    yield from (f"{what} by one function twice" for _ in range(len(symbols) > len(set(symbols))))
    referred = {each.name for reference in (rule.references if rule else ()) for each in reference.variables}
    for part in price.parts:
        yield f"{what} by a function of {len(part.terms)}"
        yield from (f"{what} by a constant" for term in part.terms if not term.startswith("?"))
        yield from (f"{what} by a reference" for term in part.terms if term in referred)
        yield f"{what}, weight {'1' if abs(part.weight) == 1 else '0' if not part.weight else 'another'}"


def constructs_of_declarations(domain: Domain, problem: Problem) -> Iterator[str]:
    for symbol in domain.symbols:
        kind = "predicate" if not symbol.values else f"function {type(symbol.values[0]).__name__}"
        yield f"{kind} of {len(symbol.kinds)}"
        yield from ("symmetric and static" for _ in range(symbol.symmetric and symbol.static))
        yield from ("symmetric" for _ in range(symbol.symmetric))
        yield from ("static" for _ in range(symbol.static))
    for derived in domain.derived:
        yield type(derived).__name__
        if isinstance(derived, Closure) and derived.of.startswith(("sym", "d")):
            yield f"closure of {derived.of.rstrip('0123456789')}"
    for action in domain.actions:
        yield f"action of {len(action.parameters)}"
        yield f"duration {action.duration is not None}, cost {action.cost is not None}"
        yield from constructs_of_prices("cost", action.cost or FREE)
    for payment in domain.reward:
        yield f"{payment.kind} {'+' if payment.weight > 0 else '-' if payment.weight < 0 else '0'}"
    yield from ("waiting" for rule in domain.rules if not any(effects_of(rule)))
    yield f"default {domain.default}"
    yield f"discount {problem.discount}"
    said = problem.horizon
    yield f"horizon {None if said is None else tuple(each is not None for each in said)}"
    yield from ("include" for _ in range(domain.included > 0))
    yield from ("types below types" for _, above in domain.kinds if above)
    yield from ("constants" for _ in domain.constants)
    kinds = {each.kind for each in (*domain.constants, *problem.objects)}
    yield from ("a type without objects" for kind, _ in domain.kinds if kind not in kinds)


COUNTED = "0.9 [seen 12.4]: nothing  0.1: noise"
EXPECTED = (
    *(
        f"{where}: {kind}"
        for where in ("rule", "count", "definition", "goal")
        for kind in ("Truth", "Comparison", "AnyOf", "Exists", "Every", "derived")
    ),
    *(f"rule: {kind}" for kind in ("Equality", "exists True", "exists False")),
    *(f"rule: forall, guarded {guarded}" for guarded in (True, False)),
    *(
        f"{where}: {kind}"
        for where in ("reference", "forall effect")
        for kind in ("Truth", "derived", "Equality")
    ),
    *(f"relation {relation}" for relation in ("=", "!=", "<", "<=", ">", ">=")),
    *(f"equality {same}" for same in (True, False)),
    *(f"{number} references" for number in (0, 1, 2)),
    *(f"rule with {number} parameters" for number in (0, 1, 2)),
    *(f"{number} outcomes" for number in (1, 2, 3, 4)),
    *(f"outcome {kind}" for kind in ("change", "nothing", "noise")),
    *(f"probability {kind}" for kind in ("number", "rest", "slip", "spill", "0")),
    *("prior", "seen", "fixed", "rest counted", "counted in part", "shifts of one symbol"),
    *(f"effect {kind}" for kind in ("SetTruth", "SetValue", "Shift", "ForEach")),
    *(f"forall of {number} effects, guarded {guarded}" for number in (1, 2) for guarded in (True, False)),
    *(f"if of {number} effects, guarded True" for number in (1, 2)),
    *(f"predicate of {number}" for number in (0, 1, 2, 3)),
    *(f"function {kind} of {number}" for kind in ("int", "str") for number in (0, 1, 2)),
    *("symmetric", "static", "symmetric and static", "Definition", "Closure"),
    *("closure of sym", "closure of d"),
    *(f"action of {number}" for number in (0, 1, 2)),
    *(f"duration {timed}, cost {paid}" for timed in (True, False) for paid in (True, False)),
    *(f"{kind} {sign}" for kind in ("decrease", "count", "goal", "cost") for sign in "+-"),
    *("reward +=", "reward -=", "outcome's cost +=", "an outcome that only pays", "reward of both signs"),
    *(
        f"{what} {kind}"
        for what in ("cost", "reward", "outcome's cost")
        for kind in (
            *("of a number and functions", "by one function twice", "by a constant"),
            *(f"of {number} functions" for number in (1, 2, 3)),
            *(f"by a function of {number}" for number in (0, 1, 2)),
        )
    ),
    *(f"{what}, weight {weight}" for what in ("cost", "reward") for weight in ("1", "another")),
    *("reward by a reference", "outcome's cost by a reference"),
    "cost, weight 0",
    *("waiting", "include", "types below types", "constants", "a type without objects"),
    *(f"default {default}" for default in (None, "1: nothing", "1: noise", "rest: noise", COUNTED)),
    *(f"discount {discount}" for discount in (None, "0", "1", "0.5")),
    *(f"horizon {kind}" for kind in (None, (True, False), (False, True), (True, True))),
)


@pytest.fixture(scope="module")
def found() -> Counter[str]:
    return Counter(name for seed in range(DRAWN) for name in set(constructs(*draw(seed))))


def test_every_construct_is_drawn(found: Counter[str]) -> None:
    assert {name: found[name] for name in EXPECTED if found[name] < 3} == {}


def test_what_was_learned_is_written_around_durations_and_in_a_block() -> None:
    texts = [Writer(Random(seed)).domain(draw(seed)[0])[0] for seed in range(DRAWN // 3)]
    for words in ("s [prior 9 s, seen 12.5]", "s [seen 3]", "s [fixed]", "learned {", "experience"):
        assert sum(words in text for text in texts) >= 3, words


def test_a_seed_is_one_domain() -> None:
    first, again, other = draw(5), draw(5), draw(6)
    assert first == again != other
    assert Writer(Random(5)).domain(first[0]) == Writer(Random(5)).domain(again[0])
