"""What each name of a text means: its kind, where it is declared, where it is used.

Guaranteed by the parser: structure. Nothing is checked here: a name may mean something that nobody declared,
and sections that could not be read hold no names. The tree is walked by its fields, and `MEANINGS` says what
the names in them are; a field that it does not know is refused.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields

from cleancli.language import syntax
from cleancli.language.diagnostics import Source, Span
from cleancli.language.parse import parse


class Kind(enum.Enum):
    """What a name can stand for."""

    DOMAIN = "domain"
    PROBLEM = "problem"
    SCENE = "scene"
    TYPE = "type"
    OBJECT = "object"
    SYMBOL = "symbol"
    VALUE = "value"
    COUNT = "count"
    ACTION = "action"
    RULE = "rule"
    VARIABLE = "variable"
    WORD = "word"
    """A word of the language that the grammar reads as a name: a mark, or a key of a scene."""


@dataclass(frozen=True, slots=True)
class Occurrence:
    """One place where a name stands; neither `name` nor `span` has the `?` of a variable.

    `owner` tells names of one kind apart: the function of a value, the place that binds a variable.
    """

    kind: Kind
    name: str
    owner: str
    span: Span
    declares: bool = False

    @property
    def thing(self) -> tuple[Kind, str, str]:
        """Equal for two occurrences of the same thing."""
        return self.kind, self.name, self.owner


_Place = tuple[type[syntax.Node], str]

DECLARATIONS: Mapping[_Place, Kind] = {
    (syntax.DomainNode, "name"): Kind.DOMAIN,
    (syntax.ProblemNode, "name"): Kind.PROBLEM,
    (syntax.SceneNode, "name"): Kind.SCENE,
    (syntax.PredicateNode, "name"): Kind.SYMBOL,
    (syntax.FunctionNode, "name"): Kind.SYMBOL,
    (syntax.FunctionNode, "values"): Kind.VALUE,
    (syntax.CountNode, "name"): Kind.COUNT,
    (syntax.ActionNode, "name"): Kind.ACTION,
    (syntax.RuleNode, "name"): Kind.RULE,
}
"""Fields whose names declare what they name."""

USES: Mapping[_Place, Kind] = {
    (syntax.Group, "type"): Kind.TYPE,
    (syntax.Application, "symbol"): Kind.SYMBOL,
    (syntax.Comparison, "value"): Kind.VALUE,
    (syntax.SetValue, "value"): Kind.VALUE,
    (syntax.FactNode, "value"): Kind.VALUE,
    (syntax.RuleNode, "action"): Kind.ACTION,
    (syntax.Reward, "count"): Kind.COUNT,
    (syntax.HorizonNode, "count"): Kind.COUNT,
    (syntax.DomainName, "name"): Kind.DOMAIN,
    (syntax.Attribute, "name"): Kind.WORD,
    (syntax.Setting, "key"): Kind.WORD,
    (syntax.Section, "name"): Kind.WORD,
    (syntax.Call, "name"): Kind.WORD,
}
"""Fields whose names mean what is declared elsewhere. What a `Group` lists is decided by what holds it."""

_GROUPS: Mapping[type[syntax.Node], Kind] = {
    syntax.Types: Kind.TYPE,
    syntax.Constants: Kind.OBJECT,
    syntax.Objects: Kind.OBJECT,
}
"""Holders of groups that list something else than variables."""


@dataclass(frozen=True, slots=True)
class _Around:
    """What holds a node: the kind that its groups list, the function that its values belong to, and where
    each variable was bound (the innermost binding counts)."""

    listed: Kind = Kind.VARIABLE
    function: str = ""
    bound: Mapping[str, str] | None = None


def names_in(source: Source) -> tuple[Occurrence, ...]:
    """Every name of a text in its order; raises Refused (E105) for what is no .nid text."""
    root = parse(source).root
    found = [] if root is None else list(_names(root, _Around()))
    return tuple(sorted(found, key=lambda occurrence: occurrence.span.start))


def occurrences(source: Source, offset: int) -> tuple[Occurrence, ...]:
    """All occurrences, in this text, of what is named at an offset (or ends there); none where no name is."""
    names = names_in(source)
    for name in names:
        if name.span.start - (name.kind is Kind.VARIABLE) <= offset <= name.span.end:
            return tuple(other for other in names if other.thing == name.thing)
    return ()


def _names(node: syntax.Node, outside: _Around) -> Iterator[Occurrence]:
    around = _inside(node, outside)
    for field in fields(node):
        value = getattr(node, field.name)
        for part in value if isinstance(value, tuple) else (value,):
            match part:
                case syntax.Name():
                    yield _named(node, field.name, part, around)
                case syntax.TermNode():
                    yield _term(part, around, declares=isinstance(node, syntax.RuleNode))
                case syntax.Setting(key, syntax.Word(text)) if key.text == "domain":
                    yield Occurrence(Kind.DOMAIN, text, "", part.value.span)
                    yield Occurrence(Kind.WORD, key.text, "", key.span)
                case syntax.Node():
                    yield from _names(part, around)


def _inside(node: syntax.Node, around: _Around) -> _Around:
    """What is around the parts of a node: its groups and its terms bind, its symbol owns the values."""
    listed = _GROUPS.get(type(node), around.listed if isinstance(node, syntax.Group) else Kind.VARIABLE)
    bound = {**(around.bound or {}), **dict.fromkeys(_bound_by(node), str(node.span.start))}
    function = around.function
    match node:
        case syntax.FunctionNode():
            function = node.name.text
        case syntax.Comparison() | syntax.SetValue() | syntax.FactNode():
            function = node.application.symbol.text
    return _Around(listed, function, bound)


def _bound_by(node: syntax.Node) -> Iterator[str]:
    """Variables that a node binds for all that stands in it: a rule's terms, the groups of anything."""
    if isinstance(node, syntax.RuleNode):
        yield from (term.name for term in node.terms if term.is_variable)
    for field in fields(node):
        value = getattr(node, field.name)
        if type(node) not in _GROUPS and isinstance(value, tuple):
            yield from (n.text for group in value if isinstance(group, syntax.Group) for n in group.names)


def _named(node: syntax.Node, field: str, name: syntax.Name, around: _Around) -> Occurrence:
    if isinstance(node, syntax.Group) and field == "names":
        kind = around.listed
        span = Span(name.span.path, name.span.start + (kind is Kind.VARIABLE), name.span.end)
        return Occurrence(kind, name.text, _owner(kind, name.text, around), span, declares=True)
    place = (type(node), field)
    if place not in DECLARATIONS and place not in USES:
        raise LookupError(f"nothing says what the names in `{type(node).__name__}.{field}` mean")
    kind = DECLARATIONS.get(place) or USES[place]
    return Occurrence(kind, name.text, _owner(kind, name.text, around), name.span, place in DECLARATIONS)


def _term(term: syntax.TermNode, around: _Around, declares: bool) -> Occurrence:
    kind = Kind.VARIABLE if term.is_variable else Kind.OBJECT
    start = term.span.start + term.is_variable
    span = Span(term.span.path, start, term.span.end)
    return Occurrence(kind, term.name, _owner(kind, term.name, around), span, declares and term.is_variable)


def _owner(kind: Kind, name: str, around: _Around) -> str:
    if kind is Kind.VALUE:
        return around.function
    return (around.bound or {}).get(name, "") if kind is Kind.VARIABLE else ""
