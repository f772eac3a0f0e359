"""The model as text in one canonical layout, so that reading what was printed gives the same model.

Guaranteed by the checker: names are declared and types fit. Comments and layout of a file are not known here;
a change to a user's file goes through `edit`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from itertools import groupby

from cleancli.language.diagnostics.diagnostic import printable
from cleancli.language.model import (
    Action,
    Assign,
    Condition,
    Count,
    DerivedPredicate,
    Domain,
    Equality,
    Experience,
    Fact,
    ForAll,
    Horizon,
    Knowledge,
    Literal,
    Object,
    Outcome,
    OutcomeKind,
    Parameter,
    Price,
    PricePart,
    Problem,
    Quantified,
    Reference,
    RewardKind,
    RewardTerm,
    Rule,
    Shift,
    Symbol,
    Term,
    Type,
    Unlimited,
    Value,
    Variable,
)

Symbols = Mapping[str, Symbol]


def print_domain(domain: Domain) -> str:
    """A domain as a .nid text; what it includes is written out."""
    symbols = symbols_of(domain)
    derived = [_derived(definition, symbols) for definition in domain.derived]
    predicates = [_predicate(s) for s in domain.symbols if s.is_predicate]
    functions = [_function(s) for s in domain.symbols if not s.is_predicate]
    blocks = [
        _block("types", [_types(domain.types)] if domain.types else []),
        _block("constants", _objects(domain.constants)),
        _block("predicates", predicates),
        _block("functions", functions),
        _block("derived", [*derived, *(_count(count, symbols) for count in domain.counts)]),
        _block("parameters", [_parameter(parameter) for parameter in domain.parameters]),
        _block("actions", [_action(action) for action in domain.actions]),
        *(print_rule(rule, symbols) for rule in domain.rules),
        print_default(domain.default, symbols),
        _block("reward", [print_reward(domain.reward)]),
        "" if domain.learned is None else print_learned(domain.learned),
    ]
    return f"domain {domain.name} {{\n" + "\n".join(block for block in blocks if block) + "}\n"


def print_learned(learned: Knowledge) -> str:
    """The block that says what the counts of a domain rest on, in the layout of `fmt`, and a line end."""
    settings = print_settings(learned)
    keys = max(map(len, settings))
    lines = [f"{key:{keys}} = {value}" for key, value in settings.items()]
    return _block("learned", [*lines, *print_experience(learned.experience)])


def print_settings(learned: Knowledge) -> dict[str, str]:
    """The values of the settings of that block, by their keys; what is optional only where it is unusual."""
    settings = {"estimator": learned.estimator, "m": print_float(learned.m), "match": learned.match}
    if learned.forgetting:
        settings["forgetting"] = print_float(learned.forgetting)
    return settings


def print_experience(experience: Sequence[Experience]) -> list[str]:
    """A line for each; signs that cannot stand between quotation marks are written out in the names."""
    named = [(_quoted(each.name), each) for each in experience]
    names = max((len(name) for name, _ in named), default=0)
    return [
        f'experience {name:{names}} [sha256 = "{each.sha256}", transitions = {each.transitions}]'
        for name, each in named
    ]


def _quoted(text: str) -> str:
    return '"' + printable(text).replace('"', "'") + '"'


def symbols_of(domain: Domain) -> dict[str, Symbol]:
    """Every symbol that a condition can ask for, by name; derived predicates look like predicates."""
    return {s.name: s for s in domain.symbols} | {
        d.name: Symbol(d.name, d.parameters) for d in domain.derived
    }


def print_problem(problem: Problem, domain: Domain | None = None) -> str:
    """A problem as a .nid text; facts are sorted. The domain is needed where it has a goal."""
    lines = [f"  domain = {problem.domain}\n"]
    lines.append(_block("objects", _objects(problem.objects)))
    lines.append(_block("init", [print_fact(fact) for fact in sorted_facts(problem.state)]))
    if problem.goal:
        assert domain is not None
        lines.append(_block("goal", [print_condition(problem.goal, symbols_of(domain))]))
    if problem.horizon is not None:
        lines.append(f"  horizon = {_horizon(problem.horizon)}\n")
    lines.append(f"  discount = {print_float(problem.discount)}\n")
    lines.append(_block("planner", _planner(problem)))
    return f"problem {problem.name} {{\n" + "".join(lines) + "}\n"


def sorted_facts(facts: Iterable[Fact]) -> list[Fact]:
    """Facts by symbol and objects; values play no part, since a state has one for each."""
    return sorted(facts, key=lambda fact: (fact.symbol, fact.objects))


def print_fact(fact: Fact) -> str:
    """`dirt(a1)` or `size(a1) = small`."""
    applied = f"{fact.symbol}({', '.join(fact.objects)})"
    return applied if isinstance(fact.value, bool) else f"{applied} = {fact.value}"


def print_fraction(value: Fraction) -> str:
    """A decimal where that is exact, else `n/d`."""
    rest = value.denominator
    twos = fives = 0
    while rest % 2 == 0:
        rest, twos = rest // 2, twos + 1
    while rest % 5 == 0:
        rest, fives = rest // 5, fives + 1
    if rest != 1:
        return f"{value.numerator}/{value.denominator}"
    places = max(twos, fives)
    scale: int = 10**places
    digits = str(value.numerator * scale // value.denominator).rjust(places + 1, "0")
    return digits if places == 0 else f"{digits[:-places]}.{digits[-places:]}"


def print_float(value: float) -> str:
    """The shortest decimal, without exponent, that reads as the same number."""
    text = format(Decimal(repr(value)), "f")
    return text.removesuffix(".0")


def print_term(term: Term) -> str:
    """`?a` or `bin`."""
    return f"?{term.name}" if isinstance(term, Variable) else term.name


def print_signature(name: str, parameters: Iterable[Variable]) -> str:
    """`near(?a - area, ?b - area)`: what is declared, with a type at every parameter."""
    return f"{name}({', '.join(f'{print_term(p)} - {p.type}' for p in parameters)})"


def print_literal(part: Literal | Equality, symbols: Symbols) -> str:
    """A literal as it was written; a set of values that no relation describes becomes several, joined by
    commas."""
    if isinstance(part, Equality):
        return f"{print_term(part.left)} {'=' if part.equal else '!='} {print_term(part.right)}"
    applied = _applied(part.symbol, part.terms)
    symbol = symbols[part.symbol]
    if symbol.is_predicate:
        return applied if True in part.values else f"not {applied}"
    if part.relation:
        return f"{applied} {part.relation} {_compared_with(part, symbol)}"
    return _comparison(applied, symbol, part.values)


def _compared_with(part: Literal, symbol: Symbol) -> Value:
    """The value that a comparison is written with, by the values for which it holds."""
    places = [place for place, value in enumerate(symbol.values) if value in part.values]
    match part.relation:
        case "!=":
            return next(value for value in symbol.values if value not in part.values)
        case "<":
            return symbol.values[places[-1] + 1]
        case "<=":
            return symbol.values[places[-1]]
        case ">":
            return symbol.values[places[0] - 1]
        case _:
            return symbol.values[places[0]]


def _comparison(applied: str, symbol: Symbol, values: frozenset[Value]) -> str:
    """That a function has one of some values."""
    chosen = [v for v in symbol.values if v in values]
    others = [v for v in symbol.values if v not in values]
    if len(chosen) == 1:
        return f"{applied} = {chosen[0]}"
    if len(others) > 1 and tuple(chosen) == symbol.values[: len(chosen)]:
        return f"{applied} <= {chosen[-1]}"
    if len(others) > 1 and tuple(chosen) == symbol.values[-len(chosen) :]:
        return f"{applied} >= {chosen[0]}"
    return ", ".join(f"{applied} != {value}" for value in others)


def print_condition(condition: Condition, symbols: Symbols) -> str:
    """Literals and quantified parts joined by commas."""
    return ", ".join(
        _quantified(part, symbols) if isinstance(part, Quantified) else print_literal(part, symbols)
        for part in condition
    )


def _quantified(part: Quantified, symbols: Symbols) -> str:
    if not part.variables:
        return f"({' or '.join(print_literal(_opposite(each, symbols), symbols) for each in part.condition)})"
    if part.forall:
        *guard, denied = part.condition
        asked = f"{_body(guard, symbols)} => " if guard else ""
        required = print_literal(_opposite(denied, symbols), symbols)
        return f"forall {_variables(part.variables)}: {asked}{required}"
    body = _body(part.condition, symbols)
    return f"{'' if part.exists else 'not '}exists {_variables(part.variables)}: {body}"


def _body(literals: Sequence[Literal | Equality], symbols: Symbols) -> str:
    """Literals behind the colon of a quantifier, in parentheses if there are several."""
    body = print_condition(tuple(literals), symbols)
    return f"({body})" if len(literals) > 1 else body


def _opposite(part: Literal | Equality, symbols: Symbols) -> Literal | Equality:
    if isinstance(part, Equality):
        return Equality(part.left, part.right, not part.equal)
    return part.opposite(symbols[part.symbol])


def print_outcome(outcome: Outcome, symbols: Symbols, say_fixed: bool = True) -> str:
    """`0.2 [prior 0.15, seen 3]: effects`; `say_fixed` unless the rule says it for all outcomes."""
    if outcome.parameter is not None:
        return f"{outcome.parameter}: {print_result(outcome, symbols)}"
    chance = "rest" if outcome.is_rest else print_fraction(outcome.probability)
    marks = _noted(_prior(outcome), outcome.seen, outcome.fixed and say_fixed)
    return f"{chance}{marks}: {print_result(outcome, symbols)}"


def _prior(stated: Outcome | Parameter) -> str:
    return "" if stated.prior is None else print_fraction(stated.prior)


def _noted(prior: str, seen: Fraction | None, fixed: bool) -> str:
    """What the learner noted of a number; an empty prior is none."""
    marks = [f"prior {prior}"] if prior else []
    marks += [] if seen is None else [f"seen {print_fraction(seen)}"]
    return _marks([*marks, "fixed"] if fixed else marks)


def _marks(marks: list[str]) -> str:
    return f" [{', '.join(marks)}]" if marks else ""


def print_result(outcome: Outcome, symbols: Symbols) -> str:
    """What happens in an outcome, without its probability."""
    if outcome.kind is not OutcomeKind.CHANGE:
        return str(outcome.kind.value)
    return ", ".join(
        [
            *(_effect(effect, symbols) for effect in outcome.effects),
            *print_payments(outcome.reward, outcome.cost),
        ]
    )


def print_payments(reward: Price, cost: Price) -> list[str]:
    """What an outcome pays, `reward += 5 + f(?a)` and `cost += 1/3`; only what is not 0."""
    return [
        f"{what} {sign} {print_price(part)}"
        for what, price in (("reward", reward), ("cost", cost))
        for sign, part in zip(("+=", "-="), price.by_sign(), strict=True)
        if part
    ]


def _effect(effect: Assign | Shift | ForAll, symbols: Symbols) -> str:
    if isinstance(effect, ForAll):
        condition = f": {print_condition(effect.condition, symbols)}" if effect.condition else ""
        effects = ", ".join(_effect(e, symbols) for e in effect.effects)
        effects = f"({effects})" if len(effect.effects) > 1 else effects
        every = (
            f"forall {_variables(effect.variables)}{condition}" if effect.variables else f"if{condition[1:]}"
        )
        return f"{every} => {effects}"
    applied = _applied(effect.symbol, effect.terms)
    if isinstance(effect, Shift):
        return f"{applied} {'+=' if effect.amount > 0 else '-='} {abs(effect.amount)}"
    if isinstance(effect.value, bool):
        return applied if effect.value else f"not {applied}"
    return f"{applied} := {effect.value}"


def _applied(symbol: str, terms: tuple[Term, ...]) -> str:
    return f"{symbol}({', '.join(print_term(term) for term in terms)})"


def _block(name: str, lines: list[str]) -> str:
    if not lines:
        return ""
    return f"  {name} {{\n" + "".join(f"    {line}\n" for line in lines) + "  }\n"


def _variables(variables: tuple[Variable, ...]) -> str:
    return " ".join(
        f"{' '.join(f'?{v.name}' for v in group)} - {type_name}"
        for type_name, group in groupby(variables, key=lambda v: v.type)
    )


def _types(types: tuple[Type, ...]) -> str:
    return "; ".join(t.name if t.parent is None else f"{t.name} - {t.parent}" for t in types)


def _objects(objects: tuple[Object, ...]) -> list[str]:
    return [
        f"{' '.join(o.name for o in group)} - {type_name}"
        for type_name, group in groupby(objects, key=lambda o: o.type)
    ]


def _predicate(symbol: Symbol) -> str:
    marks = (["symmetric"] if symbol.symmetric else []) + (["static"] if symbol.static else [])
    return f"{symbol.name}({_variables(symbol.parameters)}){_marks(marks)}"


def _function(symbol: Symbol) -> str:
    low, high = symbol.values[0], symbol.values[-1]
    values = f"{low}..{high}" if isinstance(low, int) else " < ".join(str(v) for v in symbol.values)
    return f"{symbol.name}({_variables(symbol.parameters)}): {values}{_marks(['static'] * symbol.static)}"


def _derived(definition: DerivedPredicate, symbols: Symbols) -> str:
    head = f"{definition.name}({_variables(definition.parameters)})"
    if definition.closure is not None:
        return f"{head} := closure {definition.closure}"
    return f"{head} := {print_condition(definition.condition, symbols)}"


def _parameter(parameter: Parameter) -> str:
    marks = _noted(_prior(parameter), parameter.seen, parameter.fixed)
    return f"{parameter.name} = {print_fraction(parameter.probability)}{marks}"


def print_reward(terms: Sequence[RewardTerm]) -> str:
    """The sum of its terms, `2 * decrease(dirty_areas) - cost`."""
    first, *others = terms
    shown = f"{'-' if first.weight < 0 else ''}{_reward_term(first)}"
    return shown + "".join(f" {'-' if t.weight < 0 else '+'} {_reward_term(t)}" for t in others)


def _reward_term(term: RewardTerm) -> str:
    """A term without its sign."""
    weight = "" if abs(term.weight) == 1 else f"{print_fraction(abs(term.weight))} * "
    match term.kind:
        case RewardKind.DECREASE:
            return f"{weight}decrease({term.count})"
        case RewardKind.COUNT:
            return f"{weight}{term.count}"
        case RewardKind.GOAL | RewardKind.COST | RewardKind.DURATION:
            return f"{weight}{term.kind.value}"


def _count(count: Count, symbols: Symbols) -> str:
    condition = print_condition(count.condition, symbols)
    return f"{count.name} := count {_variables(count.variables)}: {condition}"


def _action(action: Action) -> str:
    marks = [] if action.duration is None else [_duration(action, action.duration)]
    marks += [f"cost = {print_price(action.cost)}"] if action.cost else []
    return f"{action.name}({_variables(action.parameters)}){_marks(marks)}"


def print_price(price: Price) -> str:
    """`2`, or `2 + 0.5 * distance(?a, ?b)`; nothing in it is below 0."""
    constant = [print_fraction(price.number)] if price.number or not price.parts else []
    return " + ".join([*constant, *map(_price_part, price.parts)])


def _price_part(part: PricePart) -> str:
    weight = "" if part.weight == 1 else f"{print_fraction(part.weight)} * "
    return weight + _applied(part.symbol, part.terms)


def _duration(action: Action, seconds: float) -> str:
    """`duration = 5.8 s [prior 9 s, seen 12]`."""
    prior = "" if action.duration_prior is None else _seconds(action.duration_prior)
    noted = _noted(prior, action.duration_seen, action.duration_fixed)
    return f"duration = {_seconds(seconds)}{noted}"


def _seconds(duration: float) -> str:
    return f"{print_float(duration)} s"


def print_default(outcomes: Sequence[Outcome], symbols: Symbols) -> str:
    """The block of the default rule, with a line end; empty without outcomes."""
    return _block("default", [print_outcome(outcome, symbols) for outcome in outcomes])


def print_rule(rule: Rule, symbols: Symbols) -> str:
    """A rule as it stands in a domain, with a line end."""
    terms = ", ".join(f"?{variable.name}" for variable in rule.variables)
    when = f"    when {print_condition(rule.condition, symbols)}\n" if rule.condition else ""
    withs = "".join(f"    {print_reference(reference, symbols)}\n" for reference in rule.references)
    fixed = all(outcome.fixed for outcome in rule.outcomes)
    first, *others = (print_outcome(outcome, symbols, not fixed) for outcome in rule.outcomes)
    outcomes = f"    then {first}\n" + "".join(f"         {other}\n" for other in others)
    head = f"  rule {rule.name}: {rule.action}({terms}){_marks(['fixed'] * fixed)} {{\n"
    return f"{head}{when}{withs}{outcomes}  }}\n"


def print_reference(reference: Reference, symbols: Symbols) -> str:
    """`with ?m - area: p(?m)`."""
    return f"with {_variables(reference.variables)}: {print_condition(reference.condition, symbols)}"


def _planner(problem: Problem) -> list[str]:
    name = problem.planner
    if name is not None and not (name.isascii() and name.isidentifier()):
        name = f'"{name}"'
    settings = {"name": name, "samples": problem.samples, "seed": problem.seed}
    return [f"{key} = {value}" for key, value in settings.items() if value is not None]


def _horizon(horizon: Horizon | Unlimited) -> str:
    if isinstance(horizon, Unlimited):
        return "unlimited"
    if horizon.count is None:
        return str(horizon.constant)
    return horizon.count if horizon.constant == 0 else f"{horizon.constant} + {horizon.count}"
