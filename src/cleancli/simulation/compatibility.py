"""Whether another domain can be the world of a planner's: it must mean the same by every name they share."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import meant
from cleancli.language.model import Condition, Domain, Horizon, Literal, Problem, Quantified, Symbol, Variable
from cleancli.language.refactoring.name_index import Kind, names_in

Names = Mapping[str, str]
"""What each name stands for, as a text: equal where both domains mean the same by it."""

Places = Mapping[tuple[Kind, str], Span]


def refuse_unlike(
    domain: Domain,
    world: Domain,
    problem: Problem,
    sources: Sequence[Source],
    world_sources: Sequence[Source],
) -> None:
    """Refuse (E901) a world without the types, constants, symbols or actions of the planner's domain, or with
    others of these names, or without what the problem speaks of.

    Rules, probabilities, durations, costs, rewards, definitions and what is static may differ; a world may
    have more actions, but no more of what a state consists of.
    """
    places, world_places = _places(sources), _places(world_sources)
    found = [
        diagnostic
        for kind, what, ours, theirs in _compared(domain, world)
        for diagnostic in _unlike(kind, what, ours, theirs, places, world_places)
    ]
    for name, known in _spoken_of(problem, world):
        place = places.get((Kind.COUNT, name), places.get((Kind.SYMBOL, name)))
        message = f"the problem speaks of `{name}`, which the world does not define"
        found.append(Diagnostic("E901", message, place, help=meant(name, known, "definition")))
    if found:
        raise Refused(found, (*sources, *world_sources))


def _unlike(
    kind: Kind, what: str, ours: Names, theirs: Names, places: Places, world_places: Places
) -> Iterator[Diagnostic]:
    """A mistake for each name that the world lacks, has alone, or means otherwise."""
    for name in sorted({*ours, *theirs}):
        here, there = places.get((kind, name)), world_places.get((kind, name))
        if name not in theirs:
            message, help = f"the world has no {what} `{name}`", meant(name, theirs, what)
            yield Diagnostic("E901", message, here, "declared by the planner's domain", help)
        elif name in ours and ours[name] != theirs[name]:
            message = f"the {what} `{name}` of the world is not the planner's"
            yield Diagnostic("E901", message, there, "declared otherwise", f"the planner's is `{ours[name]}`")
        elif name not in ours and kind is not Kind.ACTION:
            message = f"only the world has the {what} `{name}`"
            yield Diagnostic("E901", message, there, help="declare it in the planner's domain too")


def _compared(domain: Domain, world: Domain) -> Iterator[tuple[Kind, str, Names, Names]]:
    """Each kind of name, with what the names stand for in both."""
    kinds = ((Kind.TYPE, "type"), (Kind.OBJECT, "constant"), (Kind.SYMBOL, "symbol"), (Kind.ACTION, "action"))
    for (kind, what), ours, theirs in zip(kinds, _meanings(domain), _meanings(world), strict=True):
        yield kind, what, ours, theirs


def _meanings(domain: Domain) -> tuple[Names, ...]:
    """What types, constants, symbols and actions stand for, by name."""
    return (
        {t.name: t.name if t.parent is None else f"{t.name} - {t.parent}" for t in domain.types},
        {constant.name: f"{constant.name} - {constant.type}" for constant in domain.constants},
        {symbol.name: _symbol(symbol) for symbol in domain.symbols},
        {action.name: _signature(action.name, action.parameters) for action in domain.actions},
    )


def _symbol(symbol: Symbol) -> str:
    """What a symbol is, but for the names of its variables and for who may change it."""
    first, *_, last = symbol.values
    values = f"{first}..{last}" if isinstance(first, int) else " < ".join(map(str, symbol.values))
    kind = "" if symbol.is_predicate else f": {values}"
    return _signature(symbol.name, symbol.parameters) + kind + (" [symmetric]" if symbol.symmetric else "")


def _signature(name: str, parameters: Sequence[Variable]) -> str:
    return f"{name}({', '.join(variable.type for variable in parameters)})"


def _spoken_of(problem: Problem, world: Domain) -> Iterator[tuple[str, Collection[str]]]:
    """Counts and derived predicates that the problem names and the world does not have, and what it has."""
    counts = {count.name for count in world.counts}
    named = problem.horizon.count if isinstance(problem.horizon, Horizon) else None
    if named is not None and named not in counts:
        yield named, counts
    known = {symbol.name for symbol in world.symbols} | {derived.name for derived in world.derived}
    for name in sorted(_symbols(problem.goal) - known):
        yield name, known


def _symbols(condition: Condition) -> set[str]:
    """The names of the symbols that a condition asks about."""
    found: set[str] = set()
    for part in condition:
        if isinstance(part, Literal):
            found.add(part.symbol)
        elif isinstance(part, Quantified):
            found |= _symbols(part.condition)
    return found


def _places(sources: Sequence[Source]) -> Places:
    """Where each name is declared."""
    return {
        (name.meaning.kind, name.meaning.name): name.span
        for source in sources
        for name in names_in(source)
        if name.declares
    }
