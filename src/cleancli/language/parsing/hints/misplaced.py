"""A token that cannot stand where it does with the text around it, and phrases to look for there."""

from __future__ import annotations

from cleancli.language.parsing.lexemes import WORD
from cleancli.language.record import Record

APPLICATION = rf"\b{WORD}\s*\([^()]*\)"
TERM = rf"\??{WORD}"
RELATION = r"<=|>=|!=|<|>|="


class Misplaced(Record):
    """A token that cannot stand where it does.

    `kind` is its terminal and `accepted` are the terminals that could stand there; `before` is the text in
    front, without comments and blanks at its end, `after` the text directly behind; `is_glued` says that no
    blank stands in front, `keywords` what the accepted words are.
    """

    token: str
    kind: str
    accepted: frozenset[str]
    before: str
    after: str
    is_glued: bool
    keywords: tuple[str, ...]

    @property
    def is_behind_name(self) -> bool:
        """Whether a parenthesis that encloses terms or parameters could stand there, and not one that
        encloses literals."""
        return "LPAR" in self.accepted and "NOT" not in self.accepted

    @property
    def word_before(self) -> str:
        return self.before.split()[-1] if self.before else ""
