"""Names for .nid files: those of libPRADA's files where they can stay."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

from cleancli.conversion.check import constants_of
from cleancli.conversion.exclusive import Group
from cleancli.conversion.records import Kind, Library
from cleancli.language.diagnostics.sink import RESERVED
from cleancli.language.model import REWARD_WORDS, Value

OBJECT = "object"
"""The one type: libPRADA's objects have none."""

NONE = "none"


@dataclass(frozen=True, slots=True)
class Function:
    """A group as a function: its name, its values in rising order, and the value of each member."""

    name: str
    values: tuple[Value, ...]
    value_of: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Names:
    """What libPRADA's symbols (counts and actions among them) and constants are called; `functions` has the
    function of each member of a group."""

    symbols: Mapping[str, str]
    objects: Mapping[str, str]
    functions: Mapping[str, Function]


def names_for(library: Library, groups: Iterable[Group]) -> Names:
    """A name for each symbol, constant and group, none twice in its kind."""
    objects = called({}, constants_of(library))
    symbols: dict[str, str] = {}
    for symbol in library.symbols:
        avoided = REWARD_WORDS if symbol.kind is Kind.COUNT else ()
        symbols[symbol.name] = fresh(symbol.name, (*symbols.values(), *avoided))
    functions: dict[str, Function] = {}
    for group in groups:
        function = _function(group, (*symbols.values(), *(f.name for f in functions.values())))
        functions |= dict.fromkeys(group.members, function)
    return Names(symbols, objects, functions)


def called(given: Mapping[str, str], constants: Iterable[str]) -> dict[str, str]:
    """What constants are called, beside those that have names; numbers get an `o`."""
    found, taken = dict(given), set(given.values())
    for constant in constants:
        if constant not in found:
            found[constant] = fresh(f"o{constant}" if constant.isdecimal() else constant, taken)
            taken.add(found[constant])
    return found


def fresh(name: str, taken: Collection[str]) -> str:
    """The name, with underscores behind it while it is a word of the language or taken."""
    while name in RESERVED or name in taken:
        name += "_"
    return name


def _function(group: Group, taken: Collection[str]) -> Function:
    """`smallSize` and `bigSize` become `size`: small < big."""
    words = [re.findall(r"[A-Z]*[a-z]+|[A-Z]+|[0-9]+", member) or [member] for member in group.members]
    backward = _shared([each[::-1] for each in words])
    forward = _shared(words)
    if backward:
        name, rest = _joined(words[0][-backward:]), [each[:-backward] for each in words]
    elif forward:
        name, rest = _joined(words[0][:forward]), [each[forward:] for each in words]
    else:
        name, rest = "_or_".join(group.members), words
    values: list[str] = []
    for each in rest:
        values.append(fresh(_joined(each), values))
    rising = [fresh(NONE, values), *values] if group.partial else values
    return Function(fresh(name, taken), tuple(rising), dict(zip(group.members, values, strict=True)))


def _shared(words: Sequence[Sequence[str]]) -> int:
    """How many words all begin with; each keeps one at least."""
    count = 0
    while all(len(each) > count + 1 and each[count].lower() == words[0][count].lower() for each in words):
        count += 1
    return count


def _joined(words: Sequence[str]) -> str:
    """`Very`, `Big` -> `veryBig`."""
    first, *others = words
    text = first.lower() + "".join(word[:1].upper() + word[1:] for word in others)
    return text if text[0].isalpha() else f"v{text}"
