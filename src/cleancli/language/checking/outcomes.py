"""The check of outcomes: their probabilities sum to 1, and each does something of its own.

Guaranteed before: the condition under which the outcomes can come about.
"""

from __future__ import annotations

from fractions import Fraction

from cleancli.language import syntax
from cleancli.language.checking.conditions import Scope
from cleancli.language.checking.costs import check_payments
from cleancli.language.checking.declarations import Once, sections_of
from cleancli.language.checking.effects import changing, check_effects
from cleancli.language.checking.equivalence import Asked, asked_by, doing, idle_because
from cleancli.language.checking.notes import is_fixed, mark_of, times_seen
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.model import (
    Assign,
    Condition,
    ForAll,
    Outcome,
    OutcomeKind,
    Parameter,
    Shift,
)
from cleancli.language.printing.printer import print_fraction, print_literal, print_result

_Effect = Assign | Shift | ForAll


def check_parameters(node: syntax.DomainNode, scope: Scope) -> dict[str, Parameter]:
    """The shared parameters (E202, E302, E311)."""
    once = Once(scope.findings)
    parameters = {}
    for section in sections_of(node.sections, syntax.Shared):
        for item in section.parameters:
            chance = item.weight.chance
            assert isinstance(chance, syntax.Number)  # the grammar lets nothing else stand
            value = _probability(chance, scope)
            prior, seen, fixed = _marks(item.weight, scope)
            if once.admits(item.name, "parameter"):
                parameters[item.name.text] = Parameter(
                    item.name.text, value, prior, seen, fixed, chance.span, item.weight.span
                )
    return parameters


def check_outcomes(
    nodes: tuple[syntax.OutcomeNode, ...],
    header: Span,
    scope: Scope,
    condition: Condition = (),
    fixed: bool = False,
) -> tuple[Outcome, ...]:
    """The outcomes of a rule; their probabilities sum to 1 (E301 to E303), and no two are the same (E309)."""
    rest = _rest(nodes, header, scope)
    outcomes = tuple(_outcome(node, rest, scope, condition, fixed) for node in nodes)
    _refuse_same(nodes, outcomes, condition, scope)
    return outcomes


def _rest(nodes: tuple[syntax.OutcomeNode, ...], header: Span, scope: Scope) -> Fraction:
    """What is left for `rest`; reports a sum that is not 1."""
    total = Fraction(0)
    rests = []
    known = True
    before = scope.findings.errors
    for node in nodes:
        match node.weight.chance:
            case syntax.Rest() as found:
                rests.append(found)
            case syntax.Number() as number:
                total += _probability(number, scope)
            case syntax.Share(name):
                share = _shared(name, scope)
                known = known and share is not None
                total += share or 0
    if known and scope.findings.errors == before and (total > 1 or (total < 1 and not rests)):
        first, last = nodes[0].weight.chance.span, nodes[-1].weight.chance.span
        span = Span(first.path, first.start, last.end) if len(nodes) == 1 else header
        _refuse_sum(total, span, scope)
    for extra in rests[1:]:
        scope.findings.error("E303", "a second `rest`", extra.span, help="only one outcome can take the rest")
    return max(Fraction(0), 1 - total) if rests else Fraction(0)


def _refuse_sum(total: Fraction, span: Span, scope: Scope) -> None:
    off = f"{print_fraction(abs(total - 1))} {'too much' if total > 1 else 'is missing'}"
    help = "" if total > 1 else "let the last outcome say `rest` to take what is left"
    scope.findings.error("E301", f"the probabilities sum to {print_fraction(total)}, {off}", span, help=help)


def _shared(name: syntax.Name, scope: Scope) -> Fraction | None:
    """The value of a shared parameter; None, with E226 where that is sure, for an unknown one."""
    scope.findings.use("parameter", name.text)
    parameter = scope.declared.parameters.get(name.text)
    if parameter is None:
        if "parameters" not in scope.declared.unsure:
            known = [*scope.declared.parameters, "rest"]
            scope.findings.unknown("E226", "parameter", name.text, name.span, known)
        return None
    return parameter.probability


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


