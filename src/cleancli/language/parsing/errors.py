"""Where lark stops, said in the words of the language: what stands there, what could, what to do."""

from __future__ import annotations

import re
from collections.abc import Mapping

from lark import Token, UnexpectedCharacters, UnexpectedInput, UnexpectedToken

from cleancli.language.diagnostics.characters import for_character
from cleancli.language.diagnostics.diagnostic import Diagnostic, Span
from cleancli.language.parsing.hints.advice import for_token
from cleancli.language.parsing.hints.misplaced import Misplaced
from cleancli.language.parsing.lexemes import COMMENT, WORD

_WORDS = {
    "NAME": "a name",
    "VARIABLE": "a variable such as `?a`",
    "NUMBER": "a number",
    "STRING": "a text in quotes",
    "UNIT": "a unit",
    "OPERATOR": "`<=`, `>=` or `>`",
    "$END": "the end of the file",
}
_BLANKS = frozenset({"COMMENT", "BLANK"})
_IMPLIED = {
    "RATIONAL": "NUMBER",
    "MINUS": "NUMBER",
    "STRING": "NAME",
    "UNIT": "RBRACE",
    "OPERATOR": "EQUAL",
    "LESS": "EQUAL",
    "UNEQUAL": "EQUAL",
    "GRASP": "NAME",
}
"""Terminals that are not said to be expected where another one is."""
_BEHIND_SYMBOLS = ({"LPAR"}, {"LPAR", "RISE", "FALL"})
"""What may follow a symbol alone; in an outcome `reward` and `cost` have other things behind them."""
_MOST_SAID = 13
_FAR = 80
"""How many characters behind a token are looked at for what was meant."""
_FAR_BACK = 4000
"""And how many in front of it: those of whole lines."""


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
        span = self._span(start, start + 1)
        return Diagnostic(
            "E101", f"`{shown}` cannot stand here", span, help=for_character(character, error.allowed or ())
        )

    def _accepted(self, error: UnexpectedToken) -> set[str]:
        """The terminals that may stand where the parser stopped."""
        accepted = set(error.accepts or error.expected)
        start = error.token.start_pos or 0
        before = self._text[max(0, start - _FAR_BACK) : start].rstrip()
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
        at = self._misplaced(token, frozenset(accepted))
        start = int(token.start_pos or 0)
        return (
            self._bad_unit(start, at)
            or self._empty_place(start, at)
            or Diagnostic(
                "E104",
                f"`{token}` cannot stand here",
                self._span(start, start + len(token)),
                self._expected(accepted),
                for_token(at),
            )
        )

    def _misplaced(self, token: Token, accepted: frozenset[str]) -> Misplaced:
        start = int(token.start_pos or 0)
        near = self._text[max(0, start - _FAR_BACK) : start]
        near = near[near.find("\n") + 1 :] if start > _FAR_BACK else near
        before = re.sub(COMMENT, lambda comment: " " * len(comment[0]), near)
        words = tuple(self._keywords[name] for name in sorted(accepted) if name in self._keywords)
        behind = start + len(token)
        return Misplaced(
            str(token),
            token.type,
            accepted,
            before.rstrip(),
            self._text[behind : behind + _FAR],
            bool(before) and not before[-1].isspace(),
            words,
        )

    def _bad_unit(self, start: int, at: Misplaced) -> Diagnostic | None:
        """E107 for a word behind a number; a setting ends there, so it may have been taken for a key."""
        match = None
        if at.accepted == {"EQUAL", "LBRACE"}:
            match = re.search(rf"[0-9][ \t]*(?P<unit>{WORD})$", at.before)
        elif "UNIT" in at.accepted and "NAME" not in at.accepted and at.kind == "NAME":
            match = re.compile(r"(?P<unit>\w+)").match(self._text, start)
        if match is None:
            return None
        return Diagnostic(
            "E107",
            f"`{match['unit']}` is no unit",
            self._span(match.start("unit"), match.end("unit")),
            help="lengths are in m, cm or mm, angles in rad or deg, times in s or min",
        )

    def _empty_place(self, start: int, at: Misplaced) -> Diagnostic | None:
        """What is missing before the token and told best where it should stand: behind a comma or a name."""
        word = re.search(r"\w+$", at.before)
        comma = re.search(r",\s*(?:then|when|rest|forall|if)?$", at.before)
        is_end = at.kind in ("RBRACE", "RPAR", "RSQB") or (
            at.kind in ("NUMBER", "RATIONAL")
            and "NOT" in at.accepted
            and re.match(r"\s*[:\[]", at.after) is not None  # it begins an outcome
        )
        if comma and (at.is_behind_name or is_end):
            place = self._span(comma.start(), comma.start() + 1)
            return Diagnostic("E104", "nothing stands behind this comma", place, help="remove it")
        pays = word is not None and word.group() in ("reward", "cost")
        if at.accepted in _BEHIND_SYMBOLS and word and not pays and at.token != ":" and not for_token(at):
            return self._bare(word.group(), word.start(), "", "")
        return self._bare_in_condition(at)

    def _bare_in_condition(self, at: Misplaced) -> Diagnostic | None:
        """A name without parentheses where a condition's part begins: it could still be a term."""
        word = re.search(rf"(?<![?\w]){WORD}$", at.before)
        if word and at.accepted == {"LPAR", "EQUAL", "UNEQUAL"} and at.token != ":" and not for_token(at):
            behind = re.match(r"\s*(\w+)", at.after) if at.kind in ("LESS", "OPERATOR") else None
            return self._bare(word.group(), word.start(), at.token, behind[1] if behind else "")
        compared = re.search(rf"(?<![?\w])({WORD})\s*(=|!=)$", at.before)
        if compared and at.kind in ("NUMBER", "MINUS") and at.accepted == {"NAME", "VARIABLE"}:
            value = re.match(r"[^\s,})]*", at.after)
            return self._bare(
                compared[1], compared.start(), compared[2], at.token + (value[0] if value else "")
            )
        return None

    def _bare(self, name: str, start: int, relation: str, value: str) -> Diagnostic:
        """A predicate, function or count that stands without parentheses, perhaps compared with a value."""
        place = self._span(start, start + len(name))
        instead = "say what holds instead, as in `not exists ?a - area: dirt(?a)`"
        if re.search(rf"\b{name}\s*:=\s*count\b", self._text):
            help = f"counts are for rewards and horizons only: {instead}"
            return Diagnostic("E104", f"`{name}` is a count, which no condition asks for", place, help=help)
        help = f"write `{name}(...)`, or `{name}()` if it takes nothing"
        if name.lower() == "true":
            help = "leave the condition out where a rule always applies"
        if value:
            help = f"write `{name}(...) {relation} {value}`; if `{name}` is a count, {instead}"
        return Diagnostic("E104", f"`{name}` stands without its parentheses", place, help=help)

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
