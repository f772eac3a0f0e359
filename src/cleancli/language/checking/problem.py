"""From syntax to the checked model of a problem, given the domain it is for."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from itertools import islice, product
from math import prod

from cleancli.language import syntax
from cleancli.language.checking.conditions import (
    Scope,
    check_condition,
    resolve_application,
    resolve_value,
    shown_values,
    wants_function,
    wants_predicate,
)
from cleancli.language.checking.declarations import (
    Once,
    read_objects,
    refuse_repeated,
    sections_of,
    unsure_sections,
    without_point,
)
from cleancli.language.checking.domain import known_counts, scope_of
from cleancli.language.checking.planner_block import PlannerOptions, check_planner
from cleancli.language.checking.unreachable import warn_impossible
from cleancli.language.diagnostics.diagnostic import Level, Span
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import (
    Condition,
    Domain,
    Fact,
    Horizon,
    Object,
    Problem,
    RewardKind,
    State,
    Symbol,
    Unlimited,
    Value,
    usual_discount,
    wanted_decreased,
)

_SECTIONS: Mapping[type[syntax.Node], str] = {
    syntax.DomainName: "domain",
    syntax.Objects: "objects",
    syntax.Init: "init",
    syntax.Goal: "goal",
    syntax.HorizonNode: "horizon",
    syntax.Discount: "discount",
    syntax.Planner: "planner",
}
_OF_DOMAIN = re.compile(r"E20[135789]|E21[01]|E221|E306|E40[24]|E410|W20[24]|W401")
"""What is wrong with a problem only because of what its domain declares."""
_MOST_NAMED = 3
_LONGEST = 1000
"""Actions in a plan: far beyond any table, near enough that a slip of the pen is caught."""


def check_problem(node: syntax.ProblemNode, domain: Domain, findings: Findings) -> Problem:
    """The model of a problem; it may only be used if `findings` holds no error."""
    refuse_repeated(node.sections, _SECTIONS, frozenset(), findings)
    scope = scope_of(domain, findings)
    objects = _objects(node, domain, scope)
    everything = {**scope.objects, **{o.name: o for o in objects}}
    scope = Scope(scope.declared, everything, {}, findings)
    state = _state(node, domain, scope)
    return _with_aims(node, domain, objects, state, scope)


def check_despite(
    node: syntax.ProblemNode,
    root: syntax.DomainNode,
    domain: Domain,
    of_domain: Findings,
    findings: Findings,
) -> None:
    """Note the mistakes of a problem whose domain, with this tree, has mistakes too; none that may follow
    from those. What could not be read may declare anything; of mistakes in rules nothing follows, and of
    others that names may mean something else."""
    findings.broken |= unsure_sections(of_domain)
    findings.unclear |= of_domain.unclear
    check_problem(node, domain, findings)
    rules = [rule.span for rule in sections_of(root.sections, syntax.RuleNode)]
    for mistake in of_domain.sorted:
        place = mistake.span
        unread, within = mistake.code.startswith("E1"), any(_lies_in(place, rule) for rule in rules)
        if mistake.level is Level.ERROR and not unread and not within:
            findings.fold(_OF_DOMAIN)


def _lies_in(place: Span | None, whole: Span) -> bool:
    return place is not None and place.path == whole.path and whole.start <= place.start < whole.end


def check_aims(
    node: syntax.ProblemNode, domain: Domain, objects: tuple[Object, ...], state: State, findings: Findings
) -> Problem:
    """The model of a problem whose objects and facts are right and do not stand in the tree; as
    `check_problem`."""
    scope = scope_of(domain, findings)
    everything = {**scope.objects, **{o.name: o for o in objects}}
    return _with_aims(node, domain, objects, state, Scope(scope.declared, everything, {}, findings))


def _with_aims(
    node: syntax.ProblemNode, domain: Domain, objects: tuple[Object, ...], state: State, scope: Scope
) -> Problem:
    findings = scope.findings
    discounts = sections_of(node.sections, syntax.Discount)
    planners = sections_of(node.sections, syntax.Planner)
    options = check_planner(planners[0], findings) if planners else PlannerOptions()
    problem = Problem(
        node.name.text,
        domain.name,
        objects,
        state,
        _horizon(node, domain, scope),
        _discount(discounts[0], findings) if discounts else usual_discount(domain),
        _goal(node, domain, scope),
        options.name,
        options.samples,
        options.seed,
    )
    _check_domain_name(node, domain, findings)
    if not findings.errors:
        warn_impossible(problem, domain, _place_of_init(node), findings)
    return problem


def _check_domain_name(node: syntax.ProblemNode, domain: Domain, findings: Findings) -> None:
    named = sections_of(node.sections, syntax.DomainName)
    if not named and "domain" not in findings.broken:
        findings.error(
            "E407",
            f"the problem `{node.name.text}` names no domain",
            node.name.span,
            help=f"add `domain = {domain.name}`",
        )
    for section in named:
        if section.name.text != domain.name:
            folded = findings.fold(_OF_DOMAIN)
            help = f"name the domain `{section.name.text}` instead"
            if folded:
                verb = "is" if folded == 1 else "are"
                help += f"; {plural(folded, 'message')} that may follow from this {verb} left out"
            message = f"this problem is for the domain `{section.name.text}`, not `{domain.name}`"
            findings.error("E401", message, section.name.span, help=help)


def _objects(node: syntax.ProblemNode, domain: Domain, scope: Scope) -> tuple[Object, ...]:
    once = Once(scope.findings)
    groups = [g for s in sections_of(node.sections, syntax.Objects) for g in s.groups]
    objects = read_objects(groups, scope.declared, once, "object", scope.findings)
    constants = {c.name for c in domain.constants}
    for name in (name for group in groups for name in group.names):
        if name.text in constants:
            scope.findings.error(
                "E402",
                f"`{name.text}` is already a constant of the domain",
                name.span,
                help="leave it out here: constants are objects of every problem",
            )
    return tuple(objects.values())


def _state(node: syntax.ProblemNode, domain: Domain, scope: Scope) -> State:
    items = [fact for init in sections_of(node.sections, syntax.Init) for fact in init.facts]
    read = [(item, _fact(item, scope)) for item in items]
    values: dict[tuple[str, tuple[str, ...]], Value] = {}
    for item, fact in read:
        if fact is None:
            continue
        stated = values.setdefault((fact.symbol, fact.objects), fact.value)
        if stated != fact.value:
            message = f"`{fact.symbol}` has another value for these objects above"
            scope.findings.error("E405", message, item.span, help=f"there it is `{stated}`")
    if all(fact is not None for _, fact in read) and not scope.findings.broken & {"init", "objects"}:
        _refuse_missing(domain, values.keys(), _place_of_init(node), scope)
    return frozenset(Fact(symbol, objects, value) for (symbol, objects), value in values.items())


def _place_of_init(node: syntax.ProblemNode) -> Span:
    for init in sections_of(node.sections, syntax.Init):
        return Span(init.span.path, init.span.start, init.span.start + len("init"))
    return node.name.span


def _goal(node: syntax.ProblemNode, domain: Domain, scope: Scope) -> Condition:
    """The goal; W401 where only the reward speaks of one."""
    for section in sections_of(node.sections, syntax.Goal):
        return check_condition(section.condition, scope)
    paid = any(term.kind is RewardKind.GOAL for term in domain.reward)
    if paid and "goal" not in scope.findings.broken:
        scope.findings.warning(
            "W401",
            "the domain's reward pays for a goal, and this problem has none",
            node.name.span,
            help="add for example `goal { not dirt(a1) }`",
        )
    return ()


def _fact(node: syntax.FactNode, scope: Scope) -> Fact | None:
    before = scope.findings.errors
    for term in node.application.terms:
        if term.is_variable:
            scope.findings.error(
                "E409", f"`?{term.name}` is a variable", term.span, help="a fact names objects"
            )
    if scope.findings.errors != before:
        return None
    resolved = resolve_application(node.application, scope)
    if resolved is None:
        return None
    symbol, terms = resolved
    if symbol.name in scope.declared.derived:
        message = f"`{symbol.name}` is derived and cannot be stated"
        scope.findings.error("E221", message, node.span, help="state what it follows from")
        return None
    objects = symbol.canonical(tuple(term.name for term in terms))
    if node.value is None:
        return Fact(symbol.name, objects) if wants_predicate(symbol, node, scope) else None
    if not wants_function(symbol, node, scope):
        return None
    value = resolve_value(node.value, symbol, scope)
    return None if value is None else Fact(symbol.name, objects, value)


def _refuse_missing(
    domain: Domain, given: Collection[tuple[str, tuple[str, ...]]], where: Span, scope: Scope
) -> None:
    """E404 for each function without a value for some objects."""
    for function in (symbol for symbol in domain.symbols if not symbol.is_predicate):
        fitting = _fitting(function, scope)
        count = prod(map(len, fitting)) - sum(name == function.name for name, _ in given)
        if count > 0:
            # There may be too many to look at: what is given has been checked, so the rest is missing.
            missing = (objects for objects in product(*fitting) if (function.name, objects) not in given)
            message = _without_value(function, list(islice(missing, _MOST_NAMED)), count)
            scope.findings.error("E404", message, where, help=f"add a value: {shown_values(function)}")


def _without_value(function: Symbol, first: Sequence[tuple[str, ...]], count: int) -> str:
    """That so many have no value, of which the first are shown."""
    shown = ", ".join(f"`{function.name}({', '.join(objects)})`" for objects in first)
    more = f" and {count - len(first)} more" if count > len(first) else ""
    return f"{shown}{more} {'has' if count == 1 else 'have'} no value"


def _fitting(symbol: Symbol, scope: Scope) -> list[list[str]]:
    """The objects that each parameter of a symbol may stand for."""
    known = [o for o in scope.objects.values() if o.type in scope.declared.types]
    return [
        sorted(o.name for o in known if scope.declared.is_a(o.type, parameter.type))
        for parameter in symbol.parameters
    ]


def _horizon(node: syntax.ProblemNode, domain: Domain, scope: Scope) -> Horizon | Unlimited | None:
    """The horizon; E410 where there is none and the reward gives none, E411 where only a goal ends a plan."""
    for section in sections_of(node.sections, syntax.HorizonNode):
        if section.constant is None and section.count is None:
            return _unlimited(section, node, scope)
        return _stated_horizon(section, domain, scope)
    if wanted_decreased(domain) is None and domain.reward and "horizon" not in scope.findings.broken:
        scope.findings.error(
            "E410",
            "this problem needs a horizon",
            node.name.span,
            help="the reward wants no count decreased, to take it from: add for example `horizon = 10`",
        )
    return None


def _unlimited(section: syntax.HorizonNode, node: syntax.ProblemNode, scope: Scope) -> Unlimited:
    if not sections_of(node.sections, syntax.Goal) and "goal" not in scope.findings.broken:
        scope.findings.error(
            "E411",
            "without a horizon only a goal ends a plan, and this problem has none",
            section.span,
            help="add for example `goal { not dirt(a1) }`, or a number of actions: `horizon = 10`",
        )
    return Unlimited()


def _stated_horizon(node: syntax.HorizonNode, domain: Domain, scope: Scope) -> Horizon:
    """A number of actions, a count, or their sum."""
    if node.count is None:
        return Horizon(_steps(node.constant, 1, scope.findings))
    known_counts([count.name for count in domain.counts], node.count, scope)
    return Horizon(_steps(node.constant, 0, scope.findings), node.count.text)


def _steps(constant: syntax.Number | None, low: int, findings: Findings) -> int:
    """A number of actions, at least `low`; E406 for any other number."""
    if constant is None:
        return 0
    if not constant.is_whole or not low <= constant.value <= _LONGEST:
        message = f"the horizon is a whole number of actions from {low} to {_LONGEST}"
        findings.error("E406", message, constant.span, help=without_point(constant))
    return int(constant.value)


def _discount(node: syntax.Discount, findings: Findings) -> float:
    if node.value.value > 1:
        findings.error("E406", "the discount lies between 0 and 1", node.value.span)
    return float(node.value.value)
