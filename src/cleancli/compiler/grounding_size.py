"""How many instances a problem gives each rule, counted before they are built.

Guaranteed by the checker: names, arities and types fit. A count follows the join that grounding does:
exact where that leaves few rows, otherwise an upper bound, the product of what each step can leave at most.
Parts of a rule that share no variable are counted apart, so a billion is counted as fast as a thousand.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import prod

from cleancli.compiler.column_join import ColumnJoin
from cleancli.compiler.disjoint_cases import CASE_LIMIT, Case
from cleancli.compiler.memory import most_bytes
from cleancli.compiler.partial_evaluation import part_text
from cleancli.compiler.static_join import Part, Universe, free_variables
from cleancli.language.diagnostics.diagnostic import Diagnostic, Span
from cleancli.language.model import (
    Condition,
    Count,
    Domain,
    ForAll,
    Literal,
    Problem,
    Quantified,
    Rule,
    Variable,
)
from cleancli.language.printing.printer import print_term

RULE_BYTES = 10_240
"""Memory that a grounding takes at most: 11 KiB with a reference, where each stands for many literals, and 1
KiB without. Measured with join_three of benchmarks/planning.nid at 25 and 60 areas."""

PART_BYTES = 500
"""Memory that a literal or an effect takes."""

RULE_LIMIT = most_bytes() // RULE_BYTES
"""Most instances, and most ground rules, of a task."""

PART_LIMIT = most_bytes() // PART_BYTES
"""Most literals and effects that instances may have in all."""

CASES_LIKE_PARTS = 10
"""Cases of an instance that take about as long to find as its parts take to make. Measured with an action
of 512 outcomes under 8 conditions."""

EXACT_ROWS = 100_000
"""Rows of a join up to which it is run to count it: some hundredths of a second. Chosen. Before a problem is
refused, as many as may be left in the end, because a bound may be far too high."""


@dataclass(frozen=True, slots=True)
class Groundings:
    """The instances of a rule (an index in the domain): how many, or at most how many where not `exact`.

    `blame` names what leaves most of them: a literal that many objects fit, or a variable that no fact
    restricts, with the number of its objects; empty where a rule has no variables.
    """

    rule: int
    name: str
    count: int
    exact: bool
    blame: str


def count_groundings(domain: Domain, problem: Problem) -> tuple[Groundings, ...]:
    """The number of instances of each rule, in the domain's order; what no action can reach still counts."""
    join = ColumnJoin(Universe(domain, problem))
    return tuple(_groundings(index, rule, join, EXACT_ROWS) for index, rule in enumerate(domain.rules))


