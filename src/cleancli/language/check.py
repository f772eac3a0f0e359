"""From syntax to the checked model of a domain; every mistake is found, not only the first.

Guaranteed by the parser: structure. Sections that could not be read are left out of the tree, and what may
have been declared there is not reported as unknown.
"""

from __future__ import annotations

from fractions import Fraction

from cleancli.language import syntax
from cleancli.language.conditions import Scope, check_condition
from cleancli.language.declarations import Declarations, Once, declare, read_variables, sections_of
from cleancli.language.findings import Findings
from cleancli.language.model import Count, Domain, Outcome, OutcomeKind, RewardKind, RewardTerm
from cleancli.language.rules import check_default, check_rules, known_counts


def check_domain(node: syntax.DomainNode, findings: Findings) -> Domain:
    """The model of a domain; it may only be used if `findings` holds no error."""
    declared = declare(node, findings)
    scope = Scope(declared, declared.constants, {}, findings)
    counts = _counts(node, scope)
    rules = check_rules(node, scope)
    default = _default(node, scope)
    return Domain(
        node.name.text,
        tuple(declared.types.values()),
        tuple(declared.constants.values()),
        tuple(declared.symbols.values()),
        counts,
        tuple(declared.actions.values()),
        rules,
        default,
        _reward(node, counts, scope),
    )


def scope_of(domain: Domain, findings: Findings) -> Scope:
    """The scope in which a problem of the domain is read."""
    declared = Declarations(
        {t.name: t for t in domain.types},
        {o.name: o for o in domain.constants},
        {s.name: s for s in domain.symbols},
        {a.name: a for a in domain.actions},
        findings.broken,
    )
    return Scope(declared, declared.constants, {}, findings)


def _counts(node: syntax.DomainNode, scope: Scope) -> tuple[Count, ...]:
    once = Once(scope.findings)
    counts = []
    for section in sections_of(node.sections, syntax.Derived):
        for item in section.counts:
            variables = read_variables(item.parameters, scope.declared, scope.findings)
            if not variables:
                scope.findings.error(
                    "E218",
                    "`count` needs a variable",
                    item.span,
                    help="write `name := count ?a - type: condition`",
                )
            condition = check_condition(item.condition, scope.with_variables(variables))
            if item.name.text in scope.declared.symbols:
                scope.findings.error(
                    "E202",
                    f"`{item.name.text}` is already a predicate or function",
                    item.name.span,
                    help="choose another name",
                )
            elif once.admits(item.name, "count"):
                counts.append(Count(item.name.text, variables, condition))
    return tuple(counts)


def _default(node: syntax.DomainNode, scope: Scope) -> tuple[Outcome, ...]:
    """Without a default block, an action that no rule covers does nothing."""
    for section in sections_of(node.sections, syntax.Default):
        return check_default(section, section.outcomes[0].weight.chance.span, scope)
    return (Outcome(Fraction(1), OutcomeKind.NOTHING),)


def _reward(node: syntax.DomainNode, counts: tuple[Count, ...], scope: Scope) -> tuple[RewardTerm, ...]:
    for section in sections_of(node.sections, syntax.Reward):
        known_counts([count.name for count in counts], section.count, scope)
        return (RewardTerm(Fraction(1), RewardKind.DECREASE, section.count.text),)
    if "reward" not in scope.declared.unsure:
        scope.findings.error(
            "E219",
            f"the domain `{node.name.text}` has no reward",
            node.name.span,
            help="add for example `reward { decrease(dirty_areas) }`",
        )
    return ()
