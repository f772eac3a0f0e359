"""Transitions as they happened, and their file: a JSON object a line, of symbols that perception reported."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import msgspec

from cleancli.compiler.fluents import canonical_state
from cleancli.files.plain import in_units, open_plain
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Fact, Object, State
from cleancli.language.parsing.read import refused_as

LONGEST = 8 << 20
"""Bytes of a line."""
MOST = 1000
"""Lines that are told of one file."""
SHOWN = 2000
"""Bytes of a line that are shown."""

_Fact = tuple[str, tuple[str, ...], bool | int | str]


@dataclass(frozen=True, slots=True)
class Transition:
    """An executed action between two observed states.

    `objects` are those known before or after it. An object that is gone keeps its place in `after`, without
    the facts that made it worth naming and with the values it was last seen with.
    """

    action: str
    arguments: tuple[str, ...]
    objects: tuple[Object, ...]
    before: State
    after: State


def encode(transition: Transition, extra: Mapping[str, object]) -> str:
    """One line of an experience file, without its line end; `extra` is kept beside it for readers."""
    record = {
        "action": transition.action,
        "arguments": list(transition.arguments),
        "objects": {o.name: o.type for o in sorted(transition.objects)},
        "before": _encode_state(transition.before),
        "after": _encode_state(transition.after),
        **extra,
    }
    return json.dumps(record, ensure_ascii=False)


def read_experience(path: Path | str, domain: Domain) -> Iterator[Transition]:
    """The transitions of an experience file one after the other, however many there are; see `decode`."""
    name = str(path)
    with refused_as(name), open_plain(path) as file:
        yield from decode(file, name, domain)


def decode(file: BinaryIO, name: str, domain: Domain) -> Iterator[Transition]:
    """The transitions in a file that is open, which messages call by a name.

    No more of the file than a line is in memory at a time. A last line without a line end is a record that a
    crash cut short and is passed over. Raises Refused at the end, for the first `MOST` other lines that are
    no transitions of the domain, and the number of those that follow; at once for a line that is too long.
    """
    wrong = _Wrong(name, domain.name)
    while line := file.readline(LONGEST + 1):
        if len(line) > LONGEST:
            where = f"line {wrong.lines + 1} of `{name}`"
            raise Refused([Diagnostic("E005", f"{where} is longer than {in_units(LONGEST)}", None)])
        if not line.strip() or not line.endswith(b"\n"):
            wrong.skip()
            continue
        try:
            _refuse_no_text(line)
            transition = _decode_line(line, domain)
        except ValueError as error:
            wrong.add(line, str(error))
        else:
            wrong.skip()
            yield transition
    wrong.refuse()


def _refuse_no_text(line: bytes) -> None:
    """Tell of a byte that is no text before anything that follows from it."""
    try:
        line.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"byte 0x{line[error.start]:02x} is no UTF-8 text") from None


class _Wrong:
    """Lines that are no transitions, at their places in a text that is empty everywhere else."""

    def __init__(self, name: str, domain: str) -> None:
        self.lines = 0
        self._name, self._domain = name, domain
        self._parts: list[str] = []
        self._size = self._ended = self._others = 0
        self._mistakes: list[Diagnostic] = []

    def skip(self) -> None:
        """Pass over a line that is right."""
        self.lines += 1

    def add(self, line: bytes, reason: str) -> None:
        """Take in a line that is wrong."""
        self.lines += 1
        if len(self._mistakes) == MOST:
            self._others += 1
            return
        between = self.lines - 1 - self._ended
        shown = line[:SHOWN].decode("utf-8", "replace").strip().replace("\r", " ")
        start = self._size + between
        span = Span(self._name, start, start + len(shown))
        self._mistakes.append(Diagnostic("E701", f"not a transition of {self._domain}: {reason}", span))
        self._parts.append("\n" * between + shown + "\n")
        self._size += len(self._parts[-1])
        self._ended = self.lines

    def refuse(self) -> None:
        """Raise Refused if there are any."""
        if self._others:
            said = f"{self._others} more lines of `{self._name}` are no transitions of {self._domain}"
            self._mistakes.append(Diagnostic("E701", said, None))
        if self._mistakes:
            raise Refused(self._mistakes, (Source(self._name, "".join(self._parts)),))


def _encode_state(state: State) -> list[list[object]]:
    return [[fact.symbol, list(fact.objects), fact.value] for fact in sorted(state, key=_order)]


def _order(fact: Fact) -> tuple[str, tuple[str, ...]]:
    return fact.symbol, fact.objects


class _Line(msgspec.Struct):
    """A line as JSON. A fact is a symbol, its objects and its value."""

    action: str
    arguments: tuple[str, ...]
    objects: dict[str, str]
    before: tuple[_Fact, ...]
    after: tuple[_Fact, ...]


_DECODER = msgspec.json.Decoder(_Line)


def _decode_line(line: bytes, domain: Domain) -> Transition:
    """Raises ValueError, with the reason, for anything that is not a transition."""
    record = _parsed(line)
    arity = {a.name: len(a.parameters) for a in domain.actions}
    if record.action not in arity:
        raise ValueError(f"the domain has no action {record.action!r}")
    if len(record.arguments) != arity[record.action]:
        taken = plural(arity[record.action], "argument")
        raise ValueError(f"{record.action} takes {taken}, not {len(record.arguments)}")
    types = {t.name for t in domain.types}
    if unknown := [name for name in record.objects.values() if name not in types]:
        raise ValueError(f"the domain has no type {unknown[0]!r}")
    objects = tuple(Object(name, type_name) for name, type_name in record.objects.items())
    known = {o.name for o in (*objects, *domain.constants)}
    if unknown := [name for name in record.arguments if name not in known]:
        raise ValueError(f"{unknown[0]!r} is not among its objects")
    before = _state(record.before, "before", domain, known)
    after = _state(record.after, "after", domain, known)
    return Transition(record.action, record.arguments, objects, before, after)


def _parsed(line: bytes) -> _Line:
    try:
        return _DECODER.decode(line)
    except msgspec.ValidationError as error:
        raise ValueError(f"{str(error)[0].lower()}{str(error)[1:]}") from None
    except msgspec.DecodeError as error:
        raise ValueError(f"it is no JSON ({error})") from None
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def _state(listed: Iterable[_Fact], key: str, domain: Domain, known: set[str]) -> State:
    symbols = {symbol.name: symbol for symbol in domain.symbols}
    facts = []
    for name, objects, value in listed:
        symbol = symbols.get(name)
        if symbol is None or len(symbol.parameters) != len(objects):
            raise ValueError(f"the domain has no symbol {name!r} for {plural(len(objects), 'object')}")
        if type(value) is not type(symbol.values[0]) or value not in symbol.values:
            raise ValueError(f"{name} cannot be {value!r}")
        if not known.issuperset(objects):
            raise ValueError(f"{key} names an object that is not listed")
        facts.append(Fact(name, objects, value))
    return canonical_state(domain, facts)
