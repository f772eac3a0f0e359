"""libPRADA's files to records; every mistake is located, and one mistake hides only its own rule or line.

That names are declared and fit is checked in `check`.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise

from cleancli.conversion.records import Atom, Declaration, Kind, Library, LibraryRule, Result
from cleancli.conversion.scan import Scanner, Token, Unreadable, lines_of, scanner_of, tokens_of
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.source_lines import Lines
from cleancli.language.model import OutcomeKind

DEFAULT = "default"
_RESULTS = {"<no-change>": OutcomeKind.NOTHING, "<noise>": OutcomeKind.NOISE}
_KINDS = {kind.value: kind for kind in (Kind.ACTION, Kind.PRIMITIVE, Kind.COUNT)}


def read(rules: Source, state: Source, symbols: Source) -> Library:
    """What the texts say. Raises Refused with E911 for each rule, line or state that cannot be read."""
    found: list[Diagnostic] = []
    declared = tuple(_symbols(symbols, found))
    every = tuple(_rules(rules, found))
    facts = _state(state, found)
    if found:
        raise Refused(found, (rules, state, symbols))
    default = next((rule for rule in every if rule.action.symbol == DEFAULT), None)
    others = tuple(rule for rule in every if rule.action.symbol != DEFAULT)
    return Library(declared, others, default, facts, (rules, state, symbols))


# ---- symbols.dat


def _symbols(source: Source, found: list[Diagnostic]) -> Iterator[Declaration]:
    for scanner in lines_of(source):
        try:
            yield _declaration(scanner)
        except Unreadable as unreadable:
            found.append(unreadable.diagnostic)


def _declaration(scanner: Scanner) -> Declaration:
    """`near 2 primitive binary`, or `cleaned 0 count integers <-- Num X clean(X)`."""
    name = scanner.take("word", "the name of a symbol")
    arity = scanner.take("number", "the number of its arguments")
    if not arity.text.isdecimal():
        raise Unreadable(Diagnostic("E911", f"`{arity.text}` is no number of arguments", arity.span))
    kind = _KINDS.get(scanner.take("word", "`primitive`, `action` or `count`").text, Kind.OTHER)
    is_binary = scanner.take("word", "`binary` or `integers`").text == "binary"
    variables: list[str] = []
    condition: tuple[Atom, ...] = ()
    if kind is Kind.COUNT:
        scanner.take("arrow", "`<--` with what is counted")
        scanner.take("Num")
        while scanner.next is not None and scanner.next.text[0].isupper():
            variables.append(scanner.take("word").text)
            scanner.accept(":")
        condition = scanner.atoms()
        if not variables or not condition:
            raise scanner.misplaced("a variable and a literal" if not variables else "a literal")
    if kind in (Kind.ACTION, Kind.PRIMITIVE, Kind.COUNT) and scanner.next is not None:
        raise scanner.misplaced("the end of the line")
    return Declaration(name.text, int(arity.text), kind, is_binary, name.span, tuple(variables), condition)


# ---- rules.dat


def _rules(source: Source, found: list[Diagnostic]) -> Iterator[LibraryRule]:
    tokens = tokens_of(source)
    starts = [
        place
        for place, (token, after) in enumerate(pairwise(tokens))
        if (token.text, after.text) == ("ACTION", ":")
    ]
    try:
        _header(tokens[: starts[0] if starts else len(tokens)], len(starts), source)
    except Unreadable as unreadable:
        found.append(unreadable.diagnostic)
    lines = Lines(source.text)
    for start, end in pairwise([*starts, len(tokens)]):
        following = tokens[end].span.start if end < len(tokens) else len(source.text.rstrip())
        try:
            scanner = Scanner(tokens[start:end], Span(source.path, following, following), "rule")
            yield _rule(scanner, lines.place(tokens[start].span.start)[0])
        except Unreadable as unreadable:
            found.append(unreadable.diagnostic)


def _header(tokens: list[Token], rules: int, source: Source) -> None:
    """`#rules = 23`, which must be so; a file may do without, but not without rules."""
    after = tokens[-1].span.end if tokens else len(source.text)
    scanner = Scanner(tokens, Span(source.path, after, after), "text")
    if scanner.accept("#"):
        scanner.take("rules")
        scanner.take("=")
        number = scanner.take("number", "the number of rules")
        if number.text != str(rules):
            message = f"the file says that its rules number {number.text}, and has {rules}"
            raise Unreadable(Diagnostic("E911", message, number.span))
    if scanner.next is not None or not rules:
        raise scanner.misplaced("`ACTION:`")


def _rule(scanner: Scanner, line: int) -> LibraryRule:
    _title(scanner, "ACTION")
    action = scanner.atom()
    if action.value is not True:
        raise Unreadable(Diagnostic("E911", "expected an action with its arguments", action.span))
    _title(scanner, "CONTEXT")
    context = () if scanner.accept("empty") or scanner.sees("OUTCOMES") else _context(scanner)
    _title(scanner, "OUTCOMES")
    results = [_result(scanner)]
    while scanner.next is not None:
        results.append(_result(scanner))
    return LibraryRule(action, context, tuple(results), line)


def _title(scanner: Scanner, word: str) -> None:
    scanner.take(word, f"`{word}:`")
    scanner.take(":")


def _context(scanner: Scanner) -> tuple[Atom, ...]:
    found = []
    while not scanner.sees("OUTCOMES"):
        if not scanner.sees("-", "word"):
            raise scanner.misplaced("a literal or `OUTCOMES:`")
        found.append(scanner.atom())
        scanner.accept(",")
    return tuple(found)


def _result(scanner: Scanner) -> Result:
    probability = scanner.take("number", "an outcome's probability")
    kind = OutcomeKind.CHANGE
    effects: tuple[Atom, ...] = ()
    if scanner.sees("result"):
        word = scanner.take("result")
        if word.text not in _RESULTS:
            message = f"expected effects, `<no-change>` or `<noise>`, but there is `{word.text}`"
            raise Unreadable(Diagnostic("E911", message, word.span))
        kind = _RESULTS[word.text]
    elif not (effects := scanner.atoms()):
        raise scanner.misplaced("effects, `<no-change>` or `<noise>`")
    return Result(Fraction(probability.text), kind, effects, probability.span)


# ---- reward.dat


def read_reward(source: Source) -> tuple[Atom, ...]:
    """The literals that all have to hold, below the kind of the reward. Raises Refused (E911), also for
    rewards of other kinds."""
    found: list[Atom] = []
    kind: Token | None = None
    end = Span(source.path, len(source.text.rstrip()), len(source.text.rstrip()))
    try:
        for scanner in lines_of(source):
            if kind is None:
                kind = scanner.take("number", "0 for a literal, or 1 for several")
                if kind.text not in ("0", "1"):
                    message = f"rewards of kind {kind.text} are not converted"
                    help = "0 is a literal, 1 are several"
                    raise Unreadable(Diagnostic("E911", message, kind.span, help=help))
            found += scanner.all_atoms()
        if not found:
            raise Scanner((), end, "text").misplaced("0 or 1, and literals")
    except Unreadable as unreadable:
        raise Refused([unreadable.diagnostic], [source]) from None
    return tuple(found)


# ---- state.dat


def _state(source: Source, found: list[Diagnostic]) -> tuple[Atom, ...]:
    try:
        return scanner_of(source, 0, len(source.text.rstrip()), "text").all_atoms()
    except Unreadable as unreadable:
        found.append(unreadable.diagnostic)
        return ()
