"""Help for characters that the language does not know: what their writer often means."""

from __future__ import annotations

import unicodedata
from collections.abc import Container

_CHARACTERS = {
    "!": "write `not` before a predicate, `!=` between two terms",
    "~": "write `not` for negation",
    "&": "literals are joined by commas",
    "|": "of several literals one holds: `(p(?a) or q(?a))`",
    "(": "every construct starts with a word: `(and ...)` of PDDL is a list with commas here",
    ".": "numbers are written `0.5`, not `.5`, ranges `0..10`, and names have no points",
    "[": "marks in brackets follow a declaration or a probability",
    "?": "a variable is `?` with a name directly after it",
    "%": "a share is a number between 0 and 1: `0.8`, not `80%`",
    "/": "a comment begins with `#`, and only probabilities and costs are fractions",
    "*": "the language has no products",
    "°": "angles are in deg or rad",
    "×": "write the letter `x`",
    "≠": "write `!=`",
    "≤": "write `<=`",
    "≥": "write `>=`",
    "¬": "write `not` for negation",
    "∧": "literals are joined by commas",
    "∨": "of several literals one holds: `(p(?a) or q(?a))`",
    "∀": "write `forall`",
    "∃": "write `exists`",
    "→": "write `=>`",
    "⇒": "write `=>`",
    "≔": "write `:=`",
    "←": "write `:=`",
    "…": "a range is written `0..10`",
    '"': "names and words stand without quotes",
    "'": "names and words stand without quotes",
}


def for_character(character: str, accepted: Container[str] = ()) -> str:
    """Advice for a character that begins nothing, where these terminals could stand."""
    if "STRING" in accepted and character in "'\"":
        return 'a text in quotes stands between plain ones, in one line: `"base.nid"`'
    if character in _CHARACTERS:
        return _CHARACTERS[character]
    if unicodedata.category(character) == "Pd" or character == "−":
        return "this dash may have been copied with the text: write a plain `-`"
    if character.isspace():
        return "this blank is no plain space: it may have been copied with the text; type a space instead"
    if character.isalpha() or character.isdigit():
        return "names consist of the letters a to z, digits and `_`"
    if not character.isprintable():
        return "remove this character: it cannot be seen"
    if character not in "‘’‚‛“”„‟«»‹›`":
        return ""
    if "STRING" in accepted:
        return 'write plain quotation marks: `"`'
    return "names and words stand without quotes"
