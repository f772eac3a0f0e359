"""What someone meant who writes PDDL, PPDDL, RDDL or Python into a .nid file: advice for a misplaced token.

Guaranteed by the parser: the token cannot stand where it does. Advice is given only where the text around it
shows the habit; an empty string says nothing.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable

from cleancli.language.record import Record

_CHARACTERS = {
    "!": "write `not` before a predicate, `!=` between two terms",
    "~": "write `not` for negation",
    "&": "literals are joined by commas",
    "|": "there is no `or`: write two rules",
    "(": "every construct starts with a word: `(and ...)` of PDDL is a list with commas here",
    ".": "numbers are written `0.5`, not `.5`",
    "[": "marks in brackets follow a declaration or a probability",
    "?": "a variable is `?` with a name directly after it",
    "%": "a share is a number between 0 and 1: `0.8`, not `80%`",
    "/": "a comment begins with `#`",
    "*": "the language has no products",
    "°": "angles are in deg or rad",
    "×": "write the letter `x`",
    '"': "names and words stand without quotes",
    "'": "names and words stand without quotes",
}
_WORDS = {
    "and": "literals are joined by commas",
    "or": "there is no `or`: write two rules",
    "if": "a condition begins with `when`",
    "when": "a rule has one `when`, before its outcomes; its literals are joined by commas",
    "else": "write a second rule for the other case",
    "not": "facts that are not listed are false: leave it out",
    "include": "only a domain includes files, and between its sections",
    "probabilistic": "an outcome is its probability, a colon and what changes: `0.8: wet(?a)`",
    "maximize": "a reward is a sum of terms, and planners maximise it: leave the word out",
    "minimize": "a reward is a sum of terms, and planners maximise it: write `-` before what should fall",
}
_TAKEN_FOR_NAMES = frozenset({"probabilistic", "maximize", "minimize"})
"""Those of them that may stand where a name can, so that only the next token is misplaced."""
_LISTS = {
    "and": "literals are joined by commas, without `and` and parentheses",
    "or": "there is no `or`: write two rules",
    "not": "write `not p(?a)`",
    "either": "a type is one name: declare a type above both",
    "=": "write `f(?a) = value`",
    "increase": "an effect gives a function one of its values: `f(?a) := value`",
    "decrease": "an effect gives a function one of its values: `f(?a) := value`",
    "assign": "an effect gives a function one of its values: `f(?a) := value`",
}
"""What the lists of PDDL are here, by their first word."""


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
    def word_before(self) -> str:
        return self.before.split()[-1] if self.before else ""


def for_character(character: str) -> str:
    """Advice for a character that begins nothing."""
    if character in _CHARACTERS:
        return _CHARACTERS[character]
    if character.isspace():
        return "this blank is no plain space: it may have been copied with the text; type a space instead"
    if character.isalpha() or character.isdigit():
        return "names consist of the letters a to z, digits and `_`"
    if not character.isprintable():
        return "remove this character: it cannot be seen"
    return "names and words stand without quotes" if character in "‘’‚“”„«»`" else ""


def for_token(at: Misplaced) -> str:
    """The first advice that fits."""
    for advice in _ADVICE:
        found = advice(at)
        if found:
            return found
    return ""


def _name_or_number(at: Misplaced) -> str:
    last = at.before[-1:]
    if at.token == "," and last.isdigit() and at.after[:1].isdigit():
        return "the decimal sign is a point: `0.1`"
    if at.is_glued and last.isdigit() and re.fullmatch(r"[eE]\d*", at.token):
        return "numbers are written without exponent: `0.1`, not `1e-1`"
    if at.is_glued and last.isdigit() and at.kind == "NUMBER":
        return "this number has too many digits"
    if at.kind == "NUMBER" and "NAME" in at.accepted and re.match(r"[A-Za-z_]", at.after):
        return "a name begins with a letter"
    is_in_name = at.is_glued and re.search(r"\w$", at.before) and re.match(r"\w", at.after)
    if at.token == "-" and is_in_name and "MINUS" not in at.accepted:
        return "names have no `-`: use `_`"
    return ""


def _list_of_pddl(at: Misplaced) -> str:
    if at.token == ":" and "LPAR" in at.accepted:
        return "what it takes stands in parentheses behind the name: `push(?a - area)`"
    if at.token == "(" and at.accepted == {"COLON"}:
        return "a rule has a name of its own: `rule NAME: push(?a) { ... }`"
    if at.token != "(" or "LPAR" in at.accepted:
        return ""
    if at.word_before in ("exists", "forall"):
        return f"variables stand without parentheses: `{at.word_before} ?m - area: wet(?m)`"
    match = re.match(r"\s*(:?[\w-]+|=)", at.after)
    word = match[1] if match else ""
    if word.startswith(":"):
        return "a block is a word and braces: `types { ... }`"
    if word in _LISTS:
        return _LISTS[word]
    if re.search(r"=\s*\w+$", at.before):
        return "the function stands on the left: `size(?a) = small`"
    inside = re.search(r"(\w+)\s*\([^()]*$", at.before)
    if inside:
        return _LISTS.get(
            inside[1], "terms are variables and objects: nothing else stands within parentheses"
        )
    return "" if at.is_glued or not word else f"the name stands before the parenthesis: `{word}(...)`"


def _term(at: Misplaced) -> str:
    inside = re.search(r"(\w+)\s*\([^()]*$", at.before)
    if inside is None:
        return ""
    if at.kind == "NUMBER":
        return _LISTS.get(inside[1], "terms are variables and objects, not numbers")
    if at.token == "-" and at.accepted == {"RPAR", "COMMA"}:
        return "types stand in the declarations only: here write the variables, with commas"
    return ""


def _habit_word(at: Misplaced) -> str:
    words = _WORDS if "LPAR" in at.accepted else _TAKEN_FOR_NAMES
    if "NAME" not in at.accepted and at.word_before in words:
        return _WORDS[at.word_before]
    return _WORDS.get(at.token, "")


def _setting(at: Misplaced) -> str:
    """Settings of a problem that other languages build otherwise."""
    if at.token == "=" and at.word_before == "goal":
        return "a goal is a block: `goal { forall ?a - area: not dirt(?a) }`"
    if at.token == "*" and re.search(r"horizon\s*=\s*\w+$", at.before):
        return "a horizon is a number, a count or their sum: `horizon = 1 + dirty_areas`"
    return ""


def _sign(at: Misplaced) -> str:
    last = at.before[-1:]
    if at.token == "=" and last == "=" and at.is_glued:
        return "equality is one `=`"
    if at.token == ">" and last == "<" and at.is_glued:
        return "write `!=`"
    if at.token == "-" and at.after.startswith(">") and "IMPLIES" in at.accepted:
        return "write `=>`"
    if at.token == "=" and at.accepted == {"ASSIGN"}:
        return "a count is defined with `:=`"
    if at.token == "=" and "ASSIGN" in at.accepted:
        return "an effect sets a value with `:=`; `=` compares in a condition"
    if at.token == ":=" and "EQUAL" in at.accepted:
        return "`:=` sets a value in an effect; here write `=`"
    if at.token == ":" and "EQUAL" in at.accepted:
        return "a value is given with `=`"
    if at.token == "-" and "NUMBER" in at.accepted:
        return "the number must not be negative"
    return ""


def _separator(at: Misplaced) -> str:
    if at.token == "," and at.before.endswith(","):
        return "one comma is enough"
    if at.token == ";" and "SEMICOLON" not in at.accepted:
        return "nothing is separated by `;` here, and a comment begins with `#`"
    if at.token == "," and "SEMICOLON" in at.accepted:
        return "types are separated by `;`: `place; area - place`"
    if at.token in (",", ">") and "LESS" in at.accepted and "EQUAL" not in at.accepted:
        return "the values of a function stand in rising order: `low < high`"
    if (
        at.token == ","
        and re.search(r"(\d|\b[a-z]+)$", at.before)
        and {"NAME", "RBRACE"} == at.accepted - {"GRASP"}
    ):
        return "settings stand without commas, a point in parentheses: `(0 cm, 0 cm)`"
    if re.search(r"\)\s*(mm|cm|m)$", at.before) and "EQUAL" in at.accepted:
        return "each number has its own unit: `(0 cm, 0 cm)`"
    return ""


def _part_of_rule(at: Misplaced) -> str:
    if {"THEN", "WHEN"} <= at.accepted and at.kind in ("NAME", "NOT", "VARIABLE"):
        return _near(at) or "a condition begins with `when`"
    if "THEN" in at.accepted and at.kind in ("NUMBER", "RATIONAL", "REST"):
        return "outcomes begin with `then`"
    is_result = re.search(r"\w\s*$", at.before) and re.match(r"[^()]*\)\s*:\s*(\d|rest\b)", at.after)
    if at.token == "(" and "COLON" in at.accepted and is_result:
        return "the probability stands in front: `0.1: wet(?a)`"
    return ""


def _declaration(at: Misplaced) -> str:
    if "MINUS" in at.accepted and "VARIABLE" in at.accepted:
        return "each list of variables ends with its type: `?a ?b - type`"
    if at.kind == "NAME" and "VARIABLE" in at.accepted and "NAME" not in at.accepted:
        return f"variables begin with a question mark: `?{at.token}`"
    return ""


def _near(at: Misplaced) -> str:
    words = [word for word in at.keywords if word.isalpha()]
    near = difflib.get_close_matches(at.token.lower(), words, n=1, cutoff=0.7)
    return f"did you mean `{near[0]}`?" if near else ""


def _missing(at: Misplaced) -> str:
    if at.token == "(" and at.accepted == {"MINUS", "PLUS", "RBRACE"}:
        return "a reward is made of `decrease(COUNT)`, counts, `goal` and `cost`"
    if "MINUS" in at.accepted and not at.accepted & {"NUMBER", "PLUS"}:
        return "each list of names ends with its type: `a b - type`"
    if "COMMA" in at.accepted and at.kind in ("NAME", "NOT", "FORALL", "VARIABLE"):
        return "is a comma missing before it?"
    if at.token == "(" and at.accepted == {"COLON", "LSQB"}:
        return "is a comma missing before the name?"
    if "COLON" in at.accepted and at.kind in ("NAME", "NOT", "NOTHING", "NOISE"):
        return "is a colon missing before it?"
    return ""


_ADVICE: tuple[Callable[[Misplaced], str], ...] = (
    _name_or_number,
    _habit_word,
    _setting,
    _list_of_pddl,
    _sign,
    _separator,
    _term,
    _part_of_rule,
    _declaration,
    _near,
    _missing,
)
"""The nearer to what is certain, the earlier."""
