"""Actions with their objects as a user writes them on the command line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NoReturn

from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import meant
from cleancli.language.model import Action, Domain, Object, Problem
from cleancli.language.printing.printer import print_signature

Call = tuple[str, tuple[str, ...]]
"""An action's name and the names of its objects."""

_BETWEEN = " \t\r\n,;"
_CALL = re.compile(r"(?P<action>\w+)\s*(?:\((?P<arguments>[^()]*)\))?")
_ARGUMENT = re.compile(r"[^\s,]+")
_Place = tuple[str, int, int]


def read_action(text: str, domain: Domain, problem: Problem) -> Call:
    """An action like `join2(a1, a3)`; raises Refused (E104, E205, E206, E208, E209)."""
    source, written = Source("ACTION", text), text.rstrip()
    match = _CALL.fullmatch(written, len(written) - len(written.lstrip()))
    if match is None:
        help = "write for example `join2(a1, a3)`, in quotation marks for the shell"
        _refuse(source, "E104", "this is no action with its objects", 0, len(text), help)
    return _read(source, match, domain, problem)


def read_actions(text: str, domain: Domain, problem: Problem) -> tuple[Call, ...]:
    """Actions like `wipe(s1) join2(a1, a3)`, blanks and commas between them being free; perhaps none.

    Raises Refused as `read_action` does.
    """
    source, calls, place = Source("ACTIONS", text), list[Call](), 0
    while left := text[place:].lstrip(_BETWEEN):
        place = len(text) - len(left)
        match = _CALL.match(text, place)
        if match is None:
            help = "write for example `wipe(s1) join2(a1, a3)`, in quotation marks for the shell"
            _refuse(source, "E104", "this is no action with its objects", place, len(text.rstrip()), help)
        calls.append(_read(source, match, domain, problem))
        place = match.end()
    return tuple(calls)


def _read(source: Source, match: re.Match[str], domain: Domain, problem: Problem) -> Call:
    name = match["action"]
    declared = {action.name: action for action in domain.actions}
    if name not in declared:
        help = meant(name, declared, "action")
        _refuse(source, "E206", f"unknown action `{name}`", match.start("action"), match.end("action"), help)
    start = max(match.start("arguments"), 0)
    places = [
        (m.group(), start + m.start(), start + m.end()) for m in _ARGUMENT.finditer(match["arguments"] or "")
    ]
    wanted = declared[name].parameters
    if len(places) != len(wanted):
        message = f"`{name}` takes {plural(len(wanted), 'object')}, not {len(places)}"
        help = f"it is declared as `{print_signature(name, wanted)}`"
        _refuse(source, "E208", message, match.start("action"), match.end(), help)
    _check_objects(source, places, declared[name], domain, problem)
    return name, tuple(place[0] for place in places)


def _check_objects(
    source: Source, places: Sequence[_Place], action: Action, domain: Domain, problem: Problem
) -> None:
    objects: dict[str, Object] = {o.name: o for o in (*domain.constants, *problem.objects)}
    for (name, start, end), parameter in zip(places, action.parameters, strict=True):
        fitting = [o.name for o in objects.values() if domain.is_a(o.type, parameter.type)]
        help = meant(name, fitting, "object")
        if name not in objects:
            _refuse(source, "E205", f"unknown object `{name}`", start, end, help)
        if name not in fitting:
            message = f"`{name}` is of type `{objects[name].type}`, `{action.name}` wants `{parameter.type}`"
            _refuse(source, "E209", message, start, end, help)


def _refuse(source: Source, code: str, message: str, start: int, end: int, help: str) -> NoReturn:
    raise Refused([Diagnostic(code, message, Span(source.path, start, end), help=help)], [source])
