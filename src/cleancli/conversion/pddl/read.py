"""PPDDL texts to syntax: every mistake is located, and one hides only its own section, action or fact.

That names are declared and fit is checked in `declared`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from cleancli.conversion.pddl.read_conditions import Reader, Unreadable
from cleancli.conversion.pddl.read_effects import are_facts, effect_of, initial_of
from cleancli.conversion.pddl.syntax import (
    ActionNode,
    AllNode,
    AndNode,
    ChanceNode,
    ConditionNode,
    DomainNode,
    FactsNode,
    MetricNode,
    Name,
    ProblemNode,
    SetNode,
    Signature,
    ValueNode,
)
from cleancli.conversion.pddl.words import Group, Node, Word, groups_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.sink import Findings

_PASSED_OVER = frozenset({":requirements"})
_DOMAIN_SECTIONS = (":types", ":constants", ":predicates", ":functions", ":action", ":requirements")
_PROBLEM_SECTIONS = (
    ":domain", ":objects", ":init", ":goal", ":metric", ":goal-reward", ":goal-probability", ":requirements",
)  # fmt: skip
_UNSAID = {
    ":durative-action": "actions with durations",
    ":derived": "derived predicates",
    ":constraints": "constraints on the course of a plan",
}
"""What PDDL has, PPDDL does not, and is not converted."""


_Sections = Mapping[str, Sequence[Group]]
"""The sections of a domain or problem by the word that they begin with."""


_JOIN = "join conditions by `and`"


def read(source: Source, findings: Findings) -> tuple[tuple[DomainNode, ...], tuple[ProblemNode, ...]]:
    """The domains and problems of a text; E915 and E917 for what cannot be read, W911 for what was mended."""
    reader = Reader(source.path, findings)
    domains, problems = [], []
    for name, sections in _definitions(groups_of(source.text, source.path, findings), reader):
        is_domain = name.head == "domain"
        known = _DOMAIN_SECTIONS if is_domain else _PROBLEM_SECTIONS
        kept = _by_head([section for section in sections if _is_known(section, known, reader)])
        try:
            if is_domain:
                domains.append(_domain(name, kept, reader))
            else:
                problems.append(_problem(name, kept, reader))
        except Unreadable as wrong:
            reader.note(wrong)
    return tuple(domains), tuple(problems)


def _definitions(groups: Sequence[Group], reader: Reader) -> Iterator[tuple[Group, list[Group]]]:
    """The name of each domain and problem, and its sections; those that stand behind it are its own."""
    found: list[tuple[Group, list[Group]]] = []
    for group in groups:
        if group.head.startswith(":") and found:
            reader.mended(
                f"`{group.head}` stands behind the end of its definition", group, "taken as part of it"
            )
            found[-1][1].append(group)
            continue
        name = group.items[1] if group.head == "define" and len(group.items) > 1 else None
        if not isinstance(name, Group) or name.head not in ("domain", "problem"):
            help = "write `(define (domain NAME) ...)` or `(define (problem NAME) ...)`"
            reader.wrong(
                "neither a domain nor a problem is defined here",
                group.items[0] if group.items else group,
                help,
            )
            continue
        sections = [item for item in group.items[2:] if isinstance(item, Group)]
        for item in group.items[2:]:
            if isinstance(item, Word):
                reader.wrong(f"`{item.text}` stands outside of all sections", item)
        found.append((name, sections))
    yield from found


def _is_known(section: Group, known: Sequence[str], reader: Reader) -> bool:
    """Whether a section is read; what a domain or problem does not have is a mistake, or passed over."""
    head = section.head
    if head in _UNSAID:
        reader.unsaid(f"{_UNSAID[head]} are not converted", section.items[0])
    elif head not in known:
        reader.mended(f"no section is called `{head or '('}` here", section, "passed over")
    return head in known and head not in _PASSED_OVER


def _by_head(sections: Sequence[Group]) -> _Sections:
    found: dict[str, list[Group]] = {}
    for section in sections:
        found.setdefault(section.head, []).append(section)
    return found


def _items(sections: _Sections, head: str) -> list[Node]:
    """What stands in all sections that begin with a word."""
    return [item for section in sections.get(head, ()) for item in section.items[1:]]


def _named(name: Group, reader: Reader) -> Name:
    if len(name.items) != 2:
        raise Unreadable(f"expected `({name.head} NAME)`", reader.span(name))
    return reader.name(name.items[1], "a name")


def _domain(name: Group, sections: _Sections, reader: Reader) -> DomainNode:
    predicates = tuple(_signatures(_items(sections, ":predicates"), reader))
    reader.without_terms = frozenset(each.name.text for each in predicates if not each.parameters)
    actions = (_action(section, reader) for section in sections.get(":action", ()))
    return DomainNode(
        _named(name, reader),
        reader.typed(_items(sections, ":types")),
        reader.objects(_items(sections, ":constants")),
        predicates,
        tuple(_signatures(_items(sections, ":functions"), reader)),
        tuple(action for action in actions if action is not None),
        span=reader.span(name),
    )


def _signatures(items: Sequence[Node], reader: Reader) -> Iterator[Signature]:
    """Declared predicates or functions; `- number` behind a function says what all of them are."""
    passed = False
    for place, item in enumerate(items):
        if passed or (isinstance(item, Word) and item.text == "-" and place > 0):
            passed = not passed
            continue
        try:
            group = reader.group(item, "`(NAME ?x - type ...)`")
            name = reader.name(group.items[0] if group.items else group, "a name")
            parameters = reader.typed(group.items[1:], variables=True)
            yield Signature(name, parameters, span=reader.span(group))
        except Unreadable as wrong:
            reader.note(wrong)


def _action(section: Group, reader: Reader) -> ActionNode | None:
    try:
        name = reader.name(section.items[1] if len(section.items) > 1 else section, "the name of the action")
        parts = _keyed(section.items[2:], reader)
        span = reader.span(section)
        parameters = parts.get(":parameters")
        condition, effect = parts.get(":precondition"), parts.get(":effect")
        return ActionNode(
            name,
            ()
            if parameters is None
            else reader.typed(reader.group(parameters, "`(?x - type ...)`").items, variables=True),
            AndNode((), span=span) if condition is None else reader.condition(condition),
            AllNode((), span=span) if effect is None else effect_of(effect, reader),
            span=name.span,
        )
    except Unreadable as wrong:
        reader.note(wrong)
        return None


def _keyed(items: Sequence[Node], reader: Reader) -> dict[str, Node]:
    """What stands behind each keyword of an action."""
    known = (":parameters", ":precondition", ":effect")
    parts: dict[str, Node] = {}
    place = 0
    while place < len(items):
        item = items[place]
        if not isinstance(item, Word) or item.text not in known:
            shown = f"`{item.text}`" if isinstance(item, Word) else "a group"
            expected = "expected `:parameters`, `:precondition` or `:effect`"
            raise Unreadable(f"{expected}, but there is {shown}", reader.span(item))
        if item.text in parts:
            raise Unreadable(f"`{item.text}` stands here a second time", reader.span(item))
        if place + 1 == len(items):
            raise Unreadable(f"nothing stands behind `{item.text}`", reader.span(item))
        behind = items[place + 1]
        if isinstance(behind, Word) and behind.text in known:
            reader.mended(f"nothing stands behind `{item.text}`", item, "taken as `()`")
            place += 1
            continue
        parts[item.text] = behind
        place += 2
    return parts


# ---- problems


def _problem(name: Group, sections: _Sections, reader: Reader) -> ProblemNode:
    def only(head: str) -> Node | None:
        """The one thing that the one section holds."""
        found = sections.get(head)
        if not found:
            return None
        if len(found) > 1:
            raise Unreadable(f"a second `{head}` stands here", reader.span(found[1]), "leave one")
        items = found[0].items
        if len(items) < 2:
            raise Unreadable(f"nothing stands behind `{head}`", reader.span(found[0]))
        if len(items) > 2:
            raise Unreadable(f"`{head}` holds one thing, and this is a second", reader.span(items[2]), _JOIN)
        return items[1]

    facts, values = _init(sections.get(":init", ()), reader)
    domain, goal = only(":domain"), only(":goal")
    rewarded, surely = only(":goal-reward"), only(":goal-probability")
    return ProblemNode(
        _named(name, reader),
        None if domain is None else reader.name(domain, "the name of a domain"),
        reader.objects(_items(sections, ":objects")),
        facts,
        values,
        None if goal is None else _goal(goal, reader),
        _metric(_items(sections, ":metric"), reader),
        None if rewarded is None else reader.number(rewarded, "a reward"),
        None if surely is None else reader.number(surely, "a probability"),
        span=reader.span(name),
    )


def _goal(node: Node, reader: Reader) -> ConditionNode:
    """The goal; one that cannot be read is always true, so that the rest of the problem is looked at."""
    try:
        return reader.condition(node)
    except Unreadable as wrong:
        reader.note(wrong)
        return AndNode((), span=reader.span(node))


def _init(
    sections: Sequence[Group], reader: Reader
) -> tuple[tuple[FactsNode | SetNode | ChanceNode, ...], tuple[ValueNode, ...]]:
    """The facts, what chance decides of them, and the values of functions."""
    facts: list[FactsNode | SetNode | ChanceNode] = []
    values: list[ValueNode] = []
    for section in sections:
        together, others = _apart(section)
        facts.append(together)
        for item in others:
            try:
                found = initial_of(item, reader)
            except Unreadable as wrong:
                reader.note(wrong)
                continue
            if isinstance(found, ValueNode):
                values.append(found)
            else:
                facts.append(found)
    return tuple(facts), tuple(values)


def _apart(section: Group) -> tuple[FactsNode, list[Node]]:
    """The facts of an `:init`, and what else stands in it."""
    atoms = section.atoms
    if atoms and are_facts(atoms):
        return FactsNode(atoms, section), []
    names, groups, others = list[tuple[str, ...]](), list[Group](), list[Node]()
    for item in _members(section.items[1:]):
        if isinstance(item, Group) and (found := item.names) and are_facts([found]):
            names.append(found)
            groups.append(item)
        else:
            others.append(item)
    return FactsNode(names, Group(section.start, section.end, tuple(groups))), others


def _members(items: Sequence[Node]) -> Iterator[Node]:
    """The members of a list, and of each `(and ...)` in it."""
    for item in items:
        if isinstance(item, Group) and item.head == "and":
            yield from _members(item.items[1:])
        else:
            yield item


def _metric(items: Sequence[Node], reader: Reader) -> MetricNode | None:
    if not items:
        return None
    way = items[0]
    if not isinstance(way, Word) or way.text not in ("maximize", "minimize") or len(items) != 2:
        raise Unreadable("expected `maximize` or `minimize`, and one expression", reader.span(way))
    value = items[1]
    name: Name | None = None
    if isinstance(value, Word):
        name = reader.name(value, "a function")
    elif len(value.items) == 1:
        name = reader.name(value.items[0], "a function")
    return MetricNode(way.text == "maximize", name, span=reader.span(value))