def _outcome(
    node: syntax.OutcomeNode, rest: Fraction, scope: Scope, condition: Condition, fixed: bool
) -> Outcome:
    kind, effects = _result(node.result, scope, condition)
    paid = check_payments(node.result, scope) if isinstance(node.result, syntax.Effects) else ()
    prior, seen, marked = _marks(node.weight, scope)
    chance = node.weight.chance
    rest_of_it = chance.span, node.weight.span, *paid
    match chance:
        case syntax.Number():
            return Outcome(
                chance.value, kind, effects, prior, seen, False, None, fixed or marked, *rest_of_it
            )
        case syntax.Rest():
            return Outcome(rest, kind, effects, prior, seen, True, None, fixed or marked, *rest_of_it)
        case syntax.Share(name):
            if node.weight.marks:
                scope.findings.error(
                    "E311",
                    f"the marks of `{name.text}` stand where it is declared",
                    Span(name.span.path, name.span.end, node.weight.span.end),
                    help="move them to the `parameters` block",
                )
            shared = scope.declared.parameters.get(name.text, Parameter(name.text, Fraction(0)))
            if fixed and not shared.fixed:
                scope.findings.error(
                    "E311",
                    f"a fixed rule cannot use the parameter `{name.text}`, which is learned",
                    name.span,
                    help=f"fix it where it is declared: `{name.text} = ... [fixed]`",
                )
            return Outcome(
                shared.probability, kind, effects, shared.prior, shared.seen, False, shared.name,
                shared.fixed, *rest_of_it,
            )  # fmt: skip


def _marks(weight: syntax.Weight, scope: Scope) -> tuple[Fraction | None, Fraction | None, bool]:
    """The prior, how often the outcome was seen, and whether the learner leaves it alone."""
    if not weight.marks:
        return None, None, False
    prior = mark_of(syntax.Prior, weight.marks, scope.findings)
    if prior is not None and isinstance(weight.chance, syntax.Rest):
        help = "remove it: what the priors of the others leave is the prior of `rest`"
        scope.findings.error("E311", "`rest` has no prior of its own", prior.span, help=help)
    return (
        None if prior is None else _probability(prior.probability, scope),
        times_seen(weight.marks, scope.findings),
        is_fixed(weight.marks, scope.findings),
    )


def _result(
    node: syntax.Nothing | syntax.Noise | syntax.Effects, scope: Scope, condition: Condition
) -> tuple[OutcomeKind, tuple[_Effect, ...]]:
    match node:
        case syntax.Nothing():
            return OutcomeKind.NOTHING, ()
        case syntax.Noise():
            return OutcomeKind.NOISE, ()
        case syntax.Effects():
            return OutcomeKind.CHANGE, check_effects(node, scope, condition)


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


# ---- outcomes that do the same


def _refuse_same(
    nodes: tuple[syntax.OutcomeNode, ...], outcomes: tuple[Outcome, ...], condition: Condition, scope: Scope
) -> None:
    """E309 for two outcomes that neither an observation nor what they pay can tell apart, W301 for effects
    without effect."""
    # libPRADA takes the condition and what is set as independent, so there all that is set counts.
    asked = Asked({}, {}, idle=False) if scope.compat else asked_by(condition, scope.declared)
    written: dict[str, syntax.OutcomeNode] = {}
    done: dict[object, tuple[syntax.OutcomeNode, Outcome]] = {}
    for node, outcome in zip(nodes, outcomes, strict=True):
        if isinstance(node.result, syntax.Effects) and _has_mistakes(node.result, outcome):
            continue
        if not scope.compat:
            _warn_idle(node, outcome, asked, scope)
        if len(nodes) == 1:
            break
        real = doing(outcome, asked, scope.declared), outcome.reward, outcome.cost
        first, before = done.setdefault(real, (node, outcome))
        if first is node:
            continue
        written.setdefault(print_result(before, scope.declared.symbols), first)
        shown = print_result(outcome, scope.declared.symbols)
        if shown in written:
            line = scope.findings.line(written[shown].span)
            help = f"add its probability to the outcome in {line}"
            scope.findings.error("E309", "this result is listed twice", node.result.span, help=help)
        else:
            line = scope.findings.line(first.span)
            message = f"where the rule applies, this does the same as the outcome in {line}"
            scope.findings.error("E309", message, node.result.span, help="make them one outcome")
        written.setdefault(shown, node)


def _has_mistakes(node: syntax.Effects, outcome: Outcome) -> bool:
    """Whether an outcome lacks effects, or all payments, that its text has."""
    effects = changing(node)
    unpaid = len(effects) < len(node.effects) and not (outcome.reward or outcome.cost)
    return unpaid or len(outcome.effects) < len(effects)


def _warn_idle(node: syntax.OutcomeNode, outcome: Outcome, asked: Asked, scope: Scope) -> None:
    """W301 for plain effects that set what the rule's condition says already."""
    items = changing(node.result) if isinstance(node.result, syntax.Effects) else ()
    for item, known in zip(items, idle_because(outcome, asked, scope.declared), strict=True):
        if known is not None:
            why = f"the rule applies only where `{print_literal(known, scope.declared.symbols)}`"
            scope.findings.warning("W301", "this effect changes nothing", item.span, help=why)
