"""Transitions as they happened, and their file: a JSON object a line, of symbols that perception reported."""

from __future__ import annotations

import hashlib
import itertools
import json
import operator
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, BinaryIO, NamedTuple, TypeVar

import msgspec
from msgspec import Meta

from cleancli.compiler.fluents import Fluent, Values
from cleancli.files.plain import in_units, open_plain
from cleancli.language.checking.learned import HASH_DIGITS
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Object, Value
from cleancli.language.parsing.read import refused_as

LONGEST = 8 << 20
"""Bytes of a line."""
MOST = 98
"""Lines that are told of one file: with one whose action the domain lacks, and the number of all others, as
many messages as a run shows."""
MOST_NAMED = 5
"""Actions that are named of those that a domain lacks."""
SHOWN = 2000
"""Bytes of a line that are shown."""

REMEMBERED = 1 << 16
"""Facts, and lists of objects, that are remembered as they were read."""

_Fact = tuple[str, tuple[str, ...], bool | int | str]
_Seconds = Annotated[float, Meta(ge=0, le=1e6)]
_FALSE: Fluent = ("", ())
_objects_of = operator.itemgetter(1)
"""Of a fact or a fluent."""
_Key = TypeVar("_Key")
_Read = TypeVar("_Read")


class Transition(NamedTuple):
    """An executed action between two observed states.

    `objects` are those known before or after it. An object that is gone keeps its place in `after`, without
    the facts that made it worth naming and with the values it was last seen with. `lasted`: milliseconds of
    robot time, and `expected` those that the workcell had expected, as far as they are known.
    """

    action: str
    arguments: tuple[str, ...]
    objects: tuple[Object, ...]
    before: Values
    after: Values
    lasted: int | None = None
    expected: int | None = None

    @property
    def changed(self) -> set[Fluent]:
        """What has another value after it."""
        keys = self.before.keys() | self.after.keys()
        return {key for key in keys if self.before.get(key) != self.after.get(key)}


def milliseconds(transit: float, seconds: float) -> int:
    """How long an action lasted, on its way to where it begins and from there on, in seconds."""
    return round(1000 * transit) + round(1000 * seconds)


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


class Reading:
    """How far an experience file was read: how many transitions, and the hash of all lines up to the last of
    them, of which a domain's `learned` block notes 16 digits. `is_cut`: its last line has no end."""

    def __init__(self) -> None:
        self.transitions = 0
        self.is_cut = False
        self._lines = hashlib.sha256()
        self._blank = b""

    @property
    def sha256(self) -> str:
        """Of the lines, the blank ones among them as well."""
        return self._lines.hexdigest()[:HASH_DIGITS]

    def pass_by(self, line: bytes) -> bool:
        """Take in the next line; whether it is one that holds a transition."""
        if not line.endswith(b"\n"):
            self.is_cut = True
            return False
        if not line.strip():
            self._blank += line
            return False
        self._lines.update(self._blank + line)
        self._blank = b""
        self.transitions += 1
        return True


def read_experience(path: Path | str, domain: Domain, reading: Reading | None = None) -> Iterator[Transition]:
    """The transitions of an experience file one after the other, however many there are; see `decode`."""
    name = str(path)
    with refused_as(name), open_plain(path) as file:
        yield from decode(file, name, domain, reading)


def decode(file: BinaryIO, name: str, domain: Domain, reading: Reading | None = None) -> Iterator[Transition]:
    """The transitions in a file that is open, which messages call by a name; `reading` follows.

    No more of the file than a line is in memory at a time. A last line without a line end is a record that a
    crash cut short and is passed over. Raises Refused at the end, for the first `MOST` other lines that are
    no transitions of the domain, and the number of those that follow; once for all lines whose actions the
    domain lacks; at once for a line that is too long, and for the row of a study.
    """
    wrong, reader = _Wrong(name, domain.name), _Reader(domain)
    reading = Reading() if reading is None else reading
    while line := file.readline(LONGEST + 1):
        if len(line) > LONGEST:
            where = f"line {wrong.lines + 1} of `{name}`"
            raise Refused([Diagnostic("E005", f"{where} is longer than {in_units(LONGEST)}", None)])
        if not reading.pass_by(line):
            wrong.skip()
            continue
        try:
            _refuse_no_text(line)
            transition = reader.transition(line)
        except ValueError as error:
            if _is_row(line):
                raise _rows_of_study(name) from None
            wrong.add(line, error)
        else:
            wrong.skip()
            yield transition
    wrong.refuse(reading.transitions)


class _Study(msgspec.Struct):
    study: str


class _Row(msgspec.Struct):
    """A line of the episodes.jsonl of a study, as far as it is told by."""

    row: _Study


