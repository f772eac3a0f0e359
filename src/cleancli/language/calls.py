"""Actions with their objects as a user writes them on the command line."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
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
_CALL = re.compile(
    r"(?P<action>[\w-]+)\s*(?:\((?P<arguments>[^()]*)\))?"
    r"|\(\s*(?P<pddl_action>[\w-]+)(?P<pddl_arguments>(?:\s[^()]*)?)\)"
)
"""As in .nid files or, for who has PDDL's, `(walk-to kitchen)`. Names may have PDDL's hyphens, which are
underscores in what these files become."""
_HYPHENS = re.compile("-+")
_ABSENT = (-1, -1)
"""Where a part of an expression stands that matched nothing (`re`)."""
_ARGUMENT = re.compile(r"[^\s,]+")
_Place = tuple[str, int, int]


def read_action(text: str, domain: Domain, problem: Problem) -> Call:
    """An action like `join2(a1, a3)` or `(join2 a1 a3)`; raises Refused (E104, E205, E206, E208, E209)."""
    source, written = Source("ACTION", text), text.rstrip()
    match = _CALL.fullmatch(written, len(written) - len(written.lstrip()))
    if match is None:
        _refuse_other(source, 0, len(text), _example(domain, problem))
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
            example = _example(domain, problem)
            _refuse_other(source, place, len(text.rstrip()), f"{example} {example}")
        calls.append(_read(source, match, domain, problem))
        place = match.end()
    return tuple(calls)


def _read(source: Source, match: re.Match[str], domain: Domain, problem: Problem) -> Call:
    declared = {action.name: action for action in domain.actions}
    pddl = "" if match["action"] else "pddl_"
    action, arguments = match.span(f"{pddl}action"), match.span(f"{pddl}arguments")
    name = _as_declared(source.text[slice(*action)], declared, any_case=bool(pddl))
    if name not in declared:
        help = meant(name, declared, "action")
        _refuse(source, "E206", f"unknown action `{name}`", *action, help)
    places: list[_Place] = []
    if arguments != _ABSENT:
        places = [(m.group(), *m.span()) for m in _ARGUMENT.finditer(source.text, *arguments)]
    wanted = declared[name].parameters
    if len(places) != len(wanted):
        message = f"`{name}` takes {plural(len(wanted), 'object')}, not {len(places)}"
        help = f"it is declared as `{print_signature(name, wanted)}`"
        _refuse(source, "E208", message, *match.span(), help)
    return name, tuple(_objects(source, places, declared[name], domain, problem, any_case=bool(pddl)))


def _as_declared(name: str, declared: Collection[str], *, any_case: bool) -> str:
    """The name of something declared that a name with hyphens stands for, or else the name as it is. With
    `any_case`, as in PDDL, letter case says nothing, where it does not tell two things apart."""
    changed = _HYPHENS.sub("_", name)
    if changed in declared:
        return changed
    alike = [each for each in declared if any_case and each.lower() == changed.lower()]
    return alike[0] if len(alike) == 1 else name


def _objects(
    source: Source,
    places: Sequence[_Place],
    action: Action,
    domain: Domain,
    problem: Problem,
    *,
    any_case: bool,
) -> Iterator[str]:
    objects: dict[str, Object] = {o.name: o for o in (*domain.constants, *problem.objects)}
    for (written, start, end), parameter in zip(places, action.parameters, strict=True):
        name = _as_declared(written, objects, any_case=any_case)
        fitting = [o.name for o in objects.values() if domain.is_a(o.type, parameter.type)]
        help = meant(name, fitting, "object")
        if name not in objects:
            _refuse(source, "E205", f"unknown object `{name}`", start, end, help)
        if name not in fitting:
            message = f"`{name}` is of type `{objects[name].type}`, `{action.name}` wants `{parameter.type}`"
            _refuse(source, "E209", message, start, end, help)
        yield name


def _example(domain: Domain, problem: Problem) -> str:
    """An action of the domain on objects that fit, as far as there are any."""
    action = next((each for each in domain.actions if each.parameters), domain.actions[0])
    names = list[str]()
    for parameter in action.parameters:
        fitting = [
            o.name for o in (*problem.objects, *domain.constants) if domain.is_a(o.type, parameter.type)
        ]
        names.append(fitting[len(names) % len(fitting)] if fitting else "...")
    return f"{action.name}({', '.join(names)})"


def _refuse_other(source: Source, start: int, end: int, example: str) -> NoReturn:
    help = f"write for example `{example}`, in quotation marks for the shell"
    _refuse(source, "E104", "this is no action with its objects", start, end, help)


def _refuse(source: Source, code: str, message: str, start: int, end: int, help: str) -> NoReturn:
    raise Refused([Diagnostic(code, message, Span(source.path, start, end), help=help)], [source])
