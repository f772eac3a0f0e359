"""Every name of a text and what it stands for: the one index behind rename, completion and the editor.

Guaranteed by the parser: structure; sections that could not be read are missing, and so are their names. The
tree is walked by its fields, so that a new kind of node needs a row in the tables below and nothing else.
"""

from __future__ import annotations

import enum
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from cleancli.language import syntax
from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.parsing.parse import parse


class Kind(enum.Enum):
    """What a name can stand for."""

    DOMAIN = "domain"
    PROBLEM = "problem"
    SCENE = "scene"
    STUDY = "study"
    TYPE = "type"
    OBJECT = "object"
    SYMBOL = "symbol"
    VALUE = "value"
    COUNT = "count"
    PARAMETER = "parameter"
    ACTION = "action"
    RULE = "rule"
    VARIABLE = "variable"
    MARK = "mark"
    SECTION = "section"
    KEY = "key"
    WORD = "word"
    FILE = "file"
    FOLDER = "folder"


@dataclass(frozen=True, slots=True)
class Meaning:
    """What makes two occurrences one thing. `home` keeps apart what may share a name: the function of a
    value, the place where a variable is bound, the problem of an object (empty for a constant)."""

    kind: Kind
    name: str
    home: str = ""


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A name at a place (with the `?` of a variable); `node` is the part of the text that holds it, `section`
    the place of the section around it."""

    meaning: Meaning
    span: Span
    declares: bool
    node: syntax.Node
    section: Span


Leaf = syntax.Name | syntax.TermNode | syntax.Word
"""The nodes that are a name."""

DECLARED: Mapping[tuple[type[syntax.Node], str], Kind] = {
    (syntax.DomainNode, "name"): Kind.DOMAIN,
    (syntax.ProblemNode, "name"): Kind.PROBLEM,
    (syntax.SceneNode, "name"): Kind.SCENE,
    (syntax.StudyNode, "name"): Kind.STUDY,
    (syntax.PredicateNode, "name"): Kind.SYMBOL,
    (syntax.FunctionNode, "name"): Kind.SYMBOL,
    (syntax.FunctionNode, "values"): Kind.VALUE,
    (syntax.CountNode, "name"): Kind.COUNT,
    (syntax.DefinitionNode, "name"): Kind.SYMBOL,
    (syntax.ClosureNode, "name"): Kind.SYMBOL,
    (syntax.ParameterNode, "name"): Kind.PARAMETER,
    (syntax.ActionNode, "name"): Kind.ACTION,
    (syntax.RuleNode, "name"): Kind.RULE,
    (syntax.Section, "title"): Kind.WORD,
}
"""Fields that declare what they name; those of a `Group` depend on where it stands."""

USED: Mapping[tuple[type[syntax.Node], str], Kind] = {
    (syntax.Group, "type"): Kind.TYPE,
    (syntax.Attribute, "name"): Kind.MARK,
    (syntax.Application, "symbol"): Kind.SYMBOL,
    (syntax.Comparison, "value"): Kind.VALUE,
    (syntax.SetValue, "value"): Kind.VALUE,
    (syntax.FactNode, "value"): Kind.VALUE,
    (syntax.ClosureNode, "of"): Kind.SYMBOL,
    (syntax.RuleNode, "action"): Kind.ACTION,
    (syntax.Share, "name"): Kind.PARAMETER,
    (syntax.PayNode, "what"): Kind.MARK,
    (syntax.Decrease, "count"): Kind.COUNT,
    (syntax.CountValue, "count"): Kind.COUNT,
    (syntax.HorizonNode, "count"): Kind.COUNT,
    (syntax.DomainName, "name"): Kind.DOMAIN,
    (syntax.Section, "name"): Kind.SECTION,
    (syntax.Setting, "key"): Kind.KEY,
    (syntax.Setting, "value"): Kind.WORD,
    (syntax.Listed, "key"): Kind.KEY,
    (syntax.Listed, "values"): Kind.WORD,
    (syntax.Call, "name"): Kind.WORD,
}
"""Fields that use what they name."""

_LISTS: Mapping[type[syntax.Node], Kind] = {
    syntax.Types: Kind.TYPE,
    syntax.Constants: Kind.OBJECT,
    syntax.Objects: Kind.OBJECT,
}
"""What the groups of a section list; everywhere else groups bind variables."""

Trail = tuple[syntax.Node, ...]
"""The nodes around a name, outermost first."""


def names_in(source: Source) -> tuple[Occurrence, ...]:
    """Every name of a text in its order; raises Refused (E105) for what is no .nid text."""
    root = parse(source).root
    return () if root is None else occurrences(root)


def occurrences(root: syntax.Root) -> tuple[Occurrence, ...]:
    """Every name of a file in the order of the text."""
    found = tuple(_leaves(root, ()))
    reader = _Reader(root, found)
    read = (reader.read(field, leaf, trail) for field, leaf, trail in found)
    return tuple(sorted(read, key=lambda occurrence: occurrence.span.start))


def children(node: syntax.Node) -> Iterator[tuple[str, syntax.Node]]:
    """The nodes directly inside a node, each with the field that holds it."""
    for field in node.__dataclass_fields__:
        value = getattr(node, field)
        for child in value if isinstance(value, tuple) else (value,):
            if isinstance(child, syntax.Node):
                yield field, child


def _leaves(node: syntax.Node, around: Trail) -> Iterator[tuple[str, Leaf, Trail]]:
    trail = (*around, node)
    for field, child in children(node):
        if isinstance(child, Leaf):
            yield field, child, trail
        else:
            yield from _leaves(child, trail)


def _is_binding(field: str, leaf: Leaf, trail: Trail) -> bool:
    """Whether a variable is bound here: in a typed list, or among the terms of a rule's action."""
    if isinstance(trail[-1], syntax.Group):
        return field == "names" and type(trail[-2]) not in _LISTS
    return isinstance(trail[-1], syntax.RuleNode) and isinstance(leaf, syntax.TermNode) and leaf.is_variable


