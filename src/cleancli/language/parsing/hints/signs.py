"""Advice on numbers, signs, separators and braces as other languages write them."""

from __future__ import annotations

import re

from cleancli.language.parsing.hints.misplaced import Misplaced

_WORD = re.compile(r"[A-Za-z_]\w*")


def name_or_number(at: Misplaced) -> str:
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
    if at.is_glued and _WORD.fullmatch(at.token) and _WORD.fullmatch(at.word_before):
        return f"did you mean `{at.word_before}`, and not `{at.word_before}{at.token}`?"
    if at.token == "+" and at.is_glued and at.word_before == "prada":
        return 'a study writes `prada_plus`, and a problem `name = "prada+"`'
    return ""


def braces(at: Misplaced) -> str:
    """Braces in a rule, which has none but its own."""
    if at.token != "{":
        return ""
    if at.word_before == "then":
        return "outcomes stand without braces: `then 0.8: wet(?a)  rest: nothing`"
    if at.word_before in ("when", "with"):
        return f"what follows `{at.word_before}` stands without braces"
    if at.before.endswith("=>"):
        return "several effects stand in parentheses: `forall ?m - area: wet(?m) => (p(?m), q(?m))`"
    if at.before.endswith(":"):
        return "effects stand without braces, joined by commas: `0.8: wet(?a), not dirt(?a)`"
    return ""


def relation(at: Misplaced) -> str:
    """`==` and `<>`."""
    last = at.before[-1:] if at.is_glued else ""
    if at.token == "=" and last == "=":
        return "equality is one `=`"
    if f"{at.token}{at.after}".startswith("<>") or (at.token == ">" and last == "<"):
        return "write `!=`"
    return ""


def sign(at: Misplaced) -> str:
    """One of the signs for values, effects and implications where another one stands."""
    match at.token:
        case "-" if at.after.startswith(">"):
            return "write `=>`" if "IMPLIES" in at.accepted else "`=>` stands within `forall` and `if` only"
        case "=" if "ASSIGN" in at.accepted <= {"ASSIGN", "LPAR"}:
            return "a count is defined with `:=`"
        case "=" if "ASSIGN" in at.accepted:
            return "an effect sets a value with `:=`; `=` compares in a condition"
        case ":=" if "EQUAL" in at.accepted:
            return "`:=` sets a value in an effect; here write `=`"
        case ":" if "EQUAL" in at.accepted:
            return "a value is given with `=`"
        case "-" if "NUMBER" in at.accepted:
            return "the number must not be negative"
    return ""


def separator(at: Misplaced) -> str:
    if at.token == "," and at.before.endswith(","):
        return "one comma is enough"
    if at.token == ";":
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
