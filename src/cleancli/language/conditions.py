"""The second half of the check: terms, literals, conditions and effects against what is declared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from cleancli.language import syntax
from cleancli.language.declarations import Declarations, read_variables
from cleancli.language.findings import Findings, meant
from cleancli.language.model import (
    Assign,
    Condition,
    Equality,
    ForAll,
    Literal,
    Object,
    Symbol,
    Term,
    Value,
    Variable,
)


@dataclass(frozen=True, slots=True)
class Scope:
    """What a name may mean at one place: everything declared, the objects, and the variables bound there."""

    declared: Declarations
    objects: Mapping[str, Object]
    variables: Mapping[str, Variable]
    findings: Findings

    def with_variables(self, variables: tuple[Variable, ...]) -> Scope:
        """The scope inside a quantifier."""
        bound = {**self.variables, **{v.name: v for v in variables}}
        return Scope(self.declared, self.objects, bound, self.findings)


def resolve_term(node: syntax.TermNode, scope: Scope) -> Term | None:
    """The variable or object a term means; E204 or E205 where there is none."""
    if node.is_variable:
        variable = scope.variables.get(node.name)
        if variable is None:
            message = f"the variable `?{node.name}` is not bound"
            help = meant(f"?{node.name}", [f"?{v}" for v in scope.variables], "variable")
            scope.findings.error("E204", message, node.span, help=help)
        return variable
    found = scope.objects.get(node.name)
    if found is None and "constants" not in scope.declared.unsure and "objects" not in scope.declared.unsure:
        if node.name in scope.variables:
            scope.findings.error(
                "E205",
                f"unknown object `{node.name}`",
                node.span,
                help=f"did you mean the variable `?{node.name}`?",
            )
        else:
            scope.findings.unknown("E205", "object", node.name, node.span, scope.objects)
    return found


def resolve_application(node: syntax.Application, scope: Scope) -> tuple[Symbol, tuple[Term, ...]] | None:
    """The symbol and terms of an application; None after a mistake (E203 to E205, E208, E209)."""
    name = node.symbol.text
    symbol = scope.declared.symbols.get(name)
    terms = [resolve_term(term, scope) for term in node.terms]
    if symbol is None:
        if not {"predicates", "functions"} & scope.declared.unsure:
            what = "predicate or function"
            scope.findings.unknown("E203", what, name, node.symbol.span, scope.declared.symbols)
        return None
    if len(terms) != len(symbol.parameters):
        wants = len(symbol.parameters)
        scope.findings.error(
            "E208",
            f"`{name}` takes {wants} term{'s' * (wants != 1)}, not {len(terms)}",
            node.span,
            help=f"it is declared as `{signature(symbol)}`",
        )
        return None
    fit = [
        _fits(term, parameter, place, name, scope)
        for term, parameter, place in zip(terms, symbol.parameters, node.terms, strict=True)
    ]
    known = tuple(term for term in terms if term is not None)
    return (symbol, known) if all(fit) and len(known) == len(terms) else None


def signature(symbol: Symbol) -> str:
    """`near(?a - area, ?b - area)`."""
    return f"{symbol.name}({', '.join(f'?{p.name} - {p.type}' for p in symbol.parameters)})"


def _fits(term: Term | None, parameter: Variable, place: syntax.TermNode, name: str, scope: Scope) -> bool:
    if term is None or "types" in scope.declared.unsure or scope.declared.is_a(term.type, parameter.type):
        return True
    shown = f"?{term.name}" if isinstance(term, Variable) else term.name
    scope.findings.error(
        "E209", f"`{shown}` is of type `{term.type}`, `{name}` wants `{parameter.type}`", place.span
    )
    return False


def resolve_value(name: syntax.Name, symbol: Symbol, scope: Scope) -> Value | None:
    """A value of a function; E210 for an unknown one."""
    if name.text in symbol.values:
        return name.text
    values = [str(v) for v in symbol.values]
    help = meant(name.text, values, "value")
    scope.findings.error("E210", f"`{symbol.name}` has no value `{name.text}`", name.span, help=help)
    return None


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
    value = resolve_value(node.value, symbol, scope)
    if value is None:
        return None
    values = _compared(symbol, node.relation, value)
    if len(symbol.values) > 1 and len(values) in (0, len(symbol.values)):
        truth = "always" if values else "never"
        order = " < ".join(str(v) for v in symbol.values)
        scope.findings.error(
            "E306", f"this {truth} holds", node.span, help=f"the values of `{symbol.name}` are {order}"
        )
        return None
    return Literal(symbol.name, terms, values)


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
    """The literals of a conjunction that are right, in order."""
    literals: list[Literal | Equality] = []
    for item in node.literals if node is not None else ():
        match item:
            case syntax.Truth():
                literal: Literal | Equality | None = _truth(item, scope)
            case syntax.Comparison():
                literal = _comparison(item, scope)
            case syntax.EqualityNode():
                literal = _equality(item, scope)
        if literal is not None:
            literals.append(literal)
    return tuple(literals)


def check_assignment(node: syntax.Assignment, scope: Scope) -> Assign | None:
    """One effect on one symbol."""
    resolved = resolve_application(node.application, scope)
    if resolved is None:
        return None
    symbol, terms = resolved
    if isinstance(node, syntax.SetTruth):
        return Assign(symbol.name, terms, node.value) if wants_predicate(symbol, node, scope, ":=") else None
    if not wants_function(symbol, node, scope):
        return None
    value = resolve_value(node.value, symbol, scope)
    return None if value is None else Assign(symbol.name, terms, value)


def check_forall(node: syntax.ForAllNode, scope: Scope) -> ForAll | None:
    """A quantified effect; its variables may not hide others (E202)."""
    variables = read_variables(node.groups, scope.declared, scope.findings)
    for group in node.groups:
        for name in group.names:
            if name.text in scope.variables:
                scope.findings.error(
                    "E202",
                    f"`?{name.text}` is already a variable of the rule",
                    name.span,
                    help="choose another name",
                )
    if not variables:
        scope.findings.error(
            "E218",
            "`forall` needs a variable",
            node.span,
            help="write `forall ?m - type: condition => effect`",
        )
    inner = scope.with_variables(variables)
    condition = check_condition(node.condition, inner)
    effects = tuple(e for e in (check_assignment(item, inner) for item in node.effects) if e is not None)
    return ForAll(variables, condition, effects)