def _is_row(line: bytes) -> bool:
    try:
        msgspec.json.decode(line, type=_Row)
    except (msgspec.MsgspecError, ValueError, RecursionError):
        return False
    return True


def _rows_of_study(name: str) -> Refused:
    """That a file has what the episodes of a study came to (E701)."""
    message = f"`{name}` has the rows of a study, which keeps no experience"
    help = "record some: `cleancli simulate DOMAIN PROBLEM --record FILE`, or `cleancli execute`"
    return Refused([Diagnostic("E701", message, None, help=help)])


class _NoAction(ValueError):
    """The domain has no action of the `name`."""

    def __init__(self, name: str) -> None:
        super().__init__(f"the domain has no action {name!r}")
        self.name = name


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
        self._without_action = 0
        self._lacking: dict[str, None] = {}
        self._first_lacking = 0

    def skip(self) -> None:
        """Pass over a line that is right."""
        self.lines += 1

    def add(self, line: bytes, error: ValueError) -> None:
        """Take in a line that is wrong; of those whose actions the domain lacks the first is kept."""
        self.lines += 1
        if isinstance(error, _NoAction):
            self._without_action += 1
            if len(self._lacking) <= MOST_NAMED:
                self._lacking[error.name] = None
            if self._without_action > 1:
                return
            self._first_lacking = len(self._mistakes)
        elif len(self._mistakes) >= MOST:
            self._others += 1
            return
        between = self.lines - 1 - self._ended
        shown = line[:SHOWN].decode("utf-8", "replace").strip().replace("\r", " ")
        start = self._size + between
        span = Span(self._name, start, start + len(shown))
        self._mistakes.append(Diagnostic("E701", f"not a transition of {self._domain}: {error}", span))
        self._parts.append("\n" * between + shown + "\n")
        self._size += len(self._parts[-1])
        self._ended = self.lines

    def refuse(self, lines: int) -> None:
        """Raise Refused if there are any among so many lines."""
        if self._without_action > 1:
            self._tell_lacking(lines)
        if self._others:
            said = f"{self._others} more lines of `{self._name}` are no transitions of {self._domain}"
            self._mistakes.append(Diagnostic("E701", said, None))
        if self._mistakes:
            raise Refused(self._mistakes, (Source(self._name, "".join(self._parts)),))

    def _tell_lacking(self, lines: int) -> None:
        """Say at the first line whose action the domain lacks how many there are."""
        names = [f"`{name}`" for name in self._lacking][:MOST_NAMED]
        named = ", ".join(names) + (" and others" if len(self._lacking) > MOST_NAMED else "")
        message = f"{self._without_action} of {lines} lines name actions that `{self._domain}` lacks: {named}"
        help = f"is `{self._domain}` the domain that the experience is of?"
        span = self._mistakes[self._first_lacking].span
        self._mistakes[self._first_lacking] = Diagnostic("E701", message, span, help=help)


def _encode_state(values: Values) -> list[list[object]]:
    return [[symbol, list(objects), values[symbol, objects]] for symbol, objects in sorted(values)]


class _Line(msgspec.Struct):
    """A line as JSON, the facts not decoded yet; `transit` comes before `seconds`."""

    action: str
    arguments: tuple[str, ...]
    objects: dict[str, str]
    before: msgspec.Raw
    after: msgspec.Raw
    seconds: _Seconds | None = None
    transit: _Seconds = 0.0
    expected: _Seconds | None = None


_DECODER = msgspec.json.Decoder(_Line)
_FACTS: msgspec.json.Decoder[tuple[_Fact, ...]] = msgspec.json.Decoder(tuple[_Fact, ...])
"""A fact is a symbol, its objects and its value."""
_TEXTS: msgspec.json.Decoder[tuple[msgspec.Raw, ...]] = msgspec.json.Decoder(tuple[msgspec.Raw, ...])
"""Each fact as it is written."""


