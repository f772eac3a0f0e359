"""The check of rules: their outcomes, probabilities and conditions, and that no two of an action overlap."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from itertools import combinations

from cleancli.language import syntax
from cleancli.language.conditions import Scope, check_assignment, check_condition, check_forall
from cleancli.language.declarations import Once, sections_of
from cleancli.language.diagnostics import Span
from cleancli.language.findings import meant
from cleancli.language.format import print_fraction, print_literal, print_result, print_term
from cleancli.language.model import Action, Assign, ForAll, Literal, Outcome, OutcomeKind, Rule, Variable
from cleancli.language.overlap import Witness, canonical, negated, renamed, separating, witness


def check_rules(node: syntax.DomainNode, scope: Scope) -> tuple[Rule, ...]:
    """All rules of a domain, in order; mistakes are E2xx and E301 to E309."""
    once = Once(scope.findings)
    checked = []
    for item in sections_of(node.sections, syntax.RuleNode):
        once.admits(item.name, "rule")
        rule = _rule(item, scope)
        if rule is not None:
            checked.append(rule)
    for one, other in combinations(checked, 2):
        if one.action == other.action:
            _refuse_overlap(one, other, scope)
    return tuple(checked)


def _rule(node: syntax.RuleNode, scope: Scope) -> Rule | None:
    action = _action(node, scope)
    if action is None:
        return None
    variables = _variables(node, action, scope)
    inner = scope.with_variables(variables)
    condition = check_condition(node.condition, inner)
    complete = node.condition is None or len(condition) == len(node.condition.literals)
    outcomes = check_outcomes(node.outcomes, node.name.span, inner)
    if len(variables) != len(action.parameters) or not complete:
        return None
    rule = Rule(node.name.text, action.name, variables, condition, outcomes, span=node.name.span)
    if witness([condition], scope.declared) is None:
        place = node.condition.span if node.condition is not None else node.span
        scope.findings.error(
            "E305", f"the rule `{rule.name}` can never apply", place, "these literals contradict each other"
        )
    return rule


def _action(node: syntax.RuleNode, scope: Scope) -> Action | None:
    action = scope.declared.actions.get(node.action.text)
    if action is None and "actions" not in scope.declared.unsure:
        scope.findings.unknown("E206", "action", node.action.text, node.action.span, scope.declared.actions)
    if action is not None and len(action.parameters) != len(node.terms):
        wants = len(action.parameters)
        scope.findings.error(
            "E208",
            f"`{action.name}` takes {wants} variable{'s' * (wants != 1)}, not {len(node.terms)}",
            Span(node.span.path, node.action.span.start, (node.terms or (node.action,))[-1].span.end),
        )
        return None
    return action


def _variables(node: syntax.RuleNode, action: Action, scope: Scope) -> tuple[Variable, ...]:
    variables: dict[str, Variable] = {}
    for term, parameter in zip(node.terms, action.parameters, strict=True):
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
        variables[term.name] = Variable(term.name, parameter.type)
    return tuple(variables.values())


# ---- outcomes


def check_outcomes(nodes: tuple[syntax.OutcomeNode, ...], header: Span, scope: Scope) -> tuple[Outcome, ...]:
    """The outcomes of a rule; their probabilities sum to 1 (E301 to E303), and no two are the same (E309)."""
    rest = _rest(nodes, header, scope)
    outcomes = []
    seen: dict[str, int] = {}
    for node in nodes:
        outcome = _outcome(node, rest, scope)
        outcomes.append(outcome)
        shown = print_result(outcome, scope.declared.symbols)
        if shown in seen:
            scope.findings.error(
                "E309",
                "this result is listed twice",
                node.result.span,
                help=f"add its probability to the outcome in line {seen[shown]}",
            )
        elif shown:
            seen[shown] = scope.findings.line(node.span)
    return tuple(outcomes)


def _rest(nodes: tuple[syntax.OutcomeNode, ...], header: Span, scope: Scope) -> Fraction:
    """What is left for `rest`; reports a sum that is not 1."""
    total = Fraction(0)
    rests = []
    before = scope.findings.count
    for node in nodes:
        if isinstance(node.weight.chance, syntax.Rest):
            rests.append(node.weight.chance)
        else:
            total += _probability(node.weight.chance, scope)
    if scope.findings.count == before and (total > 1 or (total < 1 and not rests)):
        first, last = nodes[0].weight.chance.span, nodes[-1].weight.chance.span
        span = Span(first.path, first.start, last.end) if len(nodes) == 1 else header
        off = f"{print_fraction(abs(total - 1))} {'too much' if total > 1 else 'is missing'}"
        help = "" if total > 1 else "let the last outcome say `rest` to take what is left"
        scope.findings.error(
            "E301", f"the probabilities sum to {print_fraction(total)}, {off}", span, help=help
        )
    for extra in rests[1:]:
        scope.findings.error("E303", "a second `rest`", extra.span, help="only one outcome can take the rest")
    return max(Fraction(0), 1 - total)


def _probability(node: syntax.Number, scope: Scope) -> Fraction:
    if node.denominator_is_zero:
        scope.findings.error("E302", "division by zero", node.span)
    elif node.value > 1:
        scope.findings.error(
            "E302",
            f"{print_fraction(node.value)} is no probability",
            node.span,
            help="probabilities lie between 0 and 1",
        )
    return node.value


def _outcome(node: syntax.OutcomeNode, rest: Fraction, scope: Scope) -> Outcome:
    chance = node.weight.chance
    is_rest = isinstance(chance, syntax.Rest)
    kind, effects = _result(node.result, scope)
    prior, seen = _marks(node.weight, scope)
    return Outcome(
        rest if isinstance(chance, syntax.Rest) else chance.value,
        kind,
        effects,
        prior,
        seen,
        is_rest,
        probability_span=chance.span,
        weight_span=node.weight.span,
    )


def _marks(weight: syntax.Weight, scope: Scope) -> tuple[Fraction | None, int | None]:
    prior: Fraction | None = None
    seen: int | None = None
    for mark in weight.marks:
        if isinstance(mark, syntax.Prior):
            if prior is not None:
                scope.findings.error("E311", "a second `prior`", mark.span)
            prior = _probability(mark.probability, scope)
        else:
            if seen is not None:
                scope.findings.error("E311", "a second `seen`", mark.span)
            if not mark.count.is_whole:
                scope.findings.error("E311", "`seen` counts outcomes: a whole number", mark.count.span)
            seen = int(mark.count.value)
    return prior, seen


def _result(
    node: syntax.Nothing | syntax.Noise | syntax.Effects, scope: Scope
) -> tuple[OutcomeKind, tuple[Assign | ForAll, ...]]:
    match node:
        case syntax.Nothing():
            return OutcomeKind.NOTHING, ()
        case syntax.Noise():
            return OutcomeKind.NOISE, ()
        case syntax.Effects():
            return OutcomeKind.CHANGE, _effects(node, scope)


def _effects(node: syntax.Effects, scope: Scope) -> tuple[Assign | ForAll, ...]:
    effects: list[Assign | ForAll] = []
    changed: dict[tuple[object, ...], Assign] = {}
    for item in node.effects:
        if isinstance(item, syntax.ForAllNode):
            forall = check_forall(item, scope)
            if forall is not None:
                effects.append(forall)
            continue
        effect = check_assignment(item, scope)
        if effect is None:
            continue
        effects.append(effect)
        key = (effect.symbol, canonical(scope.declared.symbols[effect.symbol], effect.terms))
        if key in changed:
            what = "a second time" if changed[key].value == effect.value else "in two ways"
            scope.findings.error(
                "E308",
                f"this outcome changes `{effect.symbol}` {what}",
                item.span,
                help="an outcome gives each fact one value",
            )
        changed[key] = effect
    return tuple(effects)


def check_default(node: syntax.Default, header: Span, scope: Scope) -> tuple[Outcome, ...]:
    """The noisy default rule: it has no variables and so no effects (E310)."""
    for outcome in node.outcomes:
        if isinstance(outcome.result, syntax.Effects):
            scope.findings.error(
                "E310",
                "the default rule can only say `nothing` or `noise`",
                outcome.result.span,
                help="it covers every action and so has no variables",
            )
    known = tuple(o for o in node.outcomes if not isinstance(o.result, syntax.Effects))
    return check_outcomes(known, header, scope) if len(known) == len(node.outcomes) else ()


# ---- overlap


def _refuse_overlap(one: Rule, other: Rule, scope: Scope) -> None:
    conditions = one.condition, renamed(other, one.variables)
    state = witness(conditions, scope.declared)
    if state is None:
        return
    assert one.span is not None
    assert other.span is not None
    line = scope.findings.line(one.span)
    holds = ", ".join(_shown(state, scope))
    scope.findings.error(
        "E307",
        f"the rules `{one.name}` (line {line}) and `{other.name}` of `{one.action}` overlap",
        other.span,
        f"both apply where {holds}" if holds else "both always apply",
        _mend(one, other, scope),
    )


def _shown(state: Witness, scope: Scope) -> Iterator[str]:
    symbols = scope.declared.symbols
    for one, leader in state.equal:
        yield f"{print_term(one)} = {print_term(leader)}"
    for literal in state.allowed:
        values = [v for v in symbols[literal.symbol].values if v in literal.values]
        yield print_literal(Literal(literal.symbol, literal.terms, frozenset(values[-1:])), symbols)


def _mend(one: Rule, other: Rule, scope: Scope) -> str:
    """The missing pair: a literal that one rule has, and its opposite for the other."""
    declared = scope.declared
    for first, second in ((one, other), (other, one)):
        part = separating(renamed(first, second.variables), second.condition, declared)
        if part is not None:
            opposite = print_literal(negated(part, declared), declared.symbols)
            return f"add `{opposite}` to `{second.name}`, since `{first.name}` asks for the opposite"
    return "their conditions are the same: make them one rule"


def known_counts(counts: Iterable[str], name: syntax.Name, scope: Scope) -> bool:
    """Whether a name is that of a derived count; E207 where not."""
    counts = list(counts)
    if name.text not in counts and "derived" not in scope.declared.unsure:
        scope.findings.error(
            "E207", f"unknown count `{name.text}`", name.span, help=meant(name.text, counts, "count")
        )
    return name.text in counts
