"""Advice on declarations, settings, and the parts of rules and rewards."""

from __future__ import annotations

import re

from cleancli.language.parsing.hints.misplaced import Misplaced
from cleancli.language.parsing.hints.missing import near_keyword
from cleancli.language.parsing.lexemes import WORD


def function_or_count(at: Misplaced) -> str:
    """What a function lacks, and counts that other languages have."""
    if at.accepted == {"COLON"} and at.before.endswith(")") and at.token in ("-", "}"):
        return "a function says which values it has: `load(?a - area): 0..10`, or `: low < high`"
    if "TO" in at.accepted and at.token == "-":
        return "a range is written `0..10`"
    if at.kind == "VARIABLE" and re.search(r"[<>=]\s*count$", at.before):
        return "nothing is counted here: say what holds instead, as in `not exists ?a - area: dirt(?a)`"
    if at.accepted == {"COUNT"}:
        return "objects are all that can be counted: `n := count ?a - area: dirt(?a)`"
    if at.token == "(" and re.search(r"\bdecrease\s*\(\s*\w+$", at.before):
        return "`decrease` takes the name of a count that `derived` defines"
    if at.accepted == {"TIMES"}:
        return f"write `{at.before.split()[-1]} * {at.token}`"
    if at.token == "*" and "MINUS" in at.accepted and (name := re.search(rf"({WORD})$", at.before)):
        return f"the number stands first: `{at.after.split()[0] if at.after.split() else 2} * {name[1]}`"
    return ""


def setting(at: Misplaced) -> str:
    """Settings that other languages build otherwise."""
    if at.accepted == {"STRING"} and at.kind in ("NAME", "NUMBER"):
        return "paths, names of experience and hashes stand in quotation marks"
    if at.token == ":" and at.accepted == {"LBRACE"}:
        return f"a block is a word and braces: `{at.word_before} {{ ... }}`"
    if at.accepted == {"EQUAL"} and at.kind in ("NAME", "NUMBER", "STRING"):
        return "a value is given with `=`"
    if at.token == "=" and at.word_before == "goal":
        return "a goal is a block: `goal { forall ?a - area: not dirt(?a) }`"
    horizon = re.search(r"\bhorizon\s*=\s*(\w+)$", at.before)
    if horizon and at.token in "+-*/":
        number = re.match(r"\s*(\d+)\b", at.after)
        if at.token == "+" and number and not horizon[1].isdigit():
            return f"the number stands first: `horizon = {number[1]} + {horizon[1]}`"
        return "a horizon is a number, a count, their sum or `unlimited`: `horizon = 1 + dirty_areas`"
    return ""


def noted(at: Misplaced) -> str:
    """Marks of the learner with a sign, or that stand beside a duration and not behind it."""
    word = re.search(r"\b(?:prior|seen)$", at.before)
    if at.token == "=" and word and "NUMBER" in at.accepted:
        return f"no `=` stands behind `{word[0]}`: `[prior 0.2, seen 12]`"
    beside = re.search(r"\bduration\s*=\s*[^\[\]{}]*(?:\]|,\s*(?:prior|seen))$", at.before)
    if beside and (at.token == "[" or at.kind == "NUMBER"):
        return "what was noted of a duration stands behind it: `[duration = 5.8 s [prior 9 s, seen 12]]`"
    return ""


def header(at: Misplaced) -> str:
    """What stands between a name and its parameters or terms."""
    if at.token == ":" and at.is_behind_name:
        return "what it takes stands in parentheses behind the name: `push(?a - area)`"
    if at.token == "(" and at.accepted == {"COLON"}:
        return "a rule has a name of its own: `rule NAME: push(?a) { ... }`"
    return ""


def part_of_rule(at: Misplaced) -> str:
    if {"THEN", "WHEN"} <= at.accepted and at.kind in ("NAME", "NOT", "VARIABLE"):
        return near_keyword(at) or "a condition begins with `when`"
    if "THEN" in at.accepted and at.kind in ("NUMBER", "RATIONAL", "REST"):
        return "outcomes begin with `then`"
    is_result = re.search(r"\w\s*$", at.before) and re.match(r"[^()]*\)\s*:\s*(\d|rest\b)", at.after)
    if at.token == "(" and "COLON" in at.accepted and is_result:
        return "the probability stands in front: `0.1: wet(?a)`"
    return ""


def declaration(at: Misplaced) -> str:
    if at.token == ":" and at.word_before in ("when", "then", "with", "rest"):
        return f"no colon stands behind `{at.word_before}`"
    if at.token == "," and "MINUS" in at.accepted:
        some = "?a ?b" if "VARIABLE" in at.accepted else "a b"
        return f"what is of one type stands without commas, and its type behind it: `{some} - type`"
    if at.kind == "STRING" and "NAME" in at.accepted:
        return "names and words stand without quotes"
    if "MINUS" in at.accepted and "VARIABLE" in at.accepted:
        return "each list of variables ends with its type: `?a ?b - type`"
    if at.kind == "NAME" and "VARIABLE" in at.accepted and "NAME" not in at.accepted:
        return f"variables begin with a question mark: `?{at.token}`"
    return ""
