"""Where lark stops, said in the words of the language: what stands there, what could, what to do."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping

from lark import Token, UnexpectedCharacters, UnexpectedInput, UnexpectedToken

from cleancli.language.diagnostics import Diagnostic, Span

_WORDS = {
    "NAME": "a name",
    "VARIABLE": "a variable such as `?a`",
    "NUMBER": "a number",
    "STRING": "a path in quotes",
    "UNIT": "a unit",
    "OPERATOR": "`<=`, `>=` or `>`",
    "$END": "the end of the file",
}
_BLANKS = frozenset({"COMMENT", "BLANK"})
_IMPLIED = {
    "RATIONAL": "NUMBER",
    "MINUS": "NUMBER",
    "UNIT": "RBRACE",
    "OPERATOR": "EQUAL",
    "LESS": "EQUAL",
    "UNEQUAL": "EQUAL",
}
"""Terminals that are not said to be expected where another one is."""
_MOST_SAID = 12

_HABITS = {
    "!": "write `not` before a predicate, `!=` between two terms",
    "~": "write `not` for negation",
    "&": "literals are joined by commas",
    "|": "there is no `or`: write two rules",
    "(": "every construct starts with a word: `(and ...)` of PDDL is a list with commas here",
    ".": "numbers are written `0.5`, not `.5`",
    "[": "marks in brackets follow a declaration or a probability",
}
_HABIT_WORDS = {
    "and": "literals are joined by commas",
    "or": "there is no `or`: write two rules",
    "if": "a condition begins with `when`",
    "when": "a rule has one `when`, before its outcomes",
    "else": "write a second rule for the other case",
    "not": "facts that are not listed are false: leave it out",
    "include": "only a domain includes files, and between its sections",
}


class Reader:
    """Turns lark's errors into diagnostics.

    `keywords` maps terminal names to the text they stand for; the file itself ends at offset `end` of `text`.
    """

    def __init__(self, path: str, text: str, end: int, keywords: Mapping[str, str]) -> None:
        self._end = end
        self._path = path
        self._text = text
        self._keywords = keywords

    def diagnose(self, error: UnexpectedInput) -> Diagnostic:
        """E101 for a character that begins nothing, E104 for a misplaced token, E107 for a bad unit."""
        if isinstance(error, UnexpectedCharacters):
            return self._character(error)
        assert isinstance(error, UnexpectedToken)
        return self._token(error)

    def _character(self, error: UnexpectedCharacters) -> Diagnostic:
        start = error.pos_in_stream or 0
        character = self._text[start]
        shown = character if character.isprintable() else f"U+{ord(character):04X}"
        advice = _HABITS.get(character, "")
        if not advice and (character.isalpha() or character.isdigit()):
            advice = "names consist of the letters a to z, digits and `_`"
        if character == "?":
            advice = "a variable is `?` with a name directly after it"
        return Diagnostic("E101", f"`{shown}` cannot stand here", self._span(start, start + 1), help=advice)

    def _accepted(self, error: UnexpectedToken) -> set[str]:
        """The terminals that may stand where the parser stopped."""
        accepted = set(error.accepts or error.expected)
        before = self._text[: error.token.start_pos or 0].rstrip()
        if accepted == {"THEN", "WITH"} and not before.endswith("{"):
            # The parser had already ended the condition, because in `derived` a name may follow one.
            accepted.add("COMMA")
        return accepted

    def _token(self, error: UnexpectedToken) -> Diagnostic:
        token = error.token
        accepted = self._accepted(error)
        if token.type == "$END" or int(token.start_pos or 0) >= self._end:
            end = len(self._text[: self._end].rstrip())
            return Diagnostic(
                "E104", "the file ends too early", self._span(max(end - 1, 0), end), self._expected(accepted)
            )
        start = int(token.start_pos or 0)
        bad_unit = self._bad_unit(start, accepted)
        if bad_unit is not None:
            return bad_unit
        return Diagnostic(
            "E104",
            f"`{token}` cannot stand here",
            self._span(start, start + len(token)),
            self._expected(accepted),
            self._advice(token, accepted),
        )

    def _bad_unit(self, start: int, accepted: set[str]) -> Diagnostic | None:
        if accepted != {"EQUAL", "LBRACE"}:
            return None
        match = re.search(r"[0-9][ \t]*(?P<unit>[A-Za-z_]\w*)\s*$", self._text[:start])
        if match is None:
            return None
        return Diagnostic(
            "E107",
            f"`{match['unit']}` is no unit",
            self._span(match.start("unit"), match.end("unit")),
            help="lengths are in m, cm or mm, angles in rad or deg, times in s or min",
        )

    def _advice(self, token: Token, accepted: set[str]) -> str:
        before = self._text[: token.start_pos or 0].split()
        if accepted == {"LPAR"} and before and before[-1] in _HABIT_WORDS:
            return _HABIT_WORDS[before[-1]]
        if token == "," and before and before[-1][-1].isdigit():
            return "the decimal sign is a point: `0.1`"
        if "MINUS" in accepted and "VARIABLE" in accepted:
            return "each list of variables ends with its type: `?a ?b - type`"
        if token == "=" and "ASSIGN" in accepted:
            return "an effect sets a value with `:=`; `=` compares in a condition"
        if token == ":=" and "EQUAL" in accepted:
            return "`:=` sets a value in an effect; here write `=`"
        if token.type == "NAME" and "VARIABLE" in accepted and "NAME" not in accepted:
            return f"variables begin with a question mark: `?{token}`"
        if token == "-" and "NUMBER" in accepted:
            return "the number must not be negative"
        words = [self._keywords[name] for name in sorted(accepted) if name in self._keywords]
        near = difflib.get_close_matches(token, [w for w in words if w.isalpha()], n=1, cutoff=0.7)
        if near:
            return f"did you mean `{near[0]}`?"
        if token.type == "NAME" and token in _HABIT_WORDS:
            return _HABIT_WORDS[token]
        return self._missing(token, accepted)

    def _missing(self, token: Token, accepted: set[str]) -> str:
        if token == "(" and accepted == {"MINUS", "PLUS", "RBRACE"}:
            return "a reward is made of `decrease(COUNT)`, counts, `goal` and `cost`"
        if "MINUS" in accepted and not accepted & {"NUMBER", "PLUS"}:
            return "each list of names ends with its type: `a b - type`"
        if "COMMA" in accepted and token.type in ("NAME", "NOT", "FORALL", "VARIABLE"):
            return "is a comma missing before it?"
        if token == "(" and accepted == {"COLON", "LSQB"}:
            return "is a comma missing before the name?"
        if "COLON" in accepted and token.type in ("NAME", "NOT", "NOTHING", "NOISE"):
            return "is a colon missing before it?"
        return ""

    def _expected(self, accepted: set[str]) -> str:
        names = {name for name in accepted if name not in _BLANKS and _IMPLIED.get(name) not in accepted}
        words = [_WORDS.get(name) or f"`{self._keywords.get(name, name)}`" for name in names]
        words.sort(key=lambda word: (not word[1].isalpha(), word))
        if not words or len(words) > _MOST_SAID:
            return ""
        *most, last = words
        return f"expected {', '.join(most)} or {last}" if most else f"expected {last}"

    def _span(self, start: int, end: int) -> Span:
        return Span(self._path, start, end)
