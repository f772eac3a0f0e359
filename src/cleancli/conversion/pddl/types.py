"""The types of a PDDL domain as a tree, which is what a .nid file has.

`object` stands above all others. It is a type of the .nid file only where something is of it and of none
below it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import reduce

from cleancli.conversion.pddl.naming import Naming
from cleancli.conversion.pddl.syntax import DomainNode, Name, Typed
from cleancli.language.diagnostics.sink import Findings, meant
from cleancli.language.model import Term, Variable

OBJECT = "object"


class Types:
    """The tree, under the names of .nid files: each type but `object` is directly below another.

    `mentioned` holds the types that something is of.
    """

    def __init__(self, domain: DomainNode, findings: Findings, naming: Naming) -> None:
        self._findings = findings
        self._naming = naming
        self._parents: dict[str, str] = {}
        self.mentioned: set[str] = set()
        self._found: dict[tuple[str, ...], tuple[str, tuple[str, ...]]] = {}
        declared: dict[str, Typed] = {}
        for each in domain.types:
            name = self._name(each.name)
            if name in declared and declared[name] == each:
                findings.warning(
                    "W911", f"the type `{name}` is declared twice", each.name.span, "passed over"
                )
            elif name in declared and declared[name].types and each.types:
                findings.error("E916", f"the type `{name}` is below two others", each.name.span)
            elif name != OBJECT and (name not in declared or each.types):
                declared[name] = each
        # A type that others are below of is declared by that.
        above = [self._name(name) for each in domain.types for name in each.types]
        self._parents = dict.fromkeys([*above, *declared], OBJECT)
        self._parents.pop(OBJECT, None)
        for name, each in declared.items():
            self._parents[name] = self._parent(each)
        rooted = {OBJECT}
        for name, each in declared.items():
            self._refuse_circle(name, each, rooted)

    def _name(self, name: Name) -> str:
        return OBJECT if name.text == OBJECT else self._naming.of(name, "t")

    def _parent(self, typed: Typed) -> str:
        if len(typed.types) > 1:
            message = f"`{typed.name.text}` is below several types, and a .nid file's types form a tree"
            self._findings.error("E917", message, typed.types[0].span)
        return self._known(typed.types[0]) if typed.types else OBJECT

    def _known(self, name: Name) -> str:
        """The type of a name; one that is not declared is below `object`, unless it is nearly another's."""
        known = self._name(name)
        if known not in self._parents and known != OBJECT:
            help = meant(known, self._parents, "type")
            self._parents[known] = OBJECT
            if help.startswith("did you mean"):
                self._findings.error("E916", f"unknown type `{known}`", name.span, help=help)
            else:
                self._findings.warning(
                    "W911", f"the type `{known}` is not declared", name.span, "taken as one"
                )
        return known

    def _refuse_circle(self, name: str, place: Typed, rooted: set[str]) -> None:
        """E916 for a type that is below itself; those that are known not to be are `rooted`. One that is
        below such a circle is told of when the circle's own types are looked at."""
        seen: set[str] = set()
        here = name
        while here not in rooted and here not in seen:
            seen.add(here)
            here = self._parents[here]
        if here == name and name not in rooted:
            self._findings.error("E916", f"the type `{name}` is below itself", place.name.span)
            self._parents[name] = OBJECT
        if here == name or here in rooted:
            rooted |= seen

    @property
    def declared(self) -> Mapping[str, str]:
        """All types but `object`, each with the one above it."""
        return self._parents

    def line(self, name: str) -> list[str]:
        """A type and those above it, `object` last."""
        found = [name]
        while found[-1] != OBJECT:
            found.append(self._parents[found[-1]])
        return found

    def is_a(self, name: str, ancestor: str) -> bool:
        """Whether a type is another, or below it."""
        while name not in (ancestor, OBJECT):
            name = self._parents[name]
        return name == ancestor

    def may_be_one(self, one: Term, other: Term) -> bool:
        """Whether the types of two terms allow that they are one object: an object is of its own type, a
        variable stands for one of its type or of any below."""
        return (isinstance(other, Variable) and self.is_a(one.type, other.type)) or (
            isinstance(one, Variable) and self.is_a(other.type, one.type)
        )

    def above(self, names: Iterable[str]) -> str:
        """The lowest type that is above all of these, or one of them."""
        return reduce(lambda one, other: next(t for t in self.line(one) if self.is_a(other, t)), names)

    def of(self, types: Sequence[Name]) -> tuple[str, tuple[str, ...]]:
        """The one type of what is `either` of these, and which of the types below that it is (none: any)."""
        said = tuple([name.text for name in types])
        if said not in self._found:
            members = tuple(dict.fromkeys(self._known(name) for name in types)) or (OBJECT,)
            others = set(members)
            highest = tuple(each for each in members if others.isdisjoint(self.line(each)[1:]))
            one = self.above(highest)
            self.mentioned.update((one, *highest))
            self._found[said] = one, (highest if len(highest) > 1 else ())
        return self._found[said]