class _Reader:
    """Makes transitions of lines. Facts and objects that were read before are the same ones again: making and
    checking them takes most of the time."""

    def __init__(self, domain: Domain) -> None:
        self._symbols = {symbol.name: symbol for symbol in domain.symbols}
        self._arity = {action.name: len(action.parameters) for action in domain.actions}
        self._types = {each.name for each in domain.types}
        self._constants = frozenset(constant.name for constant in domain.constants)
        self._facts: dict[bytes, tuple[Fluent, Value]] = {}
        self._last: tuple[msgspec.Raw, tuple[Object, ...], Values] = (msgspec.Raw(), (), {})
        self._objects: dict[tuple[tuple[str, str], ...], tuple[Object, ...]] = {}

    def transition(self, line: bytes) -> Transition:
        """Raises ValueError, with the reason, for anything that is not a transition."""
        record = _decoded(_DECODER, line)
        if record.action not in self._arity:
            raise _NoAction(record.action)
        if len(record.arguments) != self._arity[record.action]:
            taken = plural(self._arity[record.action], "argument")
            raise ValueError(f"{record.action} takes {taken}, not {len(record.arguments)}")
        objects = self._objects_of(record.objects)
        known = self._constants.union(record.objects)
        if unknown := [name for name in record.arguments if name not in known]:
            raise ValueError(f"{unknown[0]!r} is not among its objects")
        # What came after one action is mostly what was before the next, word for word.
        raw, objects_then, values = self._last
        is_same = raw == record.before and objects_then is objects
        before = values if is_same else self._values(record.before, "before", known)
        after = self._values(record.after, "after", known)
        self._last = record.after, objects, after
        lasted = None if record.seconds is None else milliseconds(record.transit, record.seconds)
        expected = None if record.expected is None else round(1000 * record.expected)
        return Transition(record.action, record.arguments, objects, before, after, lasted, expected)

    def _objects_of(self, types: Mapping[str, str]) -> tuple[Object, ...]:
        key = tuple(types.items())
        if key not in self._objects:
            if unknown := [each for each in types.values() if each not in self._types]:
                raise ValueError(f"the domain has no type {unknown[0]!r}")
            remember(self._objects, key, tuple(Object(*each) for each in key))
        return self._objects[key]

    def _values(self, raw: msgspec.Raw, key: str, known: frozenset[str]) -> Values:
        written = _decoded(_TEXTS, raw, f" of {key}")
        texts = list(map(bytes, written))
        try:
            values = dict(map(self._facts.__getitem__, texts))
        except KeyError:
            listed = _decoded(_FACTS, raw, f" of {key}")
            values = dict(map(self._remembered, texts, listed))
        if len(values) < len(texts) or _FALSE in values:
            return self._with_care(_FACTS.decode(raw), values, key, known)
        _refuse_unlisted(values, key, known)
        return values

    def _with_care(
        self, listed: tuple[_Fact, ...], values: dict[Fluent, Value], key: str, known: frozenset[str]
    ) -> Values:
        """The values of facts of which one is false, or two are about one thing."""
        _refuse_unlisted(listed, key, known)
        if (twice := self._contradicted(listed)) is not None:
            raise ValueError(f"{key} gives {twice} two values")
        values.pop(_FALSE, None)
        return values

    def _contradicted(self, listed: Iterable[_Fact]) -> str | None:
        """A symbol for some objects that is given two values."""
        values: dict[Fluent, Value] = {}
        for name, objects, value in listed:
            fluent = name, self._symbols[name].canonical(objects)
            if values.setdefault(fluent, value) != value:
                return f"{name}({', '.join(objects)})"
        return None

    def _remembered(self, text: bytes, fact: _Fact) -> tuple[Fluent, Value]:
        if text not in self._facts:
            remember(self._facts, text, self._fact(*fact))
        return self._facts[text]

    def _fact(self, name: str, objects: tuple[str, ...], value: Value) -> tuple[Fluent, Value]:
        """A fluent and its value; `_FALSE` in place of the fluent for what a state leaves out."""
        symbol = self._symbols.get(name)
        if symbol is None or len(symbol.parameters) != len(objects):
            raise ValueError(f"the domain has no symbol {name!r} for {plural(len(objects), 'object')}")
        if type(value) is not type(symbol.values[0]) or value not in symbol.values:
            raise ValueError(f"{name} cannot be {value!r}")
        return _FALSE if value is False else (name, symbol.canonical(objects)), value


def _refuse_unlisted(about: Iterable[_Fact | Fluent], key: str, known: frozenset[str]) -> None:
    if not known.issuperset(itertools.chain.from_iterable(map(_objects_of, about))):
        raise ValueError(f"{key} names an object that is not listed")


def remember(known: dict[_Key, _Read], key: _Key, value: _Read, most: int = REMEMBERED) -> None:
    """Remember a value; all others are forgotten where there are too many."""
    if len(known) >= most:
        known.clear()
    known[key] = value


def _decoded(decoder: msgspec.json.Decoder[_Read], text: bytes | msgspec.Raw, where: str = "") -> _Read:
    """Raises ValueError, with the reason, for what is no JSON or of other types."""
    try:
        return decoder.decode(text)
    except msgspec.ValidationError as error:
        raise ValueError(f"{str(error)[0].lower()}{str(error)[1:]}{where}") from None
    except msgspec.DecodeError as error:
        raise ValueError(f"it is no JSON ({error})") from None
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
