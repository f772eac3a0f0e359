"""From syntax to the checked model of a domain; every mistake is found, not only the first.

Guaranteed by the parser: structure. Sections that could not be read are left out of the tree, and what may
have been declared there is not reported as unknown. Included files are in the tree already.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from fractions import Fraction

from cleancli.language import syntax
from cleancli.language.checking.conditions import Scope
from cleancli.language.checking.costs import with_prices
from cleancli.language.checking.declarations import Declarations, Once, read_objects, read_types, sections_of
from cleancli.language.checking.derived import (
    as_symbols,
    check_counts,
    check_derived,
    names_of_counts,
    read_derived,
)
from cleancli.language.checking.learned import check_learned
from cleancli.language.checking.outcomes import check_default, check_parameters
from cleancli.language.checking.rules import check_rules
from cleancli.language.checking.symbols import read_actions, read_symbols
from cleancli.language.checking.unused import warn_unused
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import (
    Count,
    DerivedPredicate,
    Domain,
    Knowledge,
    Outcome,
    OutcomeKind,
    RewardKind,
    RewardTerm,
)


def check_domain(node: syntax.DomainNode, findings: Findings, compat: bool = False) -> Domain:
    """The model of a domain; it may only be used if `findings` holds no error. `compat`: see
    `Scope`."""
    declared = _declare(node, findings)
    scope = Scope(declared, declared.constants, {}, findings, compat)
    declared = replace(declared, parameters=check_parameters(node, scope))
    derived = _derived(node, replace(scope, declared=declared))
    declared = replace(declared, derived=derived)
    scope = replace(scope, declared=declared)
    declared = replace(declared, actions=with_prices(node, scope))
    scope = replace(scope, declared=declared)
    counts = check_counts(node, scope)
    rules = check_rules(node, scope)
    domain = Domain(
        node.name.text,
        tuple(declared.types.values()),
        tuple(declared.constants.values()),
        tuple(s for s in declared.symbols.values() if s.name not in derived),
        counts,
        tuple(declared.actions.values()),
        rules,
        _default(node, scope),
        _reward(node, counts, scope),
        tuple(derived.values()),
        tuple(declared.parameters.values()),
        _learned(node, findings),
        Span(node.span.path, node.span.end - 1, node.span.end - 1),
    )
    warn_unused(node, findings)
    return domain


def _declare(node: syntax.DomainNode, findings: Findings) -> Declarations:
    """Everything that has a name, but the definitions of what is derived and the parameters' values."""
    declared = read_types(node, findings)
    groups = [group for s in sections_of(node.sections, syntax.Constants) for group in s.groups]
    constants = read_objects(groups, declared, Once(findings), "constant", findings)
    once = Once(findings)
    symbols = read_symbols(node, declared, once, findings)
    derived = read_derived(node, declared, once, findings)
    return replace(
        declared,
        constants=constants,
        symbols=symbols | as_symbols(derived.values()),
        actions=read_actions(node, declared, findings),
        derived=derived,
        counts=frozenset(name.text for name in names_of_counts(node)),
    )


def _derived(node: syntax.DomainNode, scope: Scope) -> dict[str, DerivedPredicate]:
    before = scope.findings.errors
    derived = check_derived(node, scope)
    if scope.findings.errors > before:
        # What a wrong definition says is not known: nothing may follow from it in the checks of rules.
        return {name: replace(d, closure=name) for name, d in derived.items()}
    return derived


def scope_of(domain: Domain, findings: Findings) -> Scope:
    """The scope in which a problem of the domain is read."""
    declared = Declarations(
        {t.name: t for t in domain.types},
        {o.name: o for o in domain.constants},
        {s.name: s for s in domain.symbols} | as_symbols(domain.derived),
        {a.name: a for a in domain.actions},
        {d.name: d for d in domain.derived},
        {p.name: p for p in domain.parameters},
        frozenset(count.name for count in domain.counts),
        findings.broken,
    )
    return Scope(declared, declared.constants, {}, findings)


def known_counts(counts: Collection[str], name: syntax.Name, scope: Scope) -> bool:
    """Whether a name is that of a derived count; E207 where not."""
    if name.text not in counts and "derived" not in scope.declared.unsure:
        scope.findings.error(
            "E207",
            f"unknown count `{name.text}`",
            name.span,
            help=scope.findings.meant(name.text, counts, "count"),
        )
    return name.text in counts


def _default(node: syntax.DomainNode, scope: Scope) -> tuple[Outcome, ...]:
    """Without a default block, an action that no rule covers does nothing."""
    for section in sections_of(node.sections, syntax.Default):
        return check_default(section, section.outcomes[0].weight.chance.span, scope)
    return (Outcome(Fraction(1), OutcomeKind.NOTHING),)


def _learned(node: syntax.DomainNode, findings: Findings) -> Knowledge | None:
    for section in sections_of(node.sections, syntax.Learned):
        return check_learned(section, findings)
    return None


def _reward(node: syntax.DomainNode, counts: tuple[Count, ...], scope: Scope) -> tuple[RewardTerm, ...]:
    for section in sections_of(node.sections, syntax.Reward):
        return tuple(_reward_term(payment, counts, scope) for payment in section.payments)
    if "reward" not in scope.declared.unsure:
        scope.findings.error(
            "E219",
            f"the domain `{node.name.text}` has no reward",
            node.name.span,
            help="add for example `reward { decrease(dirty_areas) }`",
        )
    return ()


def _reward_term(node: syntax.Payment, counts: tuple[Count, ...], scope: Scope) -> RewardTerm:
    if node.weight is not None and node.weight.denominator_is_zero:
        scope.findings.error("E302", "division by zero", node.weight.span)
    weight = Fraction(1) if node.weight is None else node.weight.value
    if node.negative:
        weight = -weight
    names = [count.name for count in counts]
    match node.what:
        case syntax.Decrease(count):
            known_counts(names, count, scope)
            return RewardTerm(weight, RewardKind.DECREASE, count.text)
        case syntax.CountValue(count):
            known_counts(names, count, scope)
            return RewardTerm(weight, RewardKind.COUNT, count.text)
        case syntax.ReachedGoal():
            return RewardTerm(weight, RewardKind.GOAL)
        case syntax.ActionCost():
            return RewardTerm(weight, RewardKind.COST)
        case syntax.ActionDuration():
            _all_last(node.what, scope)
            return RewardTerm(weight, RewardKind.DURATION)


def _all_last(node: syntax.ActionDuration, scope: Scope) -> None:
    """E227 where the reward counts durations and an action has none."""
    untimed = [action.name for action in scope.declared.actions.values() if action.duration is None]
    if untimed and "actions" not in scope.declared.unsure:
        scope.findings.error(
            "E227",
            f"the reward counts durations, and no duration is known of: {', '.join(untimed)}",
            node.span,
            help=f"say how long it takes: `{untimed[0]}(...) [duration = 8 s]`",
        )