def _binder(trail: Trail) -> syntax.Node:
    """The node in whose text a variable that is bound here is known: all of a rule for its references."""
    holder = trail[-2] if isinstance(trail[-1], syntax.Group) else trail[-1]
    return trail[-3] if isinstance(holder, syntax.ReferenceNode) else holder


def _section(trail: Trail) -> Span:
    return (trail[1] if len(trail) > 1 else trail[0]).span


def _text(leaf: Leaf) -> str:
    return leaf.name if isinstance(leaf, syntax.TermNode) else leaf.text


class _Reader:
    """Says of each leaf of one file what it means."""

    def __init__(self, root: syntax.Root, leaves: Iterable[tuple[str, Leaf, Trail]]) -> None:
        self._root = root
        self._binders: dict[str, list[syntax.Node]] = {}
        self._objects: set[str] = set()
        for field, leaf, trail in leaves:
            if _is_binding(field, leaf, trail):
                self._binders.setdefault(_text(leaf), []).append(_binder(trail))
            elif field == "names" and isinstance(trail[-2], syntax.Objects):
                self._objects.add(_text(leaf))

    def read(self, field: str, leaf: Leaf, trail: Trail) -> Occurrence:
        """The occurrence of a leaf."""
        owner, text = trail[-1], _text(leaf)
        declares = _is_binding(field, leaf, trail) or field == "names" or (type(owner), field) in DECLARED
        if _is_binding(field, leaf, trail) or (isinstance(leaf, syntax.TermNode) and leaf.is_variable):
            meaning = Meaning(Kind.VARIABLE, text, self._home_of_variable(text, trail))
        else:
            meaning = self._meaning(self._kind(field, leaf, trail), text, owner)
        return Occurrence(meaning, leaf.span, declares, owner, _section(trail))

    def _kind(self, field: str, leaf: Leaf, trail: Trail) -> Kind:
        """What a leaf that is no variable stands for."""
        owner = trail[-1]
        if isinstance(leaf, syntax.TermNode):
            return Kind.OBJECT
        if isinstance(owner, syntax.Group) and field == "names":
            return _LISTS[type(trail[-2])]
        of_scene = isinstance(self._root, syntax.SceneNode) and len(trail) == 2 and field == "value"
        if of_scene and isinstance(owner, syntax.Setting) and owner.key.text == "domain":
            return Kind.DOMAIN
        return (DECLARED if (type(owner), field) in DECLARED else USED)[type(owner), field]

    def _meaning(self, kind: Kind, text: str, owner: syntax.Node) -> Meaning:
        home = ""
        if kind is Kind.VALUE:
            home = owner.name.text if isinstance(owner, syntax.FunctionNode) else _function_of(owner)
        elif kind is Kind.OBJECT and text in self._objects:
            home = self._root.span.path
        elif kind in (Kind.KEY, Kind.WORD):
            home = owner.key.text if isinstance(owner, syntax.Setting | syntax.Listed) else ""
            # `grasp NAME { ... }` declares what `grasp = NAME` uses, `part` and `compare` likewise.
            home = owner.name.text if isinstance(owner, syntax.Section) and kind is Kind.WORD else home
        return Meaning(kind, text, home)

    def _home_of_variable(self, text: str, trail: Trail) -> str:
        """The place of the innermost node around that binds it, else of the section."""
        binders = self._binders.get(text, [])
        for node in reversed(trail):
            if any(binder is node for binder in binders):
                return str(node.span.start)
        return str(_section(trail).start)


def _function_of(owner: syntax.Node) -> str:
    """The function that a value is compared with or set for."""
    for _, child in children(owner):
        if isinstance(child, syntax.Application):
            return child.symbol.text
    return ""
