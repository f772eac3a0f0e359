"""Checks terms, literals and conditions against what is declared."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from cleancli.language import syntax
from cleancli.language.checking.declarations import Declarations, read_variables, without_point
from cleancli.language.checking.literals import negated
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import (
    Condition,
    Equality,
    Literal,
    Object,
    Quantified,
    Symbol,
    Term,
    Value,
    Variable,
)
from cleancli.language.printing.printer import print_signature
from cleancli.language.record import Record

_SYMBOLS = ("predicate", "function", "derived predicate")
_EXISTS_LEFT = "put all that it is about in parentheses, `exists ?m - type: (p(?m), q(?m))`"
_EVERY_LEFT = "write a second `forall` for this literal"
_NO_COUNT = "say what holds instead, as in `not exists ?a - area: dirt(?a)`"


class Scope(Record):
    """What a name may mean at one place: everything declared, the objects, and the variables bound there.

    Where rules are `compat` they mean what libPRADA takes them for: those of an action may overlap, and what
    an outcome sets counts even if the condition asks for it. `left` holds the variables of quantifiers that
    ended before this place, with what to write by whoever believes them bound still.
    """

    declared: Declarations
    objects: Mapping[str, Object]
    variables: Mapping[str, Variable]
    findings: Findings
    compat: bool = False
    left: tuple[tuple[str, str], ...] = ()

    def with_variables(self, variables: tuple[Variable, ...]) -> Scope:
        """The scope inside a quantifier."""
        bound = {**self.variables, **{v.name: v for v in variables}}
        return Scope(self.declared, self.objects, bound, self.findings, self.compat, self.left)

    def behind(self, groups: Iterable[syntax.Group], way_out: str) -> Scope:
        """The scope behind a quantifier that bound these."""
        ended = tuple((name.text, way_out) for group in groups for name in group.names)
        return replace(self, left=(*self.left, *ended))


def resolve_term(node: syntax.TermNode, scope: Scope) -> Term | None:
    """The variable or object a term means; E204 or E205 where there is none."""
    return _bound_variable(node, scope) if node.is_variable else _known_object(node, scope)


def _bound_variable(node: syntax.TermNode, scope: Scope) -> Variable | None:
    variable = scope.variables.get(node.name)
    if variable is None:
        help = scope.findings.meant(f"?{node.name}", [f"?{v}" for v in scope.variables], "variable")
        if way_out := dict(scope.left).get(node.name):
            help = f"the quantifier that binds it ended at the comma before: {way_out}"
        scope.findings.error("E204", f"the variable `?{node.name}` is not bound", node.span, help=help)
    return variable


def _known_object(node: syntax.TermNode, scope: Scope) -> Object | None:
    found = scope.objects.get(node.name)
    scope.findings.use("constant", node.name)
    if found is not None or {"constants", "objects"} & scope.declared.unsure:
        return found
    if node.name in scope.variables:
        help = f"did you mean the variable `?{node.name}`?"
        scope.findings.error("E205", f"unknown object `{node.name}`", node.span, help=help)
    elif node.name in scope.declared.symbols:
        help = f"a predicate or function has its parentheses: `{node.name}(...)`"
        scope.findings.error("E205", f"unknown object `{node.name}`", node.span, help=help)
    else:
        scope.findings.unknown("E205", "object", node.name, node.span, scope.objects)
    return None


def resolve_application(node: syntax.Application, scope: Scope) -> tuple[Symbol, tuple[Term, ...]] | None:
    """The symbol and terms of an application; None after a mistake (E203 to E205, E208, E209)."""
    name = node.symbol.text
    symbol = scope.declared.symbols.get(name)
    terms = [resolve_term(term, scope) for term in node.terms]
    scope.findings.use("symbol", name)
    if symbol is None:
        _unknown_symbol(node, scope)
        return None
    if scope.findings.unclear and any((what, name) in scope.findings.unclear for what in _SYMBOLS):
        return None
    if len(terms) != len(symbol.parameters):
        wants = len(symbol.parameters)
        scope.findings.error(
            "E208",
            f"`{name}` takes {plural(wants, 'term')}, not {len(terms)}",
            node.span,
            help=f"it is declared as `{print_signature(name, symbol.parameters)}`",
        )
        return None
    fit = [
        term is None or term.type == parameter.type or _fits(term, parameter, place, name, scope)
        for term, parameter, place in zip(terms, symbol.parameters, node.terms, strict=True)
    ]
    known = tuple([term for term in terms if term is not None])
    return (symbol, known) if all(fit) and len(known) == len(terms) else None


def _unknown_symbol(node: syntax.Application, scope: Scope) -> None:
    what, name = "predicate or function", node.symbol
    if name.text in scope.declared.counts and not node.terms:
        help = "counts are for rewards and horizons only: say what holds instead"
        scope.findings.error("E203", f"`{name.text}` is a count, no {what}", name.span, help=help)
    elif not {"predicates", "functions", "derived"} & scope.declared.unsure:
        scope.findings.unknown("E203", what, name.text, name.span, scope.declared.symbols)


def _fits(term: Term, parameter: Variable, place: syntax.TermNode, name: str, scope: Scope) -> bool:
    if "types" in scope.declared.unsure or scope.declared.is_a(term.type, parameter.type):
        return True
    shown = f"?{term.name}" if isinstance(term, Variable) else term.name
    scope.findings.error(
        "E209", f"`{shown}` is of type `{term.type}`, `{name}` wants `{parameter.type}`", place.span
    )
    return False


def resolve_value(
    node: syntax.Name | syntax.Number, symbol: Symbol, scope: Scope, instead: str = ""
) -> Value | None:
    """A value of a function; E210 for an unknown one. `instead`: what to write in place of a count."""
    value: Value | None = node.text if isinstance(node, syntax.Name) else _integer(node)
    if value is not None and value in symbol.values:
        return value
    shown = _shown_number(node) if isinstance(node, syntax.Number) else node.text
    if shown in scope.declared.counts:
        meant = instead or f"the values of `{symbol.name}` are {shown_values(symbol)}"
        help = f"`{shown}` is a count, and counts are for rewards and horizons only: {meant}"
    elif isinstance(node, syntax.Number):
        help = (is_integer(symbol) and without_point(node)) or f"its values are {shown_values(symbol)}"
    elif is_integer(symbol):
        help = f"its values are {shown_values(symbol)}"
    else:
        help = scope.findings.meant(shown, map(str, symbol.values), "value")
    scope.findings.error("E210", f"`{symbol.name}` has no value `{shown}`", node.span, help=help)
    return None


def _integer(node: syntax.Number) -> int | None:
    return int(node.value) if node.is_whole else None


def _shown_number(node: syntax.Number) -> str:
    """A number as messages show it: `5.0` with its point, because that is what is wrong with it."""
    if node.is_whole:
        return str(int(node.value))
    return f"{float(node.value):g}{'.0' if without_point(node) else ''}"


def is_integer(symbol: Symbol) -> bool:
    """Whether a function has integers as values, not names."""
    return type(symbol.values[0]) is int


def shown_values(symbol: Symbol) -> str:
    """`small < medium < big` or `0..10`."""
    if is_integer(symbol):
        return f"{symbol.values[0]}..{symbol.values[-1]}"
    return " < ".join(str(value) for value in symbol.values)


def wants_function(symbol: Symbol, node: syntax.Node, scope: Scope) -> bool:
    """Whether a symbol that is given a value is a function; E211 where not."""
    if symbol.is_predicate:
        scope.findings.error(
            "E211",
            f"`{symbol.name}` is a predicate and has no values",
            node.span,
            help=f"write `{symbol.name}(...)` or `not {symbol.name}(...)`",
        )
    return not symbol.is_predicate


def wants_predicate(symbol: Symbol, node: syntax.Node, scope: Scope, sign: str = "=") -> bool:
    """Whether a symbol that stands without a value is a predicate; E211 where not."""
    if not symbol.is_predicate:
        scope.findings.error(
            "E211",
            f"`{symbol.name}` is a function and needs a value",
            node.span,
            help=f"write `{symbol.name}(...) {sign} {symbol.values[0]}`",
        )
    return symbol.is_predicate


def _compared(symbol: Symbol, relation: str, value: Value) -> frozenset[Value]:
    at = symbol.values.index(value)
    chosen = {
        "=": symbol.values[at : at + 1],
        "!=": symbol.values[:at] + symbol.values[at + 1 :],
        "<": symbol.values[:at],
        "<=": symbol.values[: at + 1],
        ">": symbol.values[at + 1 :],
        ">=": symbol.values[at:],
    }
    return frozenset(chosen[relation])


def _comparison(node: syntax.Comparison, scope: Scope) -> Literal | None:
    resolved = resolve_application(node.application, scope)
    if resolved is None or not wants_function(resolved[0], node, scope):
        return None
    symbol, terms = resolved
    value = resolve_value(node.value, symbol, scope, _NO_COUNT)
    if value is None:
        return None
    values = _compared(symbol, node.relation, value)
    if len(symbol.values) > 1 and len(values) in (0, len(symbol.values)):
        truth = "always" if values else "never"
        help = f"the values of `{symbol.name}` are {shown_values(symbol)}"
        scope.findings.error("E306", f"this {truth} holds", node.span, help=help)
        return None
    return Literal(symbol.name, terms, values, node.relation)


def _truth(node: syntax.Truth, scope: Scope) -> Literal | None:
    resolved = resolve_application(node.application, scope)
    if resolved is None or not wants_predicate(resolved[0], node, scope, "=" if node.positive else "!="):
        return None
    return Literal(resolved[0].name, resolved[1], frozenset({node.positive}))


def _equality(node: syntax.EqualityNode, scope: Scope) -> Equality | None:
    left, right = resolve_term(node.left, scope), resolve_term(node.right, scope)
    if left is None or right is None:
        return None
    same = left == right
    apart = scope.declared.meet(left.type, right.type) is None or (
        isinstance(left, Object) and isinstance(right, Object) and not same
    )
    if same or apart:
        truth = "always" if node.equal == same else "never"
        why = "both terms are the same" if same else "the two terms cannot be one object"
        scope.findings.error("E306", f"this {truth} holds", node.span, help=why)
        return None
    return Equality(left, right, node.equal)


def check_condition(node: syntax.ConditionNode | None, scope: Scope) -> Condition:
    """The parts of a conjunction that are right, in order."""
    checked = []
    for item in node.parts if node is not None else ():
        checked.append(_part(item, scope))
        if isinstance(item, syntax.ExistsNode | syntax.EveryNode):
            is_exists = isinstance(item, syntax.ExistsNode)
            scope = scope.behind(item.groups, _EXISTS_LEFT if is_exists else _EVERY_LEFT)
    return tuple(part for part in checked if part is not None)


def check_literals(nodes: Iterable[syntax.PartNode], scope: Scope) -> tuple[Literal | Equality, ...]:
    """The literals that are right, in order, where the grammar lets nothing else stand."""
    checked = [_part(node, scope) for node in nodes]
    return tuple(part for part in checked if isinstance(part, Literal | Equality))


def _part(node: syntax.PartNode, scope: Scope) -> Literal | Equality | Quantified | None:
    match node:
        case syntax.Truth():
            return _truth(node, scope)
        case syntax.Comparison():
            return _comparison(node, scope)
        case syntax.EqualityNode():
            return _equality(node, scope)
        case syntax.EitherNode():
            return _either(node, scope)
        case syntax.ExistsNode():
            return _exists(node, scope)
        case syntax.EveryNode():
            return _every(node, scope)


def _either(node: syntax.EitherNode, scope: Scope) -> Quantified | None:
    """That one of several literals holds is that the one binding of no variables has not all opposites."""
    literals = check_literals(node.literals, scope)
    if len(literals) != len(node.literals):
        return None
    opposites = tuple(negated(each, scope.declared) for each in literals)
    if any(each in opposites for each in literals):
        help = "two of these say the opposite of each other"
        scope.findings.error("E306", "this always holds", node.span, help=help)
        return None
    return Quantified(False, (), opposites)


def _exists(node: syntax.ExistsNode, scope: Scope) -> Quantified | None:
    variables, inner = bind_variables(node.groups, "exists", "?m - type: literal", node.span, scope)
    literals = check_literals(node.literals, inner)
    if not variables or len(literals) != len(node.literals):
        return None
    warn_unused_variables(node.groups, literals, scope)
    return Quantified(node.positive, variables, literals)


def _every(node: syntax.EveryNode, scope: Scope) -> Quantified | None:
    """That every binding has the literal is that none has the opposite (`model.Quantified`)."""
    variables, inner = bind_variables(node.groups, "forall", "?m - type: literal", node.span, scope)
    guard = check_literals(node.guard, inner)
    literals = check_literals((node.literal,), inner)
    if not variables or len(guard) != len(node.guard) or not literals:
        return None
    parts = (*guard, negated(literals[0], scope.declared))
    warn_unused_variables(node.groups, parts, scope)
    return Quantified(False, variables, parts, forall=True)


def bind_variables(
    groups: tuple[syntax.Group, ...], word: str, rest: str, span: Span, scope: Scope
) -> tuple[tuple[Variable, ...], Scope]:
    """The variables of a quantifier and the scope inside it; E218 for none, E202 where one hides another."""
    variables = read_variables(groups, scope.declared, scope.findings)
    for name in (name for group in groups for name in group.names):
        if name.text in scope.variables:
            message = f"`?{name.text}` is already a variable of the rule"
            scope.findings.error("E202", message, name.span, help="choose another name")
        warn_shadow(name.text, name.span, scope)
    if not variables:
        message = f"`{word}` needs a variable"
        scope.findings.error("E218", message, span, help=f"write `{word} {rest}`")
    return variables, scope.with_variables(variables)


def warn_shadow(name: str, span: Span, scope: Scope) -> None:
    """W204 for a variable that is easily taken for a constant."""
    if name in scope.declared.constants:
        scope.findings.warning(
            "W204",
            f"the variable `?{name}` has the name of a constant",
            span,
            help="choose another name: without the question mark it would mean the constant",
        )


def warn_unused_variables(
    groups: Iterable[syntax.Group], condition: Condition, scope: Scope, elsewhere: Iterable[Term] = ()
) -> None:
    """W202 for bound variables that neither the condition nor the terms `elsewhere` mention."""
    used = {term.name for term in (*terms_of(condition), *elsewhere) if isinstance(term, Variable)}
    for name in (name for group in groups for name in group.names):
        if name.text not in used:
            scope.findings.warning(
                "W202", f"the variable `?{name.text}` is never used", name.span, help="leave it out"
            )


def terms_of(condition: Condition) -> Iterator[Term]:
    """Every term that a condition mentions."""
    for part in condition:
        match part:
            case Literal():
                yield from part.terms
            case Equality():
                yield from (part.left, part.right)
            case Quantified():
                yield from terms_of(part.condition)
