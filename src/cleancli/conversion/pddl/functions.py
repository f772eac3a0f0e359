"""The numeric functions of PDDL that costs and rewards are counted with, as static functions of .nid files.

These have whole numbers from 0 up: values that are none are counted in parts of 1, of which a price takes as
much less, and where some are below 0 all are counted from the least. PDDL may leave values out, and what
would cost such a value cannot be done; a .nid file states all of them, so a predicate tells which are known.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import lcm, prod

from cleancli.conversion.pddl.formula import ALWAYS, Formula, literal
from cleancli.conversion.pddl.resolve import Predicate, Scope, Words
from cleancli.conversion.pddl.syntax import AtomNode, DomainNode, ProblemNode, ValueNode
from cleancli.language.checking.symbols import MOST_VALUES
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import Fact, Object, Price, PricePart, Symbol, Term

MOST_LEFT_OUT = 50_000
"""Values of a function that PDDL may leave out, and the .nid problem states. Chosen: a file of megabytes."""

_Values = Mapping[tuple[str, ...], Fraction]


@dataclass(frozen=True, slots=True)
class Function:
    """A function that is used: its symbol, the parts of 1 that its values are counted in, and from which
    value on (0 or less), its values in each problem by the names of objects in .nid files, and the predicate
    of what has one (None: all have)."""

    symbol: Symbol
    parts: int
    least: Fraction
    values: tuple[_Values, ...]
    known: str | None


class Functions:
    """The functions of a domain; each is looked at when it is first used."""

    def __init__(
        self, domain: DomainNode, problems: Sequence[ProblemNode], words: Words, earned: bool
    ) -> None:
        """`earned`: values may be below 0, since rewards are counted with them and not costs alone."""
        self._words = words
        self._earned = earned
        self._problems = problems
        self._declared = {each.name.text: each for each in domain.functions}
        self._used: dict[str, Function | None] = {}

    @property
    def names(self) -> frozenset[str]:
        """The names in PDDL of those that were used."""
        return frozenset(self._used)

    @property
    def used(self) -> tuple[Function, ...]:
        """Those that were used."""
        return tuple(each for each in self._used.values() if each is not None)

    def price(self, node: AtomNode, scope: Scope) -> tuple[Price, Formula] | None:
        """The value of a function, and what asks for it to be known; None, and E916 or E917, for what cannot
        be said."""
        terms = [term for term in (self._words.term(each, scope) for each in node.terms) if term is not None]
        if len(terms) < len(node.terms):
            return None
        name = node.symbol.text
        if name not in self._used:
            self._used[name] = self._function(node)
        function = self._used[name]
        if function is None or not self._fits(function, node, terms):
            return None
        part = PricePart(Fraction(1, function.parts), function.symbol.name, tuple(terms))
        asked = ALWAYS if function.known is None else literal(function.known, tuple(terms))
        return Price(function.least, (part,)), asked

    def _fits(self, function: Function, node: AtomNode, terms: Sequence[Term]) -> bool:
        wanted = function.symbol.parameters
        if len(terms) != len(wanted):
            message = f"`{node.symbol.text}` takes {plural(len(wanted), 'term')}, not {len(terms)}"
            self._words.findings.error("E916", message, node.span)
            return False
        for name, term, parameter in zip(node.terms, terms, wanted, strict=True):
            if not self._words.types.is_a(term.type, parameter.type):
                given = f"`{name.text}` is of type `{term.type}`"
                message = f"{given}, and `{node.symbol.text}` is for `{parameter.type}`"
                self._words.findings.error("E916", message, name.span)
                return False
        return True

    def _function(self, node: AtomNode) -> Function | None:
        findings, name = self._words.findings, node.symbol
        if name.text not in self._declared:
            findings.unknown("E916", "function", name.text, name.span, self._declared)
            return None
        if not self._problems and not self._words.is_open:
            message = f"the values of `{name.text}` are said by a problem"
            findings.error("E917", message, name.span, help="give the problem too")
            return None
        signature = self._declared[name.text]
        title = self._words.symbols.fresh(self._words.symbols.written(signature.name), "f")
        declared = self._words.declared_as(signature, title)
        values = tuple(
            dict(self._values(problem, objects, name.text, declared))
            for problem, objects in zip(self._problems, self._words.objects, strict=True)
        )
        said = [value for each in values for value in each.values()]
        parts, least = lcm(*(value.denominator for value in said)), min([Fraction(0), *said])
        top = max((int((value - least) * parts) for value in said), default=0)
        if top >= MOST_VALUES:
            message = f"the values of `{name.text}` are too far apart for one range"
            findings.error("E917", message, name.span)
            return None
        symbol = Symbol(declared.name, declared.parameters, tuple(range(max(top, 1) + 1)), static=True)
        counts = [prod(map(len, self._fitting(symbol, place))) for place in range(len(self._problems))]
        left_out = max((count - len(each) for each, count in zip(values, counts, strict=True)), default=0)
        if left_out > MOST_LEFT_OUT:
            message = f"`{name.text}` has no value for more than {MOST_LEFT_OUT} combinations of objects"
            help = "a .nid file states one for each: give its parameters types of which there are few objects"
            findings.error("E917", message, name.span, help=help)
            return None
        known = None
        if left_out:
            known = self._words.symbols.fresh(f"{symbol.name}_known")
            kinds = [parameter.type for parameter in symbol.parameters]
            names = tuple(parameter.name for parameter in symbol.parameters)
            self._words.predicates[known] = Predicate(known, names, kinds)
        return Function(symbol, parts, least, values, known)

    def _values(
        self, problem: ProblemNode, objects: Mapping[str, Object], name: str, declared: Predicate
    ) -> Iterator[tuple[tuple[str, ...], Fraction]]:
        """The values of a function in a problem; E916 for what does not fit, E917 for a cost below 0."""
        things = {**self._words.constants, **objects}
        for node in problem.values:
            if node.function.symbol.text == name and self._is_right(node, things, declared):
                yield tuple(things[term.text].name for term in node.function.terms), node.value

    def _is_right(self, node: ValueNode, things: Mapping[str, Object], declared: Predicate) -> bool:
        findings = self._words.findings
        before = findings.errors
        if len(node.function.terms) != len(declared.types):
            takes = plural(len(declared.types), "term")
            findings.error("E916", f"`{node.function.symbol.text}` takes {takes}", node.function.span)
        for term in node.function.terms:
            if term.text not in things:
                findings.unknown("E916", "object", term.text, term.span, things)
        if node.value < 0 and not self._earned:
            findings.error("E917", "a cost below 0 would earn something", node.span)
        return findings.errors == before and all(
            self._words.types.is_a(things[term.text].type, kind)
            for term, kind in zip(node.function.terms, declared.types, strict=True)
        )

    def _tuples(self, symbol: Symbol, place: int) -> Iterator[tuple[str, ...]]:
        """All that a function is of in one of the problems."""
        return product(*self._fitting(symbol, place))

    def _fitting(self, symbol: Symbol, place: int) -> list[list[str]]:
        """The objects that each parameter of a function may stand for in one of the problems."""
        things = {**self._words.constants, **self._words.objects[place]}.values()
        is_a = self._words.types.is_a
        return [
            [thing.name for thing in things if is_a(thing.type, parameter.type)]
            for parameter in symbol.parameters
        ]

    def facts(self, place: int) -> Iterator[Fact]:
        """What a problem, by its place, says of the functions that are used, and of what is known of them."""
        for function in self.used:
            name, values = function.symbol.name, function.values[place]
            for objects in self._tuples(function.symbol, place):
                value = values.get(objects)
                yield Fact(
                    name, objects, 0 if value is None else int((value - function.least) * function.parts)
                )
                if value is not None and function.known is not None:
                    yield Fact(function.known, objects)
