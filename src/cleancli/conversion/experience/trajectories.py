"""Experience as trajectories of PDDL, which tools write and read that learn action models.

`(:trajectory (:objects a - block) (:init (on a)) (:action (lift a)) (:state (held a)) ...)`: a state, and
then an action and a state in turn. What a state does not name is false there. The head may be missing, states
may say `(not (p a))`, `(operator: (lift a))` is an action too, and a file may hold several trajectories.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from cleancli.compiler.fluents import Values
from cleancli.conversion.experience.chains import Called, Chain
from cleancli.conversion.experience.vocabulary import Meaning, Vocabulary, meanings_of, values_of
from cleancli.conversion.export.names import Naming
from cleancli.conversion.export.ppddl_formulas import WORDS, FormulaWriter, predicates_of
from cleancli.conversion.export.s_expressions import Node as Said
from cleancli.conversion.export.s_expressions import laid_out
from cleancli.conversion.pddl.naming import readable
from cleancli.conversion.pddl.read_conditions import Reader, Unreadable, number_in
from cleancli.conversion.pddl.syntax import Name
from cleancli.conversion.pddl.words import Group, Node, Word, groups_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import Action, Domain, Object, Symbol

_HEADS = ("trajectory", ":trajectory")
_STATES = (":init", ":state")
_ACTIONS = (":action", "operator:", ":operator")


class TrajectoryWriter:
    """Writes chains under the names that the PPDDL of their domain has (`conversion.export.ppddl`)."""

    def __init__(self, domain: Domain) -> None:
        self._symbols = {symbol.name: symbol for symbol in domain.symbols}
        self._vocabulary = vocabulary_of(domain)
        self._texts = FormulaWriter(domain)
        self._actions = Naming(WORDS, folded=True)

    def text(self, chain: Chain) -> str:
        """The trajectory that a chain is."""
        first, *later = ((":state", *self._state(values)) for values in chain.states)
        parts: list[Said] = [(":objects", *self._texts.typed_objects(sorted(chain.objects)))]
        parts.append((":init", *first[1:]))
        for (action, names), state in zip(chain.actions, later, strict=True):
            objects = map(self._texts.objects.of, names)
            parts += [(":action", (self._actions.of(action), *objects)), state]
        return laid_out((":trajectory", *parts)) + "\n"

    def _state(self, values: Values) -> Iterator[Said]:
        for predicate, objects in self._vocabulary.atoms(values, self._symbols):
            yield (predicate, *map(self._texts.objects.of, objects))

    @property
    def changed_names(self) -> Mapping[str, str]:
        """The names that could not stay, with what they have become."""
        return {**self._texts.types.changed, **self._texts.objects.changed, **self._actions.changed}


def vocabulary_of(domain: Domain) -> Vocabulary:
    """What the predicates of a domain are called in its PPDDL."""
    naming = predicates_of(domain)
    names = {
        (symbol, value): naming.of(symbol.name, None if symbol.is_predicate else value)
        for symbol, value in meanings_of(domain)
    }
    return Vocabulary(names, {name.lower(): meaning for meaning, name in names.items()})


# ---- and back


@dataclass(frozen=True, slots=True)
class Trajectories:
    """The chains of a file, and its predicates that the domain lacks and that were passed over."""

    chains: tuple[Chain, ...]
    passed_over: tuple[str, ...]


def read_trajectories(
    source: Source, domain: Domain, objects: Sequence[Object], findings: Findings, *, whole: bool
) -> Trajectories:
    """The trajectories of a text; `objects` are those of problems, for files that list none.

    With `whole` each predicate has to be one of the domain. E915 and E916 for what cannot be read, W911 for
    what was mended.
    """
    reader = _Reader(source, domain, objects, findings, whole)
    found = [reader.chain(group) for group in groups_of(source.text, source.path, findings)]
    return Trajectories(tuple(each for each in found if each is not None), tuple(sorted(reader.lacking)))


class _Reader:
    """Reads one text. Names may have hyphens where those of the domain have underscores."""

    def __init__(
        self, source: Source, domain: Domain, objects: Sequence[Object], findings: Findings, whole: bool
    ) -> None:
        self.lacking: set[str] = set()
        self._source, self._domain, self._findings, self._whole = source, domain, findings, whole
        self._reader = Reader(source.path, findings)
        self._given = tuple(each for each in objects if each not in domain.constants)
        self._meanings = vocabulary_of(domain).meanings
        self._alike = {_plain(name): meaning for name, meaning in self._meanings.items()}
        self._symbols = {_plain(symbol.name): symbol for symbol in domain.symbols}
        self._actions = {_plain(action.name): action for action in domain.actions}
        types = FormulaWriter(domain)
        self._types = {_plain(types.type_of(each.name)): each.name for each in domain.types}

    def chain(self, group: Group) -> Chain | None:
        """The chain that a group is; None where it is none, and then that is told."""
        before = self._findings.errors
        parts = [*group.items]
        if parts and isinstance(parts[0], Word) and parts[0].text in _HEADS:
            parts = parts[1:]
        listed = [part for part in parts if isinstance(part, Group) and part.head == ":objects"]
        steps = [part for part in parts if not (isinstance(part, Group) and part.head == ":objects")]
        try:
            found = [thing for part in listed for thing in self._listed(part)] if listed else self._given
        except Unreadable as wrong:
            self._reader.note(wrong)
            return None
        things = tuple(sorted(found))
        known = {each.name.lower(): each for each in (*self._domain.constants, *things)}
        states: list[Values] = []
        actions: list[Called] = []
        for place, step in enumerate(steps):
            try:
                if place % 2 == 0:
                    states.append(self._state(self._section(step, _STATES), known))
                else:
                    actions.append(self._action(self._section(step, _ACTIONS), known))
            except Unreadable as wrong:
                self._reader.note(wrong)
                if wrong.code == "E915":  # what follows is out of step
                    return None
        if len(steps) % 2 == 0:
            end = steps[-1] if steps else group
            self._reader.wrong("no state stands behind this", end, "write `(:state ...)`, what holds then")
        if self._findings.errors > before:
            return None
        return Chain(things, tuple(states), tuple(actions))

    def _section(self, node: Node, heads: Sequence[str]) -> Group:
        if isinstance(node, Word) or node.head not in heads:
            shown = node.text if isinstance(node, Word) else node.head
            wanted = " or ".join(f"`({head} ...)`" for head in heads[:2])
            message = f"expected {wanted}, but there is `{shown}`"
            raise Unreadable(message, self._reader.span(node), "states and actions stand in turn")
        return node

    # ---- objects

    def _listed(self, group: Group) -> Iterator[Object]:
        """The objects of a trajectory that are no constants."""
        constants = {constant.name.lower() for constant in self._domain.constants}
        told: set[str] = set()
        for each in self._reader.typed(group.items[1:]):
            name = self._written(each.name)
            if name.lower() in told:
                raise Unreadable(f"the object `{name}` is listed twice", each.name.span, code="E916")
            told.add(name.lower())
            if name.lower() not in constants:
                yield Object(name, self._type(each.types, each.name))

    def _type(self, types: Sequence[Name], name: Name) -> str:
        wanted = types[0].text if types else "object"
        if len(types) > 1 or _plain(wanted) not in self._types:
            if not types and len(self._domain.types) == 1:
                return self._domain.types[0].name
            message = f"`{self._domain.name}` has no type `{wanted}`"
            known = ", ".join(f"`{each}`" for each in self._types.values())
            raise Unreadable(message, (types[0] if types else name).span, f"known here: {known}", "E916")
        return self._types[_plain(wanted)]

    def _written(self, name: Name) -> str:
        """A name in the letters that stand in the file, as far as .nid files have them."""
        return readable(self._source.text[name.span.start : name.span.end], "o")

    def _names(self, nodes: Sequence[Node], known: Mapping[str, Object]) -> tuple[Object, ...]:
        found = []
        for node in nodes:
            name = self._reader.name(node, "an object")
            thing = known.get(readable(name.text, "o"))
            if thing is None:
                help = "list it in `(:objects ...)`, or give the problem that has it"
                raise Unreadable(f"unknown object `{name.text}`", name.span, help, "E916")
            found.append(thing)
        return tuple(found)

    # ---- states and actions

    def _state(self, group: Group, known: Mapping[str, Object]) -> Values:
        facts: list[tuple[Meaning, tuple[str, ...]]] = []
        for node in group.items[1:]:
            try:
                facts += self._fact(node, known)
            except Unreadable as wrong:
                self._reader.note(wrong)
        try:
            return values_of(facts)
        except ValueError as error:
            raise Unreadable(str(error), self._reader.span(group), code="E916") from None

    def _fact(self, node: Node, known: Mapping[str, Object]) -> Iterator[tuple[Meaning, tuple[str, ...]]]:
        """A fact that holds: none for `(not ...)`, and for a predicate that the domain lacks and may lack."""
        group = self._reader.group(node, "a fact")
        if group.head == "not":
            return
        if group.head == "=" and len(group.items) == 3:
            yield self._valued(group, known)
            return
        atom = self._reader.atom(group)
        name = atom.symbol.text
        meaning = self._meanings.get(name) or self._alike.get(_plain(name))
        if meaning is not None:
            yield meaning, self._fitting(meaning[0], group.items[1:], known, group)
        elif self._whole:
            shown = f"unknown predicate `{name}`"
            raise Unreadable(shown, atom.symbol.span, self._meant(name, self._meanings), "E916")
        else:
            self.lacking.add(name)

    def _valued(self, group: Group, known: Mapping[str, Object]) -> tuple[Meaning, tuple[str, ...]]:
        """`(= (f a) 3)`, of a function whose values are integers."""
        function, value = self._reader.group(group.items[1], "a function"), number_in(group.items[2])
        symbol = self._symbols.get(_plain(function.head))
        if symbol is None or value not in symbol.values or symbol.is_predicate:
            message = f"`{function.head}` is no function of `{self._domain.name}` that has this value"
            raise Unreadable(message, self._reader.span(function), code="E916")
        return (symbol, int(value)), self._fitting(symbol, function.items[1:], known, function)

    def _fitting(
        self, what: Symbol | Action, nodes: Sequence[Node], known: Mapping[str, Object], group: Group
    ) -> tuple[str, ...]:
        """The names of objects that a symbol or an action is for."""
        things = self._names(nodes, known)
        if len(things) != len(what.parameters):
            takes = plural(len(what.parameters), "object")
            message = f"`{what.name}` takes {takes}, not {len(things)}"
            raise Unreadable(message, self._reader.span(group), code="E916")
        for node, thing, parameter in zip(nodes, things, what.parameters, strict=True):
            if not self._domain.is_a(thing.type, parameter.type):
                message = (
                    f"`{thing.name}` is of type `{thing.type}`, and `{what.name}` is for `{parameter.type}`"
                )
                raise Unreadable(message, self._reader.span(node), code="E916")
        return tuple(thing.name for thing in things)

    def _action(self, group: Group, known: Mapping[str, Object]) -> Called:
        """`(:action (lift a))` or `(:action lift a)`; the schema of a rule is its action."""
        inner = group.items[1] if len(group.items) == 2 else None
        called = inner.items if isinstance(inner, Group) else group.items[1:]
        if not called:
            raise Unreadable("an action has a name", self._reader.span(group), code="E916")
        name = self._reader.name(called[0], "the name of an action")
        action = self._actions.get(_plain(name.text.split("--")[0]))
        if action is None:
            message = f"unknown action `{name.text}`"
            raise Unreadable(message, name.span, self._meant(name.text, self._actions), "E916")
        return action.name, self._fitting(action, called[1:], known, group)

    def _meant(self, name: str, known: Mapping[str, object]) -> str:
        return self._findings.meant(name, known, "name")


def _plain(name: str) -> str:
    return readable(name.lower(), "n")
