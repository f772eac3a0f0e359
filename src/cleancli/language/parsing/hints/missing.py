"""Advice on what is missing before a token, and on words that are almost those of the language."""

from __future__ import annotations

import difflib
import re

from cleancli.language.parsing.hints.misplaced import Misplaced

_CLOSERS = frozenset({"NUMBER", "RATIONAL", "REST", "THEN", "WITH", "WHEN", "RBRACE", "COLON"})
"""Terminals that stand behind literals and never within their parentheses."""


def unclosed(at: Misplaced) -> str:
    """A parenthesis that was opened before, where what follows shows that it should be closed by now."""
    opened = re.search(r"(\w+|:)\s*\((?:[^(){}]|\([^(){}]*\))*$", at.before)
    if opened is None or "RPAR" not in at.accepted:
        return ""
    if at.token == "(":
        # A term with terms of its own closes both; a literal that follows closes one.
        line = re.match(r"[^\r\n{}]*", at.after)
        assert line is not None
        is_cut = len(line[0]) == len(at.after) and "\n" not in at.after
        if is_cut or line[0].count(")") - line[0].count("(") >= 2:
            return ""
        return f"is a `)` missing? The `(` behind `{opened[1]}` is not closed"
    if at.kind in _CLOSERS or re.fullmatch(r"then|rest|with|when", at.token):
        return f"is a `)` missing before it? The `(` behind `{opened[1]}` is not closed"
    return ""


def near_keyword(at: Misplaced) -> str:
    words = [word for word in at.keywords if word.isalpha()]
    near = difflib.get_close_matches(at.token.lower(), words, n=1, cutoff=0.7)
    return f"did you mean `{near[0]}`?" if near else ""


def missing(at: Misplaced) -> str:
    if at.token == "(" and at.accepted == {"MINUS", "PLUS", "RBRACE"}:
        return "a reward is made of `decrease(COUNT)`, counts, `goal`, `cost` and `duration`"
    if "MINUS" in at.accepted and not at.accepted & {"NUMBER", "PLUS"}:
        return "each list of names ends with its type: `a b - type`"
    if "COMMA" in at.accepted and at.kind in ("NAME", "NOT", "FORALL", "VARIABLE"):
        return "is a comma missing before it?"
    if at.token == "(" and at.accepted == {"COLON", "LSQB"}:
        return "is a comma missing before the name?"
    if "COLON" in at.accepted and at.kind in ("NAME", "NOT", "NOTHING", "NOISE"):
        return "is a colon missing before it?"
    return ""
