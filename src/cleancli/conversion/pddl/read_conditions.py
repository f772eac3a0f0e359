"""The reader of names, typed lists, numbers and conditions, which says what it expected where."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import lcm

from cleancli.conversion.pddl.stated import LONGEST_DENOMINATOR, is_stated
from cleancli.conversion.pddl.syntax import (
    AndNode,
    AtomNode,
    CompareNode,
    ConditionNode,
    EqualNode,
    Name,
    NotNode,
    ObjectsNode,
    OrNode,
    QuantifiedNode,
    Typed,
)
from cleancli.conversion.pddl.words import Group, Node, Word
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.sink import Findings

# Bounded, so that none takes long to compute with; `Reader.bounded` refuses what no .nid file can state.
_NUMBER = re.compile(
    r"-?([0-9]{1,400}(\.[0-9]{0,400})?|\.[0-9]{1,400})(e[-+]?[0-9]{1,3})?|-?[0-9]{1,400}/[0-9]{1,400}"
)
_COMPARES = frozenset({"<", "<=", ">", ">="})
_UNSAID = {
    "preference": "preferences are",
    **dict.fromkeys(
        (
            "always", "sometime", "within", "at-most-once", "sometime-after", "sometime-before",
            "always-within", "hold-during", "hold-after",
        ),
        "constraints on the course of a plan are",
    ),
}  # fmt: skip
"""What PDDL3 has and is not converted, by the word that it begins with; of objects it is a predicate."""


_FORMS = frozenset({"", "and", "or", "not", "imply", "exists", "forall", "=", *_COMPARES, *_UNSAID})
"""What conditions begin with that are no atoms; a group that begins with no word is none either."""


class Unreadable(Exception):
    """What stands somewhere is not what PPDDL has there; by `code` E917 what .nid files cannot say."""

    def __init__(self, message: str, span: Span, help: str = "", code: str = "E915") -> None:
        super().__init__(message)
        self.message = message
        self.span = span
        self.help = help
        self.code = code


class Reader:
    """Reads parts of the file at `path`, and notes what is wrong in it. `without_terms` are the predicates of
    the file's domain that take none, as far as it was read."""

    def __init__(self, path: str, findings: Findings) -> None:
        self.path = path
        self.findings = findings
        self._denominator = 1
        self.without_terms = frozenset[str]()

    def span(self, node: Node) -> Span:
        """The place of a word; of a group its first line's beginning, as far as its first word."""
        if isinstance(node, Word) or not isinstance(first := node.items[0] if node.items else None, Word):
            return Span(self.path, node.start, node.end)
        return Span(self.path, node.start, first.end)

    def note(self, wrong: Unreadable) -> None:
        """Notes what could not be read."""
        self.findings.error(wrong.code, wrong.message, wrong.span, help=wrong.help)

    def wrong(self, message: str, node: Node, help: str = "") -> None:
        """Notes a mistake (E915)."""
        self.findings.error("E915", message, self.span(node), help=help)

    def unsaid(self, message: str, node: Node) -> None:
        """Notes what .nid files cannot say (E917)."""
        self.findings.error("E917", message, self.span(node))

    def mended(self, message: str, node: Node, mend: str) -> None:
        """Warns of a mistake whose mend is plain (W911)."""
        self.findings.warning("W911", message, self.span(node), mend)

    def word(self, node: Node, wanted: str) -> Word:
        """A word that may be a name, or the name of a variable."""
        if isinstance(node, Group) or node.text == "-" or node.text.startswith(":"):
            shown = "a group" if isinstance(node, Group) else f"`{node.text}`"
            raise Unreadable(f"expected {wanted}, but there is {shown}", self.span(node))
        return node

    def name(self, node: Node, wanted: str) -> Name:
        """A name or the name of a variable."""
        word = self.word(node, wanted)
        return Name(word.text, self.path, word.start)

    def group(self, node: Node, wanted: str) -> Group:
        """A group in parentheses."""
        if isinstance(node, Word):
            raise Unreadable(f"expected {wanted}, but there is `{node.text}`", self.span(node))
        return node

    def number(self, node: Node, wanted: str) -> Fraction:
        """A number, which may be a fraction."""
        value = self.amount(node)
        if value is None:
            shown = "a group" if isinstance(node, Group) else f"`{node.text}`"
            raise Unreadable(f"expected {wanted}, but there is {shown}", self.span(node))
        return value

    def amount(self, node: Node) -> Fraction | None:
        """The number that a word is; None if it is none."""
        value = number_in(node)
        return None if value is None else self.bounded(value, node)

    def bounded(self, value: Fraction, node: Node) -> Fraction:
        """A number that stands at a node, or is calculated there. E917, once, where it is too long, or those
        of the file have too long a common denominator: sums of them would take long. From there on all are
        0."""
        if not self._denominator:
            return Fraction(0)
        self._denominator = lcm(self._denominator, value.denominator)
        if is_stated(value) and self._denominator < LONGEST_DENOMINATOR:
            return value
        self._denominator = 0
        message, help = "this number has too many digits for a .nid file", "round it"
        if is_stated(value):
            message = "the common denominator of this number and of those before it has too many digits"
        self.findings.error("E917", message, self.span(node), help=help)
        return Fraction(0)

    def typed(self, items: Sequence[Node], *, variables: bool = False) -> tuple[Typed, ...]:
        """As `objects`, each name for itself; perhaps of variables."""
        listed = self._listed(items, variables=variables)
        return tuple([Typed(name_of(word, self.path), types) for words, types in listed for word in words])

    def objects(self, items: Sequence[Node]) -> tuple[ObjectsNode, ...]:
        """`a b - type c`: a type is for all names before it that have none; `(either ...)` is several."""
        return tuple(ObjectsNode(*each) for each in self._listed(items, variables=False))

    def _listed(
        self, items: Sequence[Node], *, variables: bool
    ) -> Iterator[tuple[tuple[Word, ...], tuple[Name, ...]]]:
        """The names before each type with it, and those at the end that have none."""
        waiting: list[Word] = []
        rest = iter(items)
        for item in rest:
            if isinstance(item, Word):
                sign = item.text[0]
                if sign == "?" if variables else sign not in "?-:":  # as almost all
                    waiting.append(item)
                    continue
                if sign == "-" and waiting:
                    yield tuple(waiting), self._types(self._behind(item, rest))
                    waiting = []
                    continue
            word = self.word(item, "a variable" if variables else "a name")
            if (word.text[0] == "?") != variables:
                what = "is no variable: write `?` before it" if variables else "is a variable"
                raise Unreadable(f"`{word.text}` {what}", self.span(word))
            waiting.append(word)
        if waiting:
            yield tuple(waiting), ()

    def _behind(self, dash: Word, rest: Iterator[Node]) -> Node:
        """What stands behind the `-` before a type."""
        if dash.text != "-":
            self.mended(f"no blank stands behind `-` in `{dash.text}`", dash, "taken as a type")
            return Word(dash.text[1:], dash.start + 1)
        node = next(rest, None)
        if node is None:
            raise Unreadable("no type stands behind this", self.span(dash))
        return node

    def _types(self, node: Node) -> tuple[Name, ...]:
        if isinstance(node, Word):
            return (self.name(node, "a type"),)
        if node.head != "either" or len(node.items) < 2:
            raise Unreadable("expected a type or `(either TYPE ...)`", self.span(node))
        return tuple(self.name(item, "a type") for item in node.items[1:])

    # ---- conditions

    def condition(self, node: Node) -> ConditionNode:
        """A condition; `()` always holds."""
        if isinstance(node, Word):
            return self.bare(node, "a condition")
        head = node.head
        if head not in _FORMS:
            return self.atom(node)
        span, parts = self.span(node), node.items[1:]
        if not node.items:
            return AndNode((), span=span)
        match head:
            case "and":
                return AndNode(tuple(self.condition(part) for part in parts), span=span)
            case "or":
                return OrNode(tuple(self.condition(part) for part in parts), span=span)
            case "not":
                return NotNode(self.condition(self._only(node)), span=span)
            case "imply":
                if len(parts) != 2:
                    raise Unreadable("`imply` has two conditions", span)
                left = NotNode(self.condition(parts[0]), span=span)
                return OrNode((left, self.condition(parts[1])), span=span)
            case "exists" | "forall":
                variables, part = self.quantified(node)
                return QuantifiedNode(head == "exists", variables, self.condition(part), span=span)
            case "=":
                return self._equal(node)
            case _ if head in _COMPARES:
                return CompareNode(span=span)
            case _ if head in _UNSAID and any(isinstance(part, Group) for part in parts):
                raise Unreadable(f"{_UNSAID[head]} not converted", span, code="E917")
        return self.atom(node)

    def quantified(self, node: Group) -> tuple[tuple[Typed, ...], Node]:
        """The variables of a quantifier, and what it is about."""
        if len(node.items) != 3:
            raise Unreadable(f"expected `({node.head} (?x - type ...) ...)`", self.span(node))
        group = self.group(node.items[1], "`(?x - type ...)`")
        return self.typed(group.items, variables=True), node.items[2]

    def atom(self, node: Node) -> AtomNode:
        """`(p ?x a)`."""
        group = self.group(node, "an atom in parentheses")
        name = self.name(group.items[0] if group.items else group, "the name of a predicate")
        if name.is_variable:
            raise Unreadable(f"expected the name of a predicate, but there is `{name.text}`", name.span)
        terms = tuple([self.name(term, "an object or a variable") for term in group.items[1:]])
        return AtomNode(name, terms, span=Span(self.path, group.start, group.end))

    def bare(self, word: Word, wanted: str) -> AtomNode:
        """A predicate that takes no terms, where `wanted` should stand in parentheses (W911)."""
        if word.text not in self.without_terms:
            raise Unreadable(f"expected {wanted} in parentheses, but there is `{word.text}`", self.span(word))
        self.mended(f"`{word.text}` stands without parentheses", word, f"taken as `({word.text})`")
        return AtomNode(name_of(word, self.path), (), span=self.span(word))

    def _only(self, node: Group) -> Node:
        if len(node.items) != 2:
            raise Unreadable(f"`{node.head}` has one condition", self.span(node))
        return node.items[1]

    def _equal(self, node: Group) -> ConditionNode:
        if len(node.items) != 3:
            raise Unreadable("`=` compares two terms", self.span(node))
        if any(isinstance(part, Group) or number_in(part) is not None for part in node.items[1:]):
            return CompareNode(span=self.span(node))
        left, right = (self.name(part, "an object or a variable") for part in node.items[1:])
        return EqualNode(left, right, span=self.span(node))


def name_of(word: Word, path: str) -> Name:
    """A word as a name that stands in the file at `path`."""
    return Name(word.text, path, word.start)


def number_in(node: Node) -> Fraction | None:
    """The number that a word is; None if it is none."""
    if isinstance(node, Group) or _NUMBER.fullmatch(node.text) is None:
        return None
    denominator = node.text.partition("/")[2]
    return None if denominator and not int(denominator) else Fraction(node.text)
