"""Checks types and typed names, and keeps what a domain declares by name.

Guaranteed by the parser: structure. What is returned holds everything that could be understood.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from cleancli.language import syntax
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.sink import RESERVED, Findings
from cleancli.language.model import Action, DerivedPredicate, Object, Parameter, Symbol, Type, Variable

_T = TypeVar("_T")

SECTIONS: Mapping[type[syntax.Node], str] = {
    syntax.Include: "include",
    syntax.Types: "types",
    syntax.Constants: "constants",
    syntax.Predicates: "predicates",
    syntax.Functions: "functions",
    syntax.Derived: "derived",
    syntax.Shared: "parameters",
    syntax.Actions: "actions",
    syntax.RuleNode: "rule",
    syntax.Default: "default",
    syntax.Reward: "reward",
    syntax.Learned: "learned",
}


@dataclass(frozen=True, slots=True)
class Declarations:
    """What a domain declares, by name, in the order of the file.

    `symbols` holds derived predicates too, as if they were predicates; of counts only the names are known,
    which no condition may use. `unsure` holds the sections that could
    not be read: a name that may have been declared there is no mistake.
    """

    types: Mapping[str, Type]
    constants: Mapping[str, Object] = field(default_factory=dict)
    symbols: Mapping[str, Symbol] = field(default_factory=dict)
    actions: Mapping[str, Action] = field(default_factory=dict)
    derived: Mapping[str, DerivedPredicate] = field(default_factory=dict)
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    counts: frozenset[str] = frozenset()
    unsure: frozenset[str] = frozenset()

    def is_a(self, type_name: str, ancestor: str) -> bool:
        """Whether `type_name` is `ancestor` or below it; unknown types fit everywhere."""
        current: str | None = type_name
        while current is not None:
            if current == ancestor:
                return True
            if current not in self.types:
                return True
            current = self.types[current].parent
        return ancestor not in self.types

    def meet(self, one: str, other: str) -> str | None:
        """The lower of two types, None where no object can have both."""
        if self.is_a(one, other):
            return one
        return other if self.is_a(other, one) else None


class Once:
    """Names of one kind that may be declared once."""

    def __init__(self, findings: Findings) -> None:
        self._findings = findings
        self._first: dict[str, Span] = {}

    def admits(self, name: syntax.Name, what: str) -> bool:
        """Note the name; False, with E202 or E214 reported, if it is taken or reserved."""
        if name.text in RESERVED:
            self._findings.error(
                "E214",
                f"`{name.text}` is a word of the language",
                name.span,
                help=f"choose another name for this {what}",
            )
            return False
        if name.text in self._first:
            self._findings.error(
                "E202",
                f"the {what} `{'?' * (what == 'variable')}{name.text}` is declared twice",
                name.span,
                help=f"it was first declared in {self._findings.line(self._first[name.text])}",
            )
            self._findings.unclear.add((what, name.text))
            return False
        self._first[name.text] = name.span
        return True


def sections_of(sections: Iterable[object], kind: type[_T]) -> tuple[_T, ...]:
    """The sections of one kind."""
    return tuple(s for s in sections if isinstance(s, kind))


def refuse_repeated(
    sections: Iterable[syntax.Node],
    names: Mapping[type[syntax.Node], str],
    many: frozenset[str],
    findings: Findings,
) -> None:
    """Report sections of one file that may stand once and stand twice (E216); `many` may stand often."""
    seen: dict[str, Span] = {}
    for section in sections:
        name = names[type(section)]
        if name in seen and name not in many:
            start = section.span.start
            findings.error(
                "E216",
                f"a second `{name}`",
                Span(section.span.path, start, start + len(name)),
                help=f"the first stands in {findings.line(seen[name])}",
            )
        seen.setdefault(name, section.span)


def without_point(*numbers: syntax.Number) -> str:
    """The help for `5.0` where an integer is wanted; empty for other numbers."""
    for number in numbers:
        if number.value.denominator == 1 and not number.is_whole:
            return f"integers are written without a point: `{number.value}`"
    return ""


def unsure_sections(findings: Findings) -> frozenset[str]:
    """The sections that may declare more than was read: all, where a whole file or block is missing."""
    unsure = findings.broken
    everything = frozenset(SECTIONS.values())
    return unsure if unsure <= everything - {"include"} else everything


def read_types(node: syntax.DomainNode, findings: Findings) -> Declarations:
    """The tree of types (E201, E202, E215), and nothing else yet."""
    unsure = unsure_sections(findings)
    before = findings.errors
    types = _types(node, findings)
    if findings.errors > before:
        unsure |= {"types"}
    return Declarations(types, unsure=unsure)


def _types(node: syntax.DomainNode, findings: Findings) -> dict[str, Type]:
    once = Once(findings)
    groups = [group for section in sections_of(node.sections, syntax.Types) for group in section.groups]
    named = [(name, group.type) for group in groups for name in group.names if once.admits(name, "type")]
    places = {name.text: place for place, (name, _) in enumerate(named)}
    circles = _circles({name.text: parent.text for name, parent in named if parent is not None})
    first_in_circle = {min(circle, key=places.__getitem__) for circle in circles}
    types: dict[str, Type] = {}
    for name, parent in named:
        if name.text in first_in_circle:
            message, help = f"the type `{name.text}` is below itself", "types form a tree: remove one parent"
            findings.error("E215", message, name.span, help=help)
            parent = None
        types[name.text] = Type(name.text, _known_parent(parent, places, findings))
    return types


def _known_parent(parent: syntax.Name | None, known: Collection[str], findings: Findings) -> str | None:
    """The name of the type above another; None where there is none, or one that is not declared (E201)."""
    if parent is None:
        return None
    if parent.text in known:
        findings.use("type", parent.text)
        return parent.text
    if parent.text == "object":
        help = "no type stands above all others: leave `- object` out"
        findings.error("E201", "unknown type `object`", parent.span, help=help)
    else:
        findings.unknown("E201", "type", parent.text, parent.span, known)
    return None


def _circles(parents: Mapping[str, str]) -> Iterator[list[str]]:
    """The circles that types form with those above them. No type is passed twice."""
    passed: set[str] = set()
    for start in parents:
        line: list[str] = []
        here: str | None = start
        while here is not None and here not in passed:
            passed.add(here)
            line.append(here)
            here = parents.get(here)
        if here in line:
            yield line[line.index(here) :]


def _known_type(name: syntax.Name | None, declared: Declarations, findings: Findings) -> str:
    assert name is not None  # the grammar lets only `types` leave it out
    if name.text not in declared.types and "types" not in declared.unsure:
        findings.unknown("E201", "type", name.text, name.span, declared.types)
    findings.use("type", name.text)
    return name.text


def read_objects(
    groups: Iterable[syntax.Group], declared: Declarations, once: Once, what: str, findings: Findings
) -> dict[str, Object]:
    """The objects that typed lists name."""
    objects = {}
    for group in groups:
        type_name = _known_type(group.type, declared, findings)
        for name in group.names:
            if once.admits(name, what):
                objects[name.text] = Object(name.text, type_name)
    return objects


def read_variables(
    groups: Iterable[syntax.Group], declared: Declarations, findings: Findings
) -> tuple[Variable, ...]:
    """The variables that typed lists name; each name once (E202).

    One that is refused stays in the list: nothing that has the parameters is then wrong in their number.
    """
    once = Once(findings)
    variables = []
    for group in groups:
        type_name = _known_type(group.type, declared, findings)
        for name in group.names:
            once.admits(name, "variable")
            variables.append(Variable(name.text, type_name))
    return tuple(variables)
