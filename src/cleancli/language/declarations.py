"""The first half of the check: types, constants, predicates, functions and actions of a domain.

Guaranteed by the parser: structure. What is returned holds everything that could be understood.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from cleancli.language import syntax
from cleancli.language.diagnostics import Span
from cleancli.language.findings import RESERVED, Findings
from cleancli.language.model import Action, Object, Symbol, Type, Variable

_T = TypeVar("_T")

SECTIONS = {
    syntax.Types: "types",
    syntax.Constants: "constants",
    syntax.Predicates: "predicates",
    syntax.Functions: "functions",
    syntax.Derived: "derived",
    syntax.Actions: "actions",
    syntax.RuleNode: "rule",
    syntax.Default: "default",
    syntax.Reward: "reward",
}


@dataclass(frozen=True, slots=True)
class Declarations:
    """What a domain declares, by name, in the order of the file. `unsure` holds the sections that could not
    be read: a name that may have been declared there is no mistake."""

    types: Mapping[str, Type]
    constants: Mapping[str, Object] = field(default_factory=dict)
    symbols: Mapping[str, Symbol] = field(default_factory=dict)
    actions: Mapping[str, Action] = field(default_factory=dict)
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
            line = self._findings.line(self._first[name.text])
            self._findings.error(
                "E202",
                f"the {what} `{name.text}` is declared twice",
                name.span,
                help=f"it was first declared in line {line}",
            )
            return False
        self._first[name.text] = name.span
        return True


def sections_of(sections: Iterable[object], kind: type[_T]) -> tuple[_T, ...]:
    """The sections of one kind."""
    return tuple(s for s in sections if isinstance(s, kind))


def declare(node: syntax.DomainNode, findings: Findings) -> Declarations:
    """Read every declaration of a domain but the derived counts; mistakes are E201, E202 and E212 to E216."""
    unsure = findings.broken
    if not unsure <= set(SECTIONS.values()):
        unsure = frozenset(SECTIONS.values())
    _refuse_repeated(node, findings)
    before = findings.count
    types = _types(node, findings)
    if findings.count > before:
        unsure |= {"types"}
    declared = Declarations(types, unsure=unsure)
    constants = read_objects(
        [g for s in sections_of(node.sections, syntax.Constants) for g in s.groups],
        declared,
        Once(findings),
        "constant",
        findings,
    )
    once = Once(findings)
    symbols = _predicates(node, declared, once, findings) | _functions(node, declared, once, findings)
    actions = _actions(node, declared, findings)
    return Declarations(declared.types, constants, symbols, actions, unsure)


def _refuse_repeated(node: syntax.DomainNode, findings: Findings) -> None:
    seen: dict[str, Span] = {}
    for section in node.sections:
        name = SECTIONS[type(section)]
        if name in seen and name != "rule":
            start = section.span.start
            findings.error(
                "E216",
                f"a second `{name}` block",
                Span(section.span.path, start, start + len(name)),
                help=f"add its lines to the block in line {findings.line(seen[name])}",
            )
        seen.setdefault(name, section.span)


def _types(node: syntax.DomainNode, findings: Findings) -> dict[str, Type]:
    once = Once(findings)
    parents: dict[str, syntax.Name | None] = {}
    names: dict[str, syntax.Name] = {}
    for section in sections_of(node.sections, syntax.Types):
        for group in section.groups:
            for name in group.names:
                if once.admits(name, "type"):
                    parents[name.text] = group.type
                    names[name.text] = name
    types = {}
    for text, parent in tuple(parents.items()):
        if parent is not None and parent.text not in parents:
            findings.unknown("E201", "type", parent.text, parent.span, parents)
            parent = None
        if parent is not None and _is_above_itself(text, parents):
            findings.error(
                "E215",
                f"the type `{text}` is below itself",
                names[text].span,
                help="types form a tree: remove one parent",
            )
            parents[text] = parent = None
        types[text] = Type(text, None if parent is None else parent.text)
    return types


def _is_above_itself(name: str, parents: Mapping[str, syntax.Name | None]) -> bool:
    current = parents.get(name)
    for _ in parents:
        if current is None or current.text == name:
            break
        current = parents.get(current.text)
    return current is not None and current.text == name


def _known_type(name: syntax.Name | None, declared: Declarations, findings: Findings) -> str:
    assert name is not None  # the grammar lets only `types` leave it out
    if name.text not in declared.types and "types" not in declared.unsure:
        findings.unknown("E201", "type", name.text, name.span, declared.types)
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
    """The variables that typed lists name; each name once (E202)."""
    once = Once(findings)
    variables = []
    for group in groups:
        type_name = _known_type(group.type, declared, findings)
        for name in group.names:
            if once.admits(name, "variable"):
                variables.append(Variable(name.text, type_name))
    return tuple(variables)


def _predicates(
    node: syntax.DomainNode, declared: Declarations, once: Once, findings: Findings
) -> dict[str, Symbol]:
    symbols = {}
    for section in sections_of(node.sections, syntax.Predicates):
        for predicate in section.predicates:
            parameters = read_variables(predicate.parameters, declared, findings)
            symmetric = _is_symmetric(predicate, parameters, findings)
            if once.admits(predicate.name, "predicate"):
                symbols[predicate.name.text] = Symbol(predicate.name.text, parameters, symmetric=symmetric)
    return symbols


def _is_symmetric(
    predicate: syntax.PredicateNode, parameters: tuple[Variable, ...], findings: Findings
) -> bool:
    symmetric = False
    for attribute in predicate.attributes:
        if attribute.name.text != "symmetric":
            findings.unknown("E213", "mark", attribute.name.text, attribute.name.span, ["symmetric"])
        elif attribute.value is not None:
            findings.error("E213", "`symmetric` takes no value", attribute.value.span)
        elif len(parameters) != 2 or parameters[0].type != parameters[1].type:
            findings.error(
                "E212",
                f"`{predicate.name.text}` cannot be symmetric",
                attribute.span,
                help="a symmetric predicate has two parameters of one type",
            )
        else:
            symmetric = True
    return symmetric


def _functions(
    node: syntax.DomainNode, declared: Declarations, once: Once, findings: Findings
) -> dict[str, Symbol]:
    symbols = {}
    for section in sections_of(node.sections, syntax.Functions):
        for function in section.functions:
            parameters = read_variables(function.parameters, declared, findings)
            admitted = Once(findings)
            values = tuple(v.text for v in function.values if admitted.admits(v, "value"))
            if len(function.values) < 2:
                findings.error(
                    "E217",
                    f"`{function.name.text}` has one value only",
                    function.span,
                    help="a function has at least two values: `low < high`",
                )
            if once.admits(function.name, "function"):
                symbols[function.name.text] = Symbol(function.name.text, parameters, values)
    return symbols


def _actions(node: syntax.DomainNode, declared: Declarations, findings: Findings) -> dict[str, Action]:
    once = Once(findings)
    actions = {}
    for section in sections_of(node.sections, syntax.Actions):
        for action in section.actions:
            parameters = read_variables(action.parameters, declared, findings)
            duration = _duration(action, findings)
            if once.admits(action.name, "action"):
                actions[action.name.text] = Action(action.name.text, parameters, duration)
    return actions


def _duration(action: syntax.ActionNode, findings: Findings) -> float | None:
    duration = None
    for attribute in action.attributes:
        value = attribute.value
        if attribute.name.text != "duration":
            findings.unknown("E213", "mark", attribute.name.text, attribute.name.span, ["duration"])
        elif duration is not None:
            findings.error("E213", "a second duration", attribute.span)
        elif value is None or value.unit != "s":
            findings.error(
                "E213",
                "a duration is a number of seconds",
                attribute.span,
                help="write for example `duration = 9 s`",
            )
        elif value.value <= 0:
            findings.error("E213", "a duration must be above 0 s", value.span)
        else:
            duration = float(value.value)
    return duration