def most_parts(domain: Domain, problem: Problem) -> int:
    """At most how many instances there are, with the literals and effects that parts of these, of derived
    predicates and of the goal become; more for instances that the conditions of their effects divide."""
    join = ColumnJoin(Universe(domain, problem))
    found = _length_of(problem.goal, (), join)
    for derived in domain.derived:
        found += _product(derived.parameters, join) * _length_of(derived.condition, derived.parameters, join)
    for index, rule in enumerate(domain.rules):
        fitting = _fitting(rule, join)
        instances = _groundings(index, rule, join, EXACT_ROWS).count * prod(count for _, count in fitting)
        parts = 1 + _lengths(rule, fitting, join).total()
        found += instances * parts * (1 + _most_cases(rule) // CASES_LIKE_PARTS)
    return found


def _most_cases(rule: Rule) -> int:
    """At most how many cases an instance has by the conditions of its effects (`if`)."""
    conditions = {effect.condition for effect in _foralls(rule) if not effect.variables}
    return min(1 << len(conditions), CASE_LIMIT)


def refuse_too_many(domain: Domain, problem: Problem, join: ColumnJoin) -> Iterator[Diagnostic]:
    """E604 for each rule or count that has too many instances, or for the rules together; and for a
    goal of too many bindings."""
    found = _counted_until_few(domain, join)
    in_all = sum(each.count for each in found)
    if in_all > RULE_LIMIT:
        worst = max(found, key=lambda each: each.count)
        number = worst.count if worst.count > RULE_LIMIT else in_all
        yield _refusal(f"rule `{worst.name}`", worst, number, domain.rules[worst.rule].span)
        return
    for each in found:
        yield from _too_many_parts(each, domain.rules[each.rule], join)
    for count in domain.counts:
        yield from _too_many_counted(count, join)
    yield from _too_long_goal(problem, join)


def _counted_until_few(domain: Domain, join: ColumnJoin) -> list[Groundings]:
    """The instances of each rule, at most: counted by types alone, and ever more patiently while there are
    too many."""
    found = [
        Groundings(index, rule.name, _product(rule.variables, join), False, "")
        for index, rule in enumerate(domain.rules)
    ]
    for rows in (0, EXACT_ROWS, _patient()):
        if sum(each.count for each in found) <= RULE_LIMIT:
            break
        found = [_groundings(index, rule, join, rows) for index, rule in enumerate(domain.rules)]
    return found


def _patient() -> int:
    """The rows of a join before a problem is refused."""
    return max(EXACT_ROWS, RULE_LIMIT)


def _too_many_counted(count: Count, join: ColumnJoin) -> Iterator[Diagnostic]:
    """E604 for a count of too many bindings."""
    if _product(count.variables, join) <= RULE_LIMIT:
        return
    number, exact, blame = _count(count.variables, count.condition, join, _patient())
    if number > RULE_LIMIT:
        yield _refusal(f"the count `{count.name}`", Groundings(0, "", number, exact, blame), number, None)


def too_many_cases_in_all(domain: Domain, found: Sequence[Case]) -> Diagnostic:
    """E605 for a task whose instances are few enough, but not their cases."""
    rule, cases = Counter(case.rule for case in found).most_common(1)[0]
    return Diagnostic(
        "E605",
        f"the instances of rules fall into more cases than fit; {_MOST}",
        domain.rules[rule].span,
        label=f"{cases:,} are cases of rule `{domain.rules[rule].name}`",
        help="ask for less at once, take fewer objects, or leave to the facts what does not change",
    )


def _too_long_goal(problem: Problem, join: ColumnJoin) -> Iterator[Diagnostic]:
    """E604 for a goal in which a quantifier has more bindings than fit, and no fact to leave some out."""
    for part in problem.goal:
        if isinstance(part, Quantified) and not any(map(join.universe.is_static, part.condition)):
            bindings = _product(part.variables, join)
            if bindings > PART_LIMIT:
                yield Diagnostic(
                    "E604",
                    f"the goal of `{problem.name}` asks for {bindings:,} bindings of one quantifier,"
                    f" about {_size(bindings * PART_BYTES)}; {_MOST}",
                    None,
                    help="bind fewer variables at once, or take fewer objects",
                )


def _refusal(what: str, found: Groundings, in_all: int, span: Span | None) -> Diagnostic:
    number = f"{found.count:,}" if found.exact else f"up to {found.count:,}"
    share = "" if in_all == found.count else f" of {in_all:,} in all"
    return Diagnostic(
        "E604",
        f"{what} has {number} groundings{share}, about {_size(in_all * RULE_BYTES)}; {_MOST}",
        span,
        label=found.blame,
        help="add a literal whose facts no rule changes, or take fewer objects",
    )


_MOST = "half of the memory is the most that may be taken"


def _size(number: int) -> str:
    """A number of bytes in words."""
    return f"{number / 1e9:,.1f} GB"


def _too_many_parts(found: Groundings, rule: Rule, join: ColumnJoin) -> Iterator[Diagnostic]:
    """E604 for a rule whose references fit too much, or whose instances are few, but each is long: of an
    effect, quantifier or reference."""
    if not _is_long(rule, join):
        return
    fitting = _fitting(rule, join)
    lengths = _lengths(rule, fitting, join)
    length = lengths.total()
    instances, exact = found.count * prod(count for _, count in fitting), found.exact and not fitting
    if (instances > RULE_LIMIT or instances * length > PART_LIMIT) and not exact:
        instances = min(instances, _with_references(rule, join))
    if instances > RULE_LIMIT:
        worst, most = max(fitting, key=lambda reference: reference[1])
        label = f"the reference `{worst}` fits up to {most:,} bindings in each"
        refused = Groundings(found.rule, "", instances, False, label)
        yield _refusal(f"rule `{rule.name}`", refused, instances, rule.span)
    elif instances * length > PART_LIMIT:
        ((worst, most),) = lengths.most_common(1)
        yield Diagnostic(
            "E604",
            f"the groundings of rule `{rule.name}` have up to {instances * length:,} literals and effects,"
            f" about {_size(instances * length * PART_BYTES)}; {_MOST}",
            rule.span,
            label=f"`{worst}` stands for up to {most:,} of them in each",
            help="add a literal whose facts no rule changes, or take fewer objects",
        )


def _is_long(rule: Rule, join: ColumnJoin) -> bool:
    """Whether some part of the rule becomes several when the rule is grounded."""
    return bool(
        rule.references or _foralls(rule) or any(_length(part, set(), join) for part in rule.condition)
    )


def _foralls(rule: Rule) -> list[ForAll]:
    effects = (effect for outcome in rule.outcomes for effect in outcome.effects)
    return [effect for effect in effects if isinstance(effect, ForAll)]


def _fitting(rule: Rule, join: ColumnJoin) -> list[tuple[str, int]]:
    """Each reference's text, and at most how many bindings fit it."""
    bound = set(rule.variables)
    fitting = []
    for reference in rule.references:
        text = ", ".join(map(part_text, reference.condition))
        fitting.append((text, _bound(reference.variables, reference.condition, join, bound)))
        bound |= set(reference.variables)
    return fitting


def _lengths(rule: Rule, fitting: Iterable[tuple[str, int]], join: ColumnJoin) -> Counter[str]:
    """By their texts, at most how many literals and effects the parts of a rule become in each instance."""
    own = set(rule.variables)
    lengths = Counter({part_text(part): _length(part, own, join) for part in rule.condition})
    for text, count in fitting:
        # Each binding of a reference makes an instance, which speaks of all the others.
        lengths[text] += count
    bound = own.union(*(reference.variables for reference in rule.references))
    for effect in _foralls(rule):
        variables = " ".join(map(print_term, effect.variables))
        lengths[f"forall {variables}"] += _bound(effect.variables, effect.condition, join, bound)
    return lengths


def _with_references(rule: Rule, join: ColumnJoin) -> int:
    """The instances of a rule: bindings of its variables and of those of its references."""
    variables = [*rule.variables, *(v for reference in rule.references for v in reference.variables)]
    condition = (*rule.condition, *(part for reference in rule.references for part in reference.condition))
    return _count(variables, condition, join, _patient())[0]


def _length_of(condition: Condition, bound: Iterable[Variable], join: ColumnJoin) -> int:
    """At most how many literals a condition becomes of which these variables are bound."""
    return sum(_length(part, set(bound), join) for part in condition)


def _length(part: Part, bound: set[Variable], join: ColumnJoin) -> int:
    """At most how many literals a part of a condition becomes."""
    match part:
        case Quantified(variables=variables, condition=condition):
            return _bound(variables, condition, join, bound)
        case Literal(symbol) if symbol in join.universe.derived:
            derived = join.universe.derived[symbol]
            inner = set(derived.parameters)
            return 1 + sum(_length(p, inner, join) for p in derived.condition)
        case _:
            return 0


def _groundings(index: int, rule: Rule, join: ColumnJoin, rows: int) -> Groundings:
    return Groundings(index, rule.name, *_count(rule.variables, rule.condition, join, rows))


def _count(
    variables: Sequence[Variable], condition: Condition, join: ColumnJoin, rows: int
) -> tuple[int, bool, str]:
    """How many bindings a join of so many rows at most finds, whether that is exact, and what to blame."""
    numbers = [
        _count_connected(group, condition, join, rows) for group in _connected(variables, condition, join)
    ]
    fixed = [part for part in condition if join.universe.is_static(part) and not free_variables(part)]
    if not all(join.universe.holds(part, {}) for part in fixed):
        return 0, True, ""
    count = prod(number for number, _ in numbers)
    return count, all(exact for _, exact in numbers), _blame(variables, condition, join)


def _blame(variables: Sequence[Variable], condition: Condition, join: ColumnJoin) -> str:
    """The variable of most objects that no fact restricts; if there is none, the literal that fits most."""
    rows = {
        part: width
        for part in condition
        if isinstance(part, Literal)
        and join.universe.is_static(part)
        and (width := join.widest(part, ())) is not None
    }
    restricted = {variable for part in rows for variable in free_variables(part)}
    sizes = {v: len(join.universe.objects(v.type)) for v in variables if v not in restricted}
    if sizes:
        worst = max(sizes, key=lambda variable: sizes[variable])
        return f"no fact restricts `{print_term(worst)}`: {sizes[worst]:,} objects fit"
    if not rows:
        return ""
    loosest = max(rows, key=lambda part: rows[part])
    return f"`{part_text(loosest)}` holds in {rows[loosest]:,} ways"


def _count_connected(
    variables: Sequence[Variable], condition: Condition, join: ColumnJoin, rows: int
) -> tuple[int, bool]:
    own = [part for part in condition if set(free_variables(part)) & set(variables)]
    if len(variables) == 1 and not any(join.universe.is_static(part) for part in own):
        return len(join.universe.objects(variables[0].type)), True
    found = join.count(variables, tuple(own), rows)
    return (_bound(variables, tuple(own), join, set()), False) if found is None else (found, True)


def _product(variables: Sequence[Variable], join: ColumnJoin) -> int:
    """How many tuples of objects fit by their types alone."""
    return prod(len(join.universe.objects(variable.type)) for variable in variables)


def _connected(variables: Sequence[Variable], condition: Condition, join: ColumnJoin) -> list[list[Variable]]:
    """The variables in groups that no unchangeable part connects."""
    groups: list[list[Variable]] = [[variable] for variable in variables]
    for part in condition:
        if join.universe.is_static(part):
            groups = _joined(groups, set(free_variables(part)))
    # The join takes variables in the order of the rule.
    return [sorted(group, key=list(variables).index) for group in groups]


def _joined(groups: Sequence[list[Variable]], connected: set[Variable]) -> list[list[Variable]]:
    """The groups, those with a connected variable made one."""
    apart = [group for group in groups if connected.isdisjoint(group)]
    whole = [variable for group in groups if group not in apart for variable in group]
    return [*apart, whole] if whole else apart


def _bound(
    variables: Sequence[Variable], condition: Condition, join: ColumnJoin, bound: set[Variable]
) -> int:
    """The product of what each step of the join can leave at most."""
    bound = {variable for variable in bound if variable not in variables}
    static = [part for part in condition if isinstance(part, Literal) and join.universe.is_static(part)]
    free, product = list(variables), 1
    while free:
        size, decided = _narrowest(free, static, join, bound)
        product *= size
        bound |= decided
        free = [variable for variable in free if variable not in bound]
    return product


def _narrowest(
    free: Sequence[Variable], static: Iterable[Literal], join: ColumnJoin, bound: set[Variable]
) -> tuple[int, set[Variable]]:
    """How many bindings the next step of the join leaves at most, and the variables that it binds: those of
    the literal that leaves fewest, or the first by its type."""
    asking = [literal for literal in static if not set(free_variables(literal)).isdisjoint(free)]
    widths = [(join.widest(literal, bound), literal) for literal in asking]
    known = [(width, literal) for width, literal in widths if width is not None]
    size = len(join.universe.objects(free[0].type))
    width, literal = min(known, key=lambda choice: choice[0], default=(size + 1, None))
    if literal is None or width > size:
        return size, {free[0]}
    return width, set(free_variables(literal))
