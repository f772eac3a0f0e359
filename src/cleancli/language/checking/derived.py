"""The check of the `derived` block: counts, and predicates that follow from others.

Guaranteed before: types, constants, predicates and functions are read.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from graphlib import CycleError, TopologicalSorter

from cleancli.language import syntax
from cleancli.language.checking.conditions import (
    Scope,
    bind_variables,
    check_condition,
    warn_unused_variables,
)
from cleancli.language.checking.declarations import Declarations, Once, read_variables, sections_of
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import (
    REWARD_WORDS,
    Condition,
    Count,
    DerivedPredicate,
    Literal,
    Quantified,
    Symbol,
)

_Node = syntax.DefinitionNode | syntax.ClosureNode


def read_derived(
    node: syntax.DomainNode, declared: Declarations, once: Once, findings: Findings
) -> dict[str, DerivedPredicate]:
    """The derived predicates without their definitions, which may use one another in any order."""
    heads = {}
    for item in _definitions(node):
        parameters = read_variables(item.parameters, declared, findings)
        if once.admits(item.name, "derived predicate"):
            heads[item.name.text] = DerivedPredicate(item.name.text, parameters)
    return heads


def as_symbols(derived: Iterable[DerivedPredicate]) -> dict[str, Symbol]:
    """Derived predicates as literals see them: predicates."""
    return {d.name: Symbol(d.name, d.parameters) for d in derived}


def check_derived(node: syntax.DomainNode, scope: Scope) -> dict[str, DerivedPredicate]:
    """The derived predicates with their definitions; E222 for those that need themselves."""
    derived = dict(scope.declared.derived)
    places = {}
    for item in _definitions(node):
        head = derived.get(item.name.text)
        if head is None or item.name.text in places:
            continue
        places[head.name] = item.name
        if isinstance(item, syntax.ClosureNode):
            derived[head.name] = _closure(item, head, scope)
        else:
            inner = scope.with_variables(head.parameters)
            condition = check_condition(item.condition, inner)
            if len(condition) == len(item.condition.parts):
                warn_unused_variables(item.parameters, condition, scope)
            derived[head.name] = replace(head, condition=condition)
    for cycle in _cycles(derived):
        scope.findings.error(
            "E222",
            f"`{cycle[0]}` is derived from itself",
            places[cycle[0]].span,
            help=f"{' -> '.join((*cycle, cycle[0]))}: for any number of steps use `closure`",
        )
    return derived


def _definitions(node: syntax.DomainNode) -> Iterator[_Node]:
    for section in sections_of(node.sections, syntax.Derived):
        for item in section.items:
            if not isinstance(item, syntax.CountNode):
                yield item


def _closure(node: syntax.ClosureNode, head: DerivedPredicate, scope: Scope) -> DerivedPredicate:
    name = node.of.text
    of = scope.declared.symbols.get(name)
    scope.findings.use("symbol", name)
    if of is None:
        if not {"predicates", "derived"} & scope.declared.unsure:
            scope.findings.unknown("E203", "predicate", name, node.of.span, scope.declared.symbols)
        return head
    fits = of.is_predicate and len(of.parameters) == 2 and len(head.parameters) == 2
    if fits and not all(
        scope.declared.is_a(own.type, wanted.type)
        for own, wanted in zip(head.parameters, of.parameters, strict=True)
    ):
        fits = False
    if not fits:
        scope.findings.error(
            "E223",
            f"`{head.name}` cannot be the closure of `{name}`",
            node.of.span,
            help="a closure has two parameters, and so has its predicate, of the same types",
        )
    return replace(head, closure=name)


def _cycles(derived: Mapping[str, DerivedPredicate]) -> Iterator[tuple[str, ...]]:
    """Circles of definitions, as the names along them; no definition stands in two."""
    left = {name: [n for n in _needed(d) if n in derived] for name, d in derived.items()}
    while left := _without_ends(left):
        path = [next(iter(left))]
        while (following := left[path[-1]][0]) not in path:
            path.append(following)
        cycle = tuple(path[path.index(following) :])
        yield cycle
        left = _without(left, cycle)


def _without_ends(needs: Mapping[str, list[str]]) -> dict[str, list[str]]:
    """What is left after taking away, again and again, definitions that need no other."""
    sorter = TopologicalSorter(needs)
    with suppress(CycleError):  # it still tells what stands before the circles
        sorter.prepare()
    ends: set[str] = set()
    while ready := sorter.get_ready():
        ends.update(ready)
        sorter.done(*ready)
    return _without(needs, ends)


def _without(needs: Mapping[str, list[str]], gone: Container[str]) -> dict[str, list[str]]:
    """The definitions but for some that nobody needs any more."""
    return {name: [n for n in needed if n not in gone] for name, needed in needs.items() if name not in gone}


def _needed(derived: DerivedPredicate) -> Iterator[str]:
    if derived.closure is not None:
        yield derived.closure
    yield from symbols_in(derived.condition)


def symbols_in(condition: Condition) -> Iterator[str]:
    """The symbols that a condition asks for."""
    for part in condition:
        if isinstance(part, Literal):
            yield part.symbol
        elif isinstance(part, Quantified):
            yield from symbols_in(part.condition)


def names_of_counts(node: syntax.DomainNode) -> Iterator[syntax.Name]:
    """What the counts of a domain are called."""
    for section in sections_of(node.sections, syntax.Derived):
        yield from (item.name for item in section.items if isinstance(item, syntax.CountNode))


def check_counts(node: syntax.DomainNode, scope: Scope) -> tuple[Count, ...]:
    """The derived counts; their names are not those of symbols (E202) nor words of a reward (E214)."""
    once = Once(scope.findings)
    counts = []
    for section in sections_of(node.sections, syntax.Derived):
        for item in section.items:
            if isinstance(item, syntax.CountNode):
                counts.append(_count(item, scope, once))
    return tuple(count for count in counts if count is not None)


def _count(node: syntax.CountNode, scope: Scope, once: Once) -> Count | None:
    variables, inner = bind_variables(node.parameters, "count", "?a - type: condition", node.span, scope)
    condition = check_condition(node.condition, inner)
    if len(condition) == len(node.condition.parts):
        warn_unused_variables(node.parameters, condition, scope)
    name = node.name.text
    if name in REWARD_WORDS:
        message = f"`{name}` is a word of rewards"
        scope.findings.error("E214", message, node.name.span, help="choose another name for this count")
        return None
    if name in scope.declared.symbols:
        scope.findings.error(
            "E202",
            f"`{name}` is already a predicate or function",
            node.name.span,
            help="choose another name",
        )
        return None
    return Count(name, variables, condition) if once.admits(node.name, "count") else None
