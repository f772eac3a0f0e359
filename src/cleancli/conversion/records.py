"""What libPRADA's files say, with places; names are as in the files.

The format, as its files show it: `symbols.dat` has a line for each symbol, `rules.dat` blocks of ACTION,
CONTEXT and OUTCOMES, `state.dat` the facts. Words that begin with a capital are variables, numbers and other
words constants.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass
from fractions import Fraction

from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.model import OutcomeKind


class Kind(enum.Enum):
    """What a symbol is; `OTHER` follows from others in a way that .nid files have no word for."""

    ACTION = "action"
    PRIMITIVE = "primitive"
    COUNT = "count"
    OTHER = "other"


@dataclass(frozen=True, slots=True)
class Atom:
    """A literal: how the symbol's value compares with `value`; `=` for what is true or false."""

    symbol: str
    terms: tuple[str, ...]
    relation: str
    value: bool | int
    span: Span


@dataclass(frozen=True, slots=True)
class Declaration:
    """A line of symbols.dat; a count counts the bindings of `variables` that satisfy `condition`."""

    name: str
    arity: int
    kind: Kind
    is_binary: bool
    span: Span
    variables: tuple[str, ...] = ()
    condition: tuple[Atom, ...] = ()


@dataclass(frozen=True, slots=True)
class Result:
    """An outcome; `span` is that of its probability."""

    probability: Fraction
    kind: OutcomeKind
    effects: tuple[Atom, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class LibraryRule:
    """A rule; `action` is the atom under ACTION. `line` counts from 1."""

    action: Atom
    context: tuple[Atom, ...]
    results: tuple[Result, ...]
    line: int


@dataclass(frozen=True, slots=True)
class Library:
    """The three files; `default` is the rule for `default()`, if there is one."""

    symbols: tuple[Declaration, ...]
    rules: tuple[LibraryRule, ...]
    default: LibraryRule | None
    facts: tuple[Atom, ...]
    sources: tuple[Source, Source, Source]


def is_variable(term: str) -> bool:
    """Whether a term is a variable and no constant."""
    return term[0].isupper()


def variables_of(*atoms: Atom) -> tuple[str, ...]:
    """The variables of atoms, each once, in their order."""
    return tuple(dict.fromkeys(term for atom in atoms for term in atom.terms if is_variable(term)))
