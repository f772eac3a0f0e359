"""A .nid domain and what is written of it as PPDDL, compared state by state.

The PPDDL side is the direct interpreter of `pddl_meaning`; nothing is converted back. Names are taken to have
stayed, but for letter case.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from fractions import Fraction
from itertools import product

import numpy as np

from cleancli.compiler.conflict import results
from cleancli.compiler.fluents import Fluent, Values
from cleancli.compiler.lifted import LiftedState
from cleancli.compiler.lifted_state import LiftedRules, StateView
from cleancli.compiler.objects_by_type import ObjectsByType
from cleancli.conversion.export.ppddl import ppddl
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.export.written import Written
from cleancli.conversion.pddl.read import read
from cleancli.conversion.pddl.syntax import (
    AllNode,
    ChanceNode,
    EachNode,
    EffectNode,
    PayNode,
    SetNode,
    WhenNode,
)
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import (
    Domain,
    Fact,
    Object,
    Price,
    Problem,
    RewardKind,
    Symbol,
    Value,
    Variable,
    weight_of,
)
from support.pddl_meaning import Binding, Meaning, World

Distribution = dict[World, Fraction]


def written(domain: Domain, problem: Problem, noise: str = "unchanged") -> Written:
    """The PPDDL files of a domain and a problem."""
    return ppddl(domain, [problem], noise, Unsaid("PPDDL", [Source("domain.nid", "")]))


def meaning_of(made: Written) -> Meaning:
    """What the files mean by definition; axioms are left out, and closures are atoms of each world."""
    text = "\n".join(made.texts.values())
    text = re.sub(r"^  \(:derived(.|\n)*?(?=^  [(;])", "", text, flags=re.M)
    source = Source("written.pddl", text)
    findings = Findings(source)
    domains, problems = read(source, findings)
    if findings.sorted:
        raise Refused(findings.sorted, [source])
    return Meaning(domains[0], problems[0])


# ---- states


def objects_of(domain: Domain, problem: Problem) -> tuple[Object, ...]:
    """All objects of a problem."""
    return (*domain.constants, *problem.objects)


def drawn_values(domain: Domain, problem: Problem, rng: np.random.Generator) -> Values:
    """Values of all fluents: those of the problem for what no rule ever changes, others at random."""
    by_type = ObjectsByType(domain, objects_of(domain, problem))
    found: dict[Fluent, Value] = {(f.symbol, f.objects): f.value for f in problem.state}
    likely = [outcome for rule in domain.rules for outcome in rule.outcomes if outcome.probability]
    changed = set(_changed(likely))
    for symbol in (symbol for symbol in domain.symbols if symbol.name in changed):
        share = rng.random()
        for names in product(*(by_type[each.type] for each in symbol.parameters)):
            key = symbol.name, names
            if names != symbol.canonical(names):
                continue
            if not symbol.is_predicate:
                found[key] = symbol.values[int(rng.integers(len(symbol.values)))]
            elif rng.random() < share:
                found[key] = True
            else:
                found.pop(key, None)
    return found


def _changed(outcomes: object) -> Iterator[str]:
    """The names of the symbols that stand in effects, wherever that is."""
    return (name for name in re.findall(r"(?:Assign|Shift)\(symbol='(\w+)'", repr(outcomes)))


def world_of(domain: Domain, values: Values) -> World:
    """The world of PPDDL that is a state, with closures."""
    symbols = {symbol.name: symbol for symbol in domain.symbols}
    found = {atom for key, value in values.items() for atom in _atoms(symbols[key[0]], key, value)}
    for derived in domain.derived:
        if derived.closure is not None:
            steps = {atom[1:] for atom in found if atom[0] == derived.closure.lower()}
            while len(longer := steps | {(a, d) for a, b in steps for c, d in steps if b == c}) > len(steps):
                steps = longer
            found |= {(derived.name.lower(), *pair) for pair in steps}
    return frozenset(found)


def _atoms(symbol: Symbol, key: Fluent, value: object) -> Iterator[tuple[str, ...]]:
    names = tuple(name.lower() for name in key[1])
    if not symbol.is_predicate:
        shown = f"minus_{-value}" if isinstance(value, int) and value < 0 else value
        yield (f"{symbol.name}-{shown}".lower(), *names)
    elif value:
        yield (symbol.name.lower(), *names)
        if symbol.symmetric:
            yield (symbol.name.lower(), *names[::-1])


def calls(domain: Domain, problem: Problem) -> Iterator[tuple[str, tuple[str, ...]]]:
    """All actions on objects."""
    by_type = ObjectsByType(domain, objects_of(domain, problem))
    for action in domain.actions:
        for names in product(*(by_type[each.type] for each in action.parameters)):
            yield action.name, names


# ---- what happens


def at_most_one_covers(rules: LiftedRules, state: LiftedState, action: str, names: tuple[str, ...]) -> bool:
    """Whether no two rules of an action cover these objects in a state."""
    numbers = [number for number, rule in enumerate(rules.domain.rules) if rule.action == action]
    return sum(rules[number].covers(state, names) is not None for number in numbers) <= 1


def counted(domain: Domain, problem: Problem, values: Values) -> dict[str, int]:
    """What the counts of a domain come to in a state."""
    state = frozenset(Fact(symbol, names, value) for (symbol, names), value in values.items())
    view = StateView(domain, problem.objects, state)
    return {c.name: sum(1 for _ in view.extensions(c.variables, c.condition, {})) for c in domain.counts}


def cost(domain: Domain, values: Values, action: str, names: tuple[str, ...]) -> Fraction:
    """What an action costs on objects (docs/language.md, Costs and rewards)."""
    (done,) = (each for each in domain.actions if each.name == action)
    return comes_to(done.cost, values, dict(zip(done.parameters, names, strict=True)))


def comes_to(price: Price, values: Values, given: Mapping[Variable, str]) -> Fraction:
    """What a price comes to for the objects that variables stand for."""
    found = price.number
    for part in price.parts:
        value = values[
            part.symbol, tuple(given[t] if isinstance(t, Variable) else t.name for t in part.terms)
        ]
        assert isinstance(value, int)
        found += part.weight * value
    return found


def reward(
    domain: Domain, problem: Problem, before: Values, action: str, names: tuple[str, ...], after: Values
) -> Fraction:
    """What a step is paid (docs/language.md, Costs and rewards), but for the goal."""
    old, new = counted(domain, problem, before), counted(domain, problem, after)
    (done,) = (each for each in domain.actions if each.name == action)
    found = Fraction(0)
    for term in domain.reward:
        count = term.count or ""
        match term.kind:
            case RewardKind.DECREASE:
                found += term.weight * (old[count] - new[count])
            case RewardKind.COUNT:
                found += term.weight * new[count]
            case RewardKind.COST:
                found += term.weight * cost(domain, before, action, names)
            case RewardKind.DURATION:
                found += term.weight * Fraction(done.duration or 0)
            case RewardKind.GOAL:
                pass
    return found


def happening(
    rules: LiftedRules, problem: Problem, values: Values, action: str, names: tuple[str, ...]
) -> list[tuple[Fraction, Values, Fraction]] | None:
    """The outcomes that a .nid domain has for an action, with their probabilities, the values after each and
    what it is paid but for the goal; None where no rule covers the state."""
    state = rules.state(problem.objects, values)
    found = rules.covering(state, action, names)
    if found is None:
        return None
    number, bound = found
    given = dict(zip(rules[number].variables, bound, strict=True))
    weight = weight_of(rules.domain, RewardKind.COST)
    happen: list[tuple[Fraction, Values, Fraction]] = []
    for outcome, changes in zip(
        rules.domain.rules[number].outcomes, results(rules, state, number, bound), strict=True
    ):
        if outcome.probability:
            after = {key: value for key, value in {**values, **changes}.items() if value is not False}
            paid = reward(rules.domain, problem, values, action, names, after)
            paid += comes_to(outcome.reward, values, given) + weight * comes_to(outcome.cost, values, given)
            happen.append((outcome.probability, after, paid))
    return happen


def expected(
    rules: LiftedRules, problem: Problem, values: Values, action: str, names: tuple[str, ...]
) -> tuple[Distribution, Fraction] | None:
    """The worlds that a .nid domain says follow, and what is paid in the mean; None where no rule covers the
    state."""
    happen = happening(rules, problem, values, action, names)
    if happen is None:
        return None
    likely: Distribution = {}
    for chance, after, _ in happen:
        world = world_of(rules.domain, after)
        likely[world] = likely.get(world, Fraction(0)) + chance
    return likely, sum((chance * paid for chance, _, paid in happen), Fraction(0))


def actual(
    meaning: Meaning, domain: Domain, world: World, action: str, names: tuple[str, ...]
) -> tuple[list[Distribution], list[Fraction]]:
    """The worlds that each schema of an action leads to whose precondition holds, and what each is paid in
    the mean."""
    closures = {derived.name.lower() for derived in domain.derived if derived.closure is not None}
    found, paid = [], []
    for schema in meaning.domain.actions:
        if schema.name.text.split("--")[0] != action.lower():
            continue
        variables = [each.name.text for each in schema.parameters]
        binding = dict(zip(variables, (name.lower() for name in names), strict=True))
        if meaning.holds(schema.precondition, world, binding):
            found.append(_without(meaning.successors(world, schema, binding), closures))
            paid.append(mean_paid(meaning, schema.effect, world, binding))
    return found, paid


def mean_paid(meaning: Meaning, node: EffectNode, world: World, binding: Binding) -> Fraction:
    """What an effect is paid in the mean."""
    match node:
        case SetNode():
            return Fraction(0)
        case AllNode(parts):
            return sum((mean_paid(meaning, part, world, binding) for part in parts), Fraction(0))
        case WhenNode():
            held = meaning.holds(node.condition, world, binding)
            return mean_paid(meaning, node.effect, world, binding) if held else Fraction(0)
        case EachNode():
            own = meaning.bindings(node.variables)
            return sum((mean_paid(meaning, node.effect, world, {**binding, **o}) for o in own), Fraction(0))
        case ChanceNode():
            return sum(
                (p * mean_paid(meaning, part, world, binding) for p, part in node.branches), Fraction(0)
            )
        case PayNode():
            if node.function.symbol.text != "reward":
                return Fraction(0)
            return meaning.rise(node.amount, binding)


def disagreements(domain: Domain, problem: Problem, states: int, rng: np.random.Generator) -> Iterator[str]:
    """Where the files do something else than the domain, or pay something else, in so many random states, by
    an action each. Raises Refused for what PPDDL can't say."""
    made = written(domain, problem)
    meaning, rules = meaning_of(made), LiftedRules(domain)
    closures = {derived.name.lower() for derived in domain.derived if derived.closure is not None}
    every = list(calls(domain, problem))
    for _ in range(states if every else 0):
        values = drawn_values(domain, problem, rng)
        world = world_of(domain, values)
        state = rules.state(problem.objects, values)
        covered = [each for each in every if rules.covering(state, *each)]
        among = covered if covered and rng.random() < 0.8 else every
        called = among[int(rng.integers(len(among)))]
        if not at_most_one_covers(rules, state, *called):  # E603: such a domain says nothing here
            continue
        try:
            wanted = expected(rules, problem, values, *called)
        except Refused:  # an outcome gives something two values (E602)
            continue
        found, paid = actual(meaning, domain, world, *called)
        if wanted is None:
            if found:
                yield f"{called} can be taken in {sorted(world)}"
        elif found != [_without(wanted[0], closures)]:
            yield f"{called} in {sorted(world)}: {found} and not {wanted[0]}"
        elif paid != [wanted[1]]:
            yield f"{called} in {sorted(world)} pays {paid[0]} and not {wanted[1]}"


def _without(worlds: Distribution, symbols: Collection[str]) -> Distribution:
    """The worlds without the atoms of some symbols."""
    found: Distribution = {}
    for world, chance in worlds.items():
        short = frozenset(atom for atom in world if atom[0] not in symbols)
        found[short] = found.get(short, Fraction(0)) + chance
    return found
