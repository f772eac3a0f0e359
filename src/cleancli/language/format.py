"""The model as text in one canonical layout, so that reading what was printed gives the same model.

Guaranteed by the checker: names are declared and types fit. Comments and layout of a file are not known here;
a change to a user's file goes through `edit`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from decimal import Decimal
from fractions import Fraction
from itertools import groupby

from cleancli.language.model import (
    Action,
    Assign,
    Condition,
    Count,
    Domain,
    Equality,
    Fact,
    ForAll,
    Horizon,
    Literal,
    Object,
    Outcome,
    OutcomeKind,
    Problem,
    Rule,
    Symbol,
    Term,
    Type,
    Variable,
)

Symbols = Mapping[str, Symbol]


def print_domain(domain: Domain) -> str:
    """A domain as a .nid text."""
    symbols = {symbol.name: symbol for symbol in domain.symbols}
    predicates = [_predicate(s) for s in domain.symbols if s.is_predicate]
    functions = [_function(s) for s in domain.symbols if not s.is_predicate]
    blocks = [
        _block("types", [_types(domain.types)] if domain.types else []),
        _block("constants", _objects(domain.constants)),
        _block("predicates", predicates),
        _block("functions", functions),
        _block("derived", [_count(count, symbols) for count in domain.counts]),
        _block("actions", [_action(action) for action in domain.actions]),
        *(_rule(rule, symbols) for rule in domain.rules),
        _block("default", [print_outcome(outcome, symbols) for outcome in domain.default]),
        _block("reward", [f"decrease({domain.reward[0].count})"]),
    ]
    return f"domain {domain.name} {{\n" + "\n".join(block for block in blocks if block) + "}\n"


def print_problem(problem: Problem) -> str:
    """A problem as a .nid text; facts are sorted."""
    lines = [f"  domain = {problem.domain}\n"]
    lines.append(_block("objects", _objects(problem.objects)))
    lines.append(_block("init", [print_fact(fact) for fact in sorted_facts(problem.state)]))
    if problem.horizon is not None:
        lines.append(f"  horizon = {_horizon(problem.horizon)}\n")
    lines.append(f"  discount = {print_float(problem.discount)}\n")
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


def print_literal(part: Literal | Equality, symbols: Symbols) -> str:
    """A literal; a set of values that no relation describes becomes several, joined by commas."""
    if isinstance(part, Equality):
        return f"{print_term(part.left)} {'=' if part.equal else '!='} {print_term(part.right)}"
    applied = _applied(part.symbol, part.terms)
    symbol = symbols[part.symbol]
    if symbol.is_predicate:
        return applied if True in part.values else f"not {applied}"
    chosen = [v for v in symbol.values if v in part.values]
    others = [v for v in symbol.values if v not in part.values]
    if len(chosen) == 1:
        return f"{applied} = {chosen[0]}"
    if len(others) > 1 and tuple(chosen) == symbol.values[: len(chosen)]:
        return f"{applied} <= {chosen[-1]}"
    if len(others) > 1 and tuple(chosen) == symbol.values[-len(chosen) :]:
        return f"{applied} >= {chosen[0]}"
    return ", ".join(f"{applied} != {value}" for value in others)


def print_condition(condition: Condition, symbols: Symbols) -> str:
    """Literals joined by commas."""
    return ", ".join(print_literal(part, symbols) for part in condition)


def print_outcome(outcome: Outcome, symbols: Symbols) -> str:
    """`0.2 [prior 0.15, seen 3]: effects`."""
    chance = "rest" if outcome.is_rest else print_fraction(outcome.probability)
    marks = [] if outcome.prior is None else [f"prior {print_fraction(outcome.prior)}"]
    marks += [] if outcome.seen is None else [f"seen {outcome.seen}"]
    noted = f" [{', '.join(marks)}]" if marks else ""
    return f"{chance}{noted}: {print_result(outcome, symbols)}"


def print_result(outcome: Outcome, symbols: Symbols) -> str:
    """What happens in an outcome, without its probability."""
    if outcome.kind is not OutcomeKind.CHANGE:
        return str(outcome.kind.value)
    return ", ".join(_effect(effect, symbols) for effect in outcome.effects)


def _effect(effect: Assign | ForAll, symbols: Symbols) -> str:
    if isinstance(effect, ForAll):
        condition = f": {print_condition(effect.condition, symbols)}" if effect.condition else ""
        effects = ", ".join(_effect(e, symbols) for e in effect.effects)
        effects = f"({effects})" if len(effect.effects) > 1 else effects
        return f"forall {_variables(effect.variables)}{condition} => {effects}"
    applied = _applied(effect.symbol, effect.terms)
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
    return f"{symbol.name}({_variables(symbol.parameters)})" + (" [symmetric]" if symbol.symmetric else "")


def _function(symbol: Symbol) -> str:
    return f"{symbol.name}({_variables(symbol.parameters)}): {' < '.join(str(v) for v in symbol.values)}"


def _count(count: Count, symbols: Symbols) -> str:
    condition = print_condition(count.condition, symbols)
    return f"{count.name} := count {_variables(count.variables)}: {condition}"


def _action(action: Action) -> str:
    duration = "" if action.duration is None else f" [duration = {print_float(action.duration)} s]"
    return f"{action.name}({_variables(action.parameters)}){duration}"


def _rule(rule: Rule, symbols: Symbols) -> str:
    terms = ", ".join(f"?{variable.name}" for variable in rule.variables)
    when = f"    when {print_condition(rule.condition, symbols)}\n" if rule.condition else ""
    first, *others = (print_outcome(outcome, symbols) for outcome in rule.outcomes)
    outcomes = f"    then {first}\n" + "".join(f"         {other}\n" for other in others)
    return f"  rule {rule.name}: {rule.action}({terms}) {{\n{when}{outcomes}  }}\n"


def _horizon(horizon: Horizon) -> str:
    if horizon.count is None:
        return str(horizon.constant)
    return horizon.count if horizon.constant == 0 else f"{horizon.constant} + {horizon.count}"
