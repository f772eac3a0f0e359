"""Transitions as they happened: one JSON object a line, symbols only (what perception reported)."""

from __future__ import annotations

from dataclasses import dataclass

from cleancli.language.model import Object, State


@dataclass(frozen=True, slots=True)
class Transition:
    """An executed action between two observed states; `objects` are those of both states, sorted."""

    action: str
    arguments: tuple[str, ...]
    objects: tuple[Object, ...]
    before: State
    after: State
