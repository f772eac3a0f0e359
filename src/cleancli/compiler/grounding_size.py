"""How many instances a problem gives each rule, counted before they are built.

Guaranteed by the checker: names, arities and types fit. A count follows the join that grounding does:
exact where that takes few steps, otherwise an upper bound, the product of what each step can leave at most.
Parts of a rule that share no variable are counted apart, so a billion is counted as fast as a thousand.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import prod

from cleancli.compiler.disjoint_cases import Case
from cleancli.compiler.partial_evaluation import part_text
from cleancli.compiler.static_join import Part, Universe, free_variables
from cleancli.language.diagnostics.diagnostic import Diagnostic, Span
from cleancli.language.model import Condition, Domain, ForAll, Literal, Problem, Quantified, Rule, Variable
from cleancli.language.printing.printer import print_term

RULE_LIMIT = 100_000
"""Most instances, and most ground rules, of a task. Grounding takes 9 KiB for each of those of
benchmarks/planning.py, so this is 1 GB; and PRADA draws few sequences a second from as many."""

PART_LIMIT = 2_000_000
"""Most literals and effects that instances may have in all, at about 500 bytes each: 1 GB too."""

EXACT_STEPS = 20_000
"""Steps of a join up to which it is run to count it: some hundredths of a second. Chosen."""

PATIENT_STEPS = 250_000
"""The same before a problem is refused, because a bound may be far too high. Chosen: some seconds."""


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
    universe = Universe(domain, problem)
    return tuple(_groundings(index, rule, universe) for index, rule in enumerate(domain.rules))


def refuse_too_many(domain: Domain, problem: Problem, universe: Universe) -> Iterator[Diagnostic]:
    """E604 for each rule or count that has too many instances, or for the rules together."""
    found = [
        Groundings(index, rule.name, _product(rule.variables, universe), False, "")
        for index, rule in enumerate(domain.rules)
    ]
    for steps in (0, EXACT_STEPS, PATIENT_STEPS):
        if sum(each.count for each in found) <= RULE_LIMIT:
            break
        found = [_groundings(index, rule, universe, steps) for index, rule in enumerate(domain.rules)]
    if sum(each.count for each in found) > RULE_LIMIT:
        worst = max(found, key=lambda each: each.count)
        in_all = "" if worst.count > RULE_LIMIT else f" of {sum(each.count for each in found):,} in all"
        yield _refusal(f"rule `{worst.name}`", worst, in_all, domain.rules[worst.rule].span)
        return
    for each in found:
        yield from _too_many_parts(each, domain.rules[each.rule], universe)
    for count in domain.counts:
        if _product(count.variables, universe) <= RULE_LIMIT:
            continue
        number, exact, blame = _count(count.variables, count.condition, universe, EXACT_STEPS)
        if number > RULE_LIMIT:
            yield _refusal(f"the count `{count.name}`", Groundings(0, "", number, exact, blame), "", None)


def too_many_cases_in_all(domain: Domain, found: Sequence[Case]) -> Diagnostic:
    """E605 for a task whose instances are few enough, but not their cases."""
    rule, cases = Counter(case.rule for case in found).most_common(1)[0]
    return Diagnostic(
        "E605",
        f"the instances of rules fall into more than {RULE_LIMIT:,} cases",
        domain.rules[rule].span,
        label=f"{cases:,} are cases of rule `{domain.rules[rule].name}`",
        help="ask for less at once, take fewer objects, or leave to the facts what does not change",
    )


def _refusal(what: str, found: Groundings, in_all: str, span: Span | None) -> Diagnostic:
    number = f"{found.count:,}" if found.exact else f"up to {found.count:,}"
    return Diagnostic(
        "E604",
        f"{what} has {number} groundings{in_all}; {RULE_LIMIT:,} are the most that fit",
        span,
        label=found.blame,
        help="add a literal whose facts no rule changes, or take fewer objects",
    )


def _too_many_parts(found: Groundings, rule: Rule, universe: Universe) -> Iterator[Diagnostic]:
    """E604 for a rule whose references fit too much, or whose instances are few, but each is long: of an
    effect, quantifier or reference."""
    foralls = [e for outcome in rule.outcomes for e in outcome.effects if isinstance(e, ForAll)]
    if not (foralls or rule.references or any(_length(p, set(), universe) for p in rule.condition)):
        return
    bound = set(rule.variables)
    lengths: dict[str, int] = {part_text(p): _length(p, bound, universe) for p in rule.condition}
    fitting: dict[str, int] = {}
    for reference in rule.references:
        text = ", ".join(part_text(part) for part in reference.condition)
        # Each binding of a reference makes an instance, which speaks of all the others.
        fitting[text] = _bound(reference.variables, reference.condition, universe, bound)
        lengths[text] = lengths.get(text, 0) + fitting[text]
        bound |= set(reference.variables)
    for effect in foralls:
        variables = " ".join(print_term(variable) for variable in effect.variables)
        length = _bound(effect.variables, effect.condition, universe, bound)
        lengths[f"forall {variables}"] = lengths.get(f"forall {variables}", 0) + length
    length = sum(lengths.values())
    instances, exact = found.count * prod(fitting.values()), found.exact and not fitting
    if (instances > RULE_LIMIT or instances * length > PART_LIMIT) and not exact:
        instances = min(instances, _with_references(rule, universe))
    if instances > RULE_LIMIT:
        worst = max(fitting, key=lambda text: fitting[text])
        label = f"the reference `{worst}` fits up to {fitting[worst]:,} bindings in each"
        yield _refusal(
            f"rule `{rule.name}`", Groundings(found.rule, "", instances, False, label), "", rule.span
        )
    elif instances * length > PART_LIMIT:
        worst = max(lengths, key=lambda text: lengths[text])
        yield Diagnostic(
            "E604",
            f"the groundings of rule `{rule.name}` have up to {instances * length:,} literals and effects;"
            f" {PART_LIMIT:,} are the most that fit",
            rule.span,
            label=f"`{worst}` stands for up to {lengths[worst]:,} of them in each",
            help="add a literal whose facts no rule changes, or take fewer objects",
        )


def _with_references(rule: Rule, universe: Universe) -> int:
    """The instances of a rule: bindings of its variables and of those of its references."""
    variables = [*rule.variables, *(v for reference in rule.references for v in reference.variables)]
    condition = (*rule.condition, *(part for reference in rule.references for part in reference.condition))
    return _count(variables, condition, universe, PATIENT_STEPS)[0]


def _length(part: Part, bound: set[Variable], universe: Universe) -> int:
    """At most how many literals a part of a condition becomes."""
    match part:
        case Quantified(variables=variables, condition=condition):
            return _bound(variables, condition, universe, bound)
        case Literal(symbol) if symbol in universe.derived:
            derived = universe.derived[symbol]
            inner = set(derived.parameters)
            return 1 + sum(_length(p, inner, universe) for p in derived.condition)
        case _:
            return 0


def _groundings(index: int, rule: Rule, universe: Universe, steps: int = EXACT_STEPS) -> Groundings:
    return Groundings(index, rule.name, *_count(rule.variables, rule.condition, universe, steps))


def _count(
    variables: Sequence[Variable], condition: Condition, universe: Universe, steps: int
) -> tuple[int, bool, str]:
    """How many bindings the join finds, whether that is exact, and what to blame."""
    numbers = [
        _count_connected(group, condition, universe, steps)
        for group in _connected(variables, condition, universe)
    ]
    fixed = [part for part in condition if universe.is_static(part) and not free_variables(part)]
    if not all(universe.holds(part, {}) for part in fixed):
        return 0, True, ""
    count = prod(number for number, _ in numbers)
    return count, all(exact for _, exact in numbers), _blame(variables, condition, universe)


def _blame(variables: Sequence[Variable], condition: Condition, universe: Universe) -> str:
    """The variable of most objects that no fact restricts; if there is none, the literal that fits most."""
    rows = {
        part: width
        for part in condition
        if isinstance(part, Literal)
        and universe.is_static(part)
        and (width := universe.widest(part, ())) is not None
    }
    restricted = {variable for part in rows for variable in free_variables(part)}
    sizes = {v: len(universe.objects(v.type)) for v in variables if v not in restricted}
    if sizes:
        worst = max(sizes, key=lambda variable: sizes[variable])
        return f"no fact restricts `{print_term(worst)}`: {sizes[worst]:,} objects fit"
    if not rows:
        return ""
    loosest = max(rows, key=lambda part: rows[part])
    return f"`{part_text(loosest)}` holds in {rows[loosest]:,} ways"


def _count_connected(
    variables: Sequence[Variable], condition: Condition, universe: Universe, steps: int
) -> tuple[int, bool]:
    own = [part for part in condition if set(free_variables(part)) & set(variables)]
    if len(variables) == 1 and not any(universe.is_static(part) for part in own):
        return len(universe.objects(variables[0].type)), True
    found = 0
    for step, binding in enumerate(universe.search(variables, tuple(own), {})):
        if step >= steps or found > RULE_LIMIT:
            return _bound(variables, tuple(own), universe, set()), False
        found += binding is not None
    return found, True


def _product(variables: Sequence[Variable], universe: Universe) -> int:
    """How many tuples of objects fit by their types alone."""
    return prod(len(universe.objects(variable.type)) for variable in variables)


def _connected(
    variables: Sequence[Variable], condition: Condition, universe: Universe
) -> list[list[Variable]]:
    """The variables in groups that no unchangeable part connects."""
    groups: list[list[Variable]] = [[variable] for variable in variables]
    for part in condition:
        if universe.is_static(part):
            asked = set(free_variables(part))
            joined = [group for group in groups if asked & set(group)]
            groups = [group for group in groups if group not in joined]
            groups += [[variable for group in joined for variable in group]] if joined else []
    # The join takes variables in the order of the rule.
    return [sorted(group, key=list(variables).index) for group in groups]


def _bound(
    variables: Sequence[Variable], condition: Condition, universe: Universe, bound: set[Variable]
) -> int:
    """The product of what each step of the join can leave at most."""
    bound = {variable for variable in bound if variable not in variables}
    static = [part for part in condition if isinstance(part, Literal) and universe.is_static(part)]
    free, product = list(variables), 1
    while free:
        widths = [
            (width, literal)
            for literal in static
            if set(free_variables(literal)) & set(free)
            and (width := universe.widest(literal, bound)) is not None
        ]
        smallest = min(widths, key=lambda choice: choice[0], default=None)
        size = len(universe.objects(free[0].type))
        if smallest is None or smallest[0] > size:
            product *= size
            bound |= {free[0]}
        else:
            product *= smallest[0]
            bound |= set(free_variables(smallest[1]))
        free = [variable for variable in free if variable not in bound]
    return product
