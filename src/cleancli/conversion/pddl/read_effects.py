"""The reader of effects, and of what holds at first."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from cleancli.conversion.pddl.read_conditions import Reader, Unreadable
from cleancli.conversion.pddl.syntax import (
    AllNode,
    AtomNode,
    ChanceNode,
    EachNode,
    EffectNode,
    PayNode,
    SetNode,
    ValueNode,
    WhenNode,
)
from cleancli.conversion.pddl.words import Group, Node, Word
from cleancli.language.printing.printer import print_fraction

_CONDITIONS = frozenset({"or", "imply", "exists", "=", "<", "<=", ">", ">="})
ROUNDING_ERROR = Fraction(1, 10**12)
"""By how much probabilities that programs wrote may miss 1. Chosen: more than sums of doubles miss it by."""

_ASSIGNS = frozenset({"assign", "scale-up", "scale-down"})
_EFFECTS = frozenset({"and", "not", "when", "forall", "probabilistic", "increase", "decrease"})
_NO_PREDICATES = _CONDITIONS | _ASSIGNS | _EFFECTS
_FORMS = _NO_PREDICATES | {"", "oneof"}
"""What effects begin with that set no atom; a group that begins with no word sets none either."""


def effect_of(node: Node, reader: Reader) -> EffectNode:
    """An effect; `()` changes nothing. Raises `Unreadable`."""
    if isinstance(node, Word):
        return SetNode(reader.bare(node, "an effect"), True, span=reader.span(node))
    span, head = reader.span(node), node.head
    if head not in _FORMS:
        return SetNode(reader.atom(node), True, span=span)
    parts = node.items[1:]
    if not node.items:
        return AllNode((), span=span)
    match head:
        case "and":
            return AllNode(tuple(effect_of(part, reader) for part in parts), span=span)
        case "not":
            if len(parts) != 1:
                raise Unreadable("`not` has one atom", span)
            (part,) = parts
            atom = reader.bare(part, "an atom") if isinstance(part, Word) else reader.atom(part)
            return SetNode(atom, False, span=span)
        case "when":
            if len(parts) != 2:
                raise Unreadable("`when` has a condition and an effect", span)
            return WhenNode(reader.condition(parts[0]), effect_of(parts[1], reader), span=span)
        case "forall":
            variables, part = reader.quantified(node)
            return EachNode(variables, effect_of(part, reader), span=span)
        case "probabilistic":
            return _chance(node, reader)
        case "increase" | "decrease":
            return _pay(node, reader)
        case _ if head in _CONDITIONS:
            raise Unreadable(f"`{head}` is no effect", span)
        case "oneof":
            message = "`oneof` does not say how likely each effect is"
            raise Unreadable(message, span, "write `(probabilistic 1/2 ... 1/2 ...)`", code="E917")
        case _ if head in _ASSIGNS:
            raise Unreadable(f"`{head}` is not converted: numbers can only be costs here", span, code="E917")
    return SetNode(reader.atom(node), True, span=span)


def _chance(node: Group, reader: Reader) -> ChanceNode:
    """`(probabilistic p e ...)`; E918 for what is no probability, and where the sum is above 1: what else is
    wrong is sought as if they were in bounds."""
    parts = node.items[1:]
    if not parts or len(parts) % 2:
        raise Unreadable("`probabilistic` has pairs of a probability and an effect", reader.span(node))
    branches: list[tuple[Fraction, EffectNode]] = []
    for place in range(0, len(parts), 2):
        chance = reader.number(parts[place], "a probability")
        if not 0 <= chance <= 1:
            shown = print_fraction(abs(chance))
            message = f"`{'-' if chance < 0 else ''}{shown}` is no probability"
            reader.note(Unreadable(message, reader.span(parts[place]), "it lies between 0 and 1", "E918"))
            chance = min(max(chance, Fraction(0)), Fraction(1))
        branches.append((chance, effect_of(parts[place + 1], reader)))
    _sum_to_one(branches, node, reader)
    total = sum((chance for chance, _ in branches), Fraction(0))
    if total > 1:
        message = f"the probabilities sum to {print_fraction(total)}"
        reader.note(Unreadable(message, reader.span(node), "they sum to at most 1", "E918"))
        branches = [(chance / total, effect) for chance, effect in branches]
    return ChanceNode(tuple(branches), span=reader.span(node))


def _sum_to_one(branches: list[tuple[Fraction, EffectNode]], node: Group, reader: Reader) -> None:
    """Takes probabilities that miss 1 by a rounding error, like 0.9 and 0.09999999999999998, to sum to 1: the
    one of most digits is what the others leave (W911)."""
    total = sum((chance for chance, _ in branches), Fraction(0))
    if total == 1 or abs(total - 1) > ROUNDING_ERROR:
        return
    place = max(range(len(branches)), key=lambda each: branches[each][0].denominator)
    chance, effect = branches[place]
    if chance >= total - 1:
        reader.mended(f"the probabilities sum to {print_fraction(total)}", node, "taken to sum to 1")
        branches[place] = chance - (total - 1), effect


def _pay(node: Group, reader: Reader) -> PayNode:
    """`(increase (f) amount)`; the function may stand without parentheses."""
    span = reader.span(node)
    if len(node.items) != 3:
        raise Unreadable(f"`{node.head}` has a function and an amount", span)
    amount = _sum(node.items[2], reader)
    if amount is not None and node.head == "decrease":
        amount = _times(amount, Fraction(-1))
    return PayNode(_function(node.items[1], reader), amount, span=span)


_Sum = tuple[tuple[Fraction, AtomNode | None], ...]
_ONE: _Sum = ((Fraction(1), None),)


def _sum(node: Node, reader: Reader) -> _Sum | None:
    """An amount as `PayNode` has it; None for what is no sum of multiples."""
    value = reader.amount(node)
    if value is not None:
        return ((value, None),)
    if isinstance(node, Word) or node.head not in ("+", "-", "*", "/"):
        return ((Fraction(1), _function(node, reader)),)
    parts = [_sum(part, reader) for part in node.items[1:]]
    known = [part for part in parts if part is not None]
    if len(known) < len(parts) or not parts:
        return None
    first, others = known[0], known[1:]
    match node.head:
        case "+":
            return tuple(each for part in known for each in part)
        case "-":
            signed = [first, *(_times(part, Fraction(-1)) for part in others)]
            return tuple(each for part in signed for each in part) if others else _times(first, Fraction(-1))
        case "*":
            varying = [part for part in known if _constant(part) is None]
            factors = [value for part in known if (value := _constant(part)) is not None]
            if len(varying) > 1:
                return None
            product = varying[0] if varying else _ONE
            for factor in factors:
                product = _bounded(_times(product, factor), node, reader)
            return product
        case _:
            divisors = [_constant(part) for part in others]
            if len(divisors) != 1 or not divisors[0]:
                return None
            return _bounded(_times(first, 1 / divisors[0]), node, reader)


def _times(amount: _Sum, factor: Fraction) -> _Sum:
    return tuple((factor * weight, function) for weight, function in amount)


def _bounded(amount: _Sum, node: Node, reader: Reader) -> _Sum:
    return tuple((reader.bounded(weight, node), function) for weight, function in amount)


def _constant(amount: _Sum) -> Fraction | None:
    """The number that a sum is; None where functions are in it."""
    if any(function is not None for _, function in amount):
        return None
    return sum((weight for weight, _ in amount), Fraction(0))


def _function(node: Node, reader: Reader) -> AtomNode:
    if isinstance(node, Word):
        name = reader.name(node, "a function")
        return AtomNode(name, (), span=name.span)
    return reader.atom(node)


# ---- what holds at first


def are_facts(rows: Iterable[tuple[str, ...]]) -> bool:
    """Whether each row of names begins with what may be a predicate."""
    return _NO_PREDICATES.isdisjoint(names[0] for names in rows)


def initial_of(node: Node, reader: Reader) -> SetNode | ChanceNode | ValueNode:
    """A fact, what chance decides, or the value of a function. Raises `Unreadable`."""
    if isinstance(node, Group) and node.head == "=":
        if len(node.items) != 3:
            raise Unreadable("`=` gives a function a value", reader.span(node))
        value = reader.number(node.items[2], "a number")
        return ValueNode(_function(node.items[1], reader), value, span=reader.span(node))
    if isinstance(node, Group) and node.head == "at" and any(isinstance(part, Group) for part in node.items):
        raise Unreadable("what happens at a time of its own is not converted", reader.span(node), code="E917")
    found = effect_of(node, reader)
    if isinstance(found, SetNode | ChanceNode):
        return found
    raise Unreadable("at first there are facts, values and what chance decides of them", reader.span(node))
