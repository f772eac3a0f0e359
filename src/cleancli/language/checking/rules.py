"""The check of rules: their outcomes, probabilities and conditions, and that no two of an action overlap."""

from __future__ import annotations

from cleancli.language import syntax
from cleancli.language.checking.conditions import (
    Scope,
    bind_variables,
    check_condition,
    check_literals,
    terms_of,
    warn_shadow,
    warn_unused_variables,
)
from cleancli.language.checking.declarations import Once, sections_of
from cleancli.language.checking.exclusivity import refuse_overlaps, refuse_unsatisfiable
from cleancli.language.checking.outcomes import check_outcomes
from cleancli.language.checking.symbols import read_marks
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import Action, Assign, ForAll, Outcome, Reference, Rule, Shift, Term, Variable
from cleancli.language.printing.printer import print_signature


def check_rules(node: syntax.DomainNode, scope: Scope) -> tuple[Rule, ...]:
    """All rules of a domain, in order; mistakes are E2xx and E301 to E311."""
    once = Once(scope.findings)
    checked = []
    for item in sections_of(node.sections, syntax.RuleNode):
        once.admits(item.name, "rule")
        rule = _rule(item, scope)
        if rule is not None:
            checked.append(rule)
    if not scope.compat:
        refuse_overlaps(checked, scope)
    return tuple(checked)


def _rule(node: syntax.RuleNode, scope: Scope) -> Rule | None:
    action = _action(node, scope)
    if action is None:
        return None
    variables = _variables(node, action, scope)
    fixed = "fixed" in read_marks(node.attributes, ("fixed",), scope.findings)
    before = scope.findings.errors
    inner = scope.with_variables(variables)
    condition = check_condition(node.condition, inner)
    references, inner = _references(node, inner)
    complete = scope.findings.errors == before and len(condition) == (
        0 if node.condition is None else len(node.condition.parts)
    )
    outcomes = check_outcomes(node.outcomes, node.name.span, inner, condition, fixed)
    if not len(variables) == len(node.terms) == len(action.parameters) or not complete:
        return None
    _warn_unused_references(node, references, outcomes, scope)
    rule = Rule(node.name.text, action.name, variables, condition, outcomes, references, span=node.name.span)
    place = node.condition.span if node.condition is not None else node.span
    refuse_unsatisfiable(rule, place, scope)
    return rule


def _references(node: syntax.RuleNode, scope: Scope) -> tuple[tuple[Reference, ...], Scope]:
    """The deictic references in order, and the scope with their variables: each may use those before it."""
    references = []
    for item in node.references:
        variables, scope = bind_variables(item.groups, "with", "?m - type: condition", item.span, scope)
        references.append(Reference(variables, check_literals(item.condition.parts, scope)))
    return tuple(references), scope


def _warn_unused_references(
    node: syntax.RuleNode, references: tuple[Reference, ...], outcomes: tuple[Outcome, ...], scope: Scope
) -> None:
    if not references:
        return
    used = [term for outcome in outcomes for effect in outcome.effects for term in _effect_terms(effect)]
    used += [term for reference in references for term in terms_of(reference.condition)]
    for item in node.references:
        warn_unused_variables(item.groups, (), scope, used)


def _effect_terms(effect: Assign | Shift | ForAll) -> tuple[Term, ...]:
    if isinstance(effect, ForAll):
        return (*terms_of(effect.condition), *(t for inner in effect.effects for t in inner.terms))
    return effect.terms


def _action(node: syntax.RuleNode, scope: Scope) -> Action | None:
    action = scope.declared.actions.get(node.action.text)
    scope.findings.use("action", node.action.text)
    if action is None and "actions" not in scope.declared.unsure:
        scope.findings.unknown("E206", "action", node.action.text, node.action.span, scope.declared.actions)
    if ("action", node.action.text) in scope.findings.unclear:
        return None
    if action is not None and len(action.parameters) != len(node.terms):
        wants = len(action.parameters)
        scope.findings.error(
            "E208",
            f"`{action.name}` takes {plural(wants, 'variable')}, not {len(node.terms)}",
            Span(node.span.path, node.action.span.start, (node.terms or (node.action,))[-1].span.end),
            help=f"it is declared as `{print_signature(action.name, action.parameters)}`",
        )
        return action if len(node.terms) > wants else None  # what it lacks is bound nowhere in the rule
    return action


def _variables(node: syntax.RuleNode, action: Action, scope: Scope) -> tuple[Variable, ...]:
    """The variables of a rule's head; of unknown types, which fit everywhere, where it has too many."""
    is_whole = len(node.terms) == len(action.parameters)
    types = [each.type for each in action.parameters] if is_whole else [""] * len(node.terms)
    variables: dict[str, Variable] = {}
    for term, kind in zip(node.terms, types, strict=True):
        if not term.is_variable:
            scope.findings.error(
                "E204",
                f"`{term.name}` is not a variable",
                term.span,
                help=f"write `?{term.name}`, or a condition such as `?x = {term.name}`",
            )
        elif term.name in variables:
            scope.findings.error(
                "E202",
                f"the variable `?{term.name}` stands here twice",
                term.span,
                help="give it a name of its own and compare the two in the condition",
            )
        else:
            warn_shadow(term.name, term.span, scope)
        variables[term.name] = Variable(term.name, kind)
    return tuple(variables.values())
