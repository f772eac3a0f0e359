"""Advice on conditions and effects: negations, comparisons, steps of functions, quantifiers."""

from __future__ import annotations

import re

from cleancli.language.parsing.hints.misplaced import APPLICATION, RELATION, TERM, Misplaced
from cleancli.language.parsing.hints.pddl import LISTS


def denied_equality(at: Misplaced) -> str:
    """`not ?a = ?b`."""
    denied = re.match(rf"\s*=\s*({TERM})", at.after)
    if at.kind == "VARIABLE" and at.word_before == "not" and denied:
        return f"write `{at.token} != {denied[1]}`"
    return ""


def group(at: Misplaced) -> str:
    """`not (...)` and other parentheses around literals as they are written here."""
    if at.token != "(" or at.is_behind_name or "NAME" not in at.accepted:
        return ""
    if "REST" in at.accepted and re.match(r"\s*[\d.]", at.after):
        return "outcomes stand without parentheses: `then 0.8: wet(?a)  rest: nothing`"
    if re.search(r"\bnot$", at.before):
        return _denied_group(at)
    if re.match(rf"\s*\?\w+\s*!?=\s*{TERM}\s*\)", at.after) or _literal_within(at):
        return "the parts of a condition are joined by commas, without parentheses around them"
    return ""


def one_of(at: Misplaced) -> str:
    """What stands in parentheses otherwise than `(p(?a) or q(?a))`."""
    if at.accepted == {"OR"}:
        return "the parts of a condition are joined by commas, without parentheses around them"
    if re.search(r"\($", at.before) and "FORALL" not in at.accepted and "NOT" in at.accepted:
        return LISTS.get(at.token, "")
    inside = re.search(r"\(\s*([\w-]+)(?:\s*\(\s*[\w-]+)?$", at.before)
    if inside is None or at.kind not in ("VARIABLE", "NAME"):
        return ""
    if at.accepted == {"LPAR", "EQUAL", "UNEQUAL"}:
        return f"the name stands before the parenthesis: `{inside[1]}(...)`"
    return LISTS.get(inside[1], "") if at.accepted == {"RPAR", "COMMA"} else ""


def _denied_group(at: Misplaced) -> str:
    equality = re.match(rf"\s*(\?\w+)\s*=\s*({TERM})\s*\)", at.after)
    if equality:
        return f"write `{equality[1]} != {equality[2]}`"
    literal = _literal_within(at)
    if literal is None:
        return ""
    if re.match(r"\s*\)", at.after[literal.end() :]):
        return f"leave the outer parentheses out: `not {literal[1]}`"
    if "FORALL" not in at.accepted and "EXISTS" not in at.accepted:
        return "`not` stands before each effect: `not p(?a), not q(?a)`"
    return (
        "`not` denies one literal: where several are denied together, define a predicate in `derived`"
        " that holds where they all do, and deny that"
    )


def _literal_within(at: Misplaced) -> re.Match[str] | None:
    """The literal that stands first behind a parenthesis; None where a list of PDDL does."""
    literal = re.match(rf"\s*(?:not\s+)?({APPLICATION})", at.after)
    if literal is None or literal[1].partition("(")[0].strip() in LISTS:
        return None
    return literal


def compared_variable(at: Misplaced) -> str:
    """`?a < 3` and `?a = 3`."""
    term = re.search(r"(\?\w+)\s*!?=$", at.before) if at.kind == "NUMBER" else None
    if at.accepted == {"EQUAL", "UNEQUAL"} and at.kind in ("LESS", "OPERATOR"):
        compared = f"f({at.word_before}) {at.token} ..."
    elif term:
        compared = f"f({term[1]}) = {at.token}"
    else:
        return ""
    return f"a variable stands for an object: compare a function of it, `{compared}`"


def two_functions(at: Misplaced) -> str:
    """A function where a value stands: the language compares and sets with values only."""
    if at.accepted == {"NUMBER"} and at.kind == "NAME" and at.before.endswith(("+=", "-=")):
        return "what is added or taken away is a number: `f(?a) += 1`"
    sides = re.search(rf"({APPLICATION})\s*({RELATION}|:=)\s*(\w+)$", at.before)
    rest = re.match(r"[^()\r\n]*\)", at.after)
    if at.token != "(" or rest is None:
        return ""
    turned = re.search(r"(?<![?\w])(\w+)\s*(!?=)\s*(\w+)$", at.before)
    if turned:
        return f"the function stands on the left: `{turned[3]}({rest[0]} {turned[2]} {turned[1]}`"
    if sides is None:
        return ""
    left, relation, right = sides[1], sides[2], f"{sides[3]}({rest[0]}"
    if relation != ":=":
        return (
            "a function is compared with a value, not with another function: write a rule for each value v,"
            f" with `{left} {relation} v, {right} = v`"
        )
    shift = re.match(r"\s*([+-])\s*(\d+)", at.after[rest.end() :])
    if shift and left == right:
        return f"write `{left} {shift[1]}= {shift[2]}`"
    return "an effect gives a function a value, or adds a number to it: `f(?a) := 3`, `f(?a) += 1`"


def value_first(at: Misplaced) -> str:
    """`3 <= load(?a)`, and `small < size(?a)`, where the parser stops at the sign."""
    value, behind = at.token, at.after
    if at.kind != "NUMBER":
        value, behind = at.word_before, f"{at.token}{at.after}"
    match = re.match(rf"\s*({RELATION})\s*({APPLICATION})", behind)
    if match is None or not ({"NAME", "EQUAL"} & at.accepted) or not value.isalnum():
        return ""
    turned = match[1].translate(str.maketrans("<>", "><"))
    return f"the function stands on the left: `{match[2]} {turned} {value}`"


def step(at: Misplaced) -> str:
    """`load(?a)++`, `++load(?a)` and `load(?a) + 1` as effects."""
    if at.token not in ("+", "-", "*", "/"):
        return ""
    before = re.search(rf"({APPLICATION})$", at.before)
    if before and "RISE" in at.accepted:
        return _step_of(before[1], at)
    after = re.match(rf"[+-]\s*({APPLICATION})", at.after)
    if after and at.after.startswith(at.token):
        return f"write `{after[1]} {at.token}= 1`"
    if before and {"LESS", "EQUAL"} <= at.accepted and not at.after.startswith(">"):
        return "nothing is calculated in a condition: a function is compared with a value"
    return ""


def _step_of(function: str, at: Misplaced) -> str:
    amount = re.match(r"\s*(\d+)", at.after)
    is_doubled = at.after.startswith(at.token)
    if at.token in "+-" and (amount or is_doubled):
        return f"write `{function} {at.token}= {amount[1] if amount else 1}`"
    return "an effect sets a number, or adds one to it: `f(?a) := 3`, `f(?a) += 1`"


def quantifier(at: Misplaced) -> str:
    """Quantifiers without type or colon."""
    head = re.search(r"\b(exists|forall|count|with)\s+((?:\?\w+[\s,]*)+)$", at.before)
    if head and at.token == ":" and "MINUS" in at.accepted:
        return f"the type of the variables is missing: `{head[1]} {head[2].strip()} - type: ...`"
    typed = re.search(r"\b(exists|forall|count|with)\s+((?:\?\w+[\s,]*)+-\s*\w+)\s*,?$", at.before)
    if typed and (at.token in ("(", ".") or at.kind in ("NAME", "NOT")):
        return f"a colon stands behind the variables: `{typed[1]} {typed[2]}: ...`"
    if at.token == "=>" and re.search(r"\bforall\b[^{}]*:[^{}()]*\([^()]*\)\s*,", at.before):
        return (
            "several literals before `=>` stand in parentheses: `forall ?a - type: (p(?a), q(?a)) => r(?a)`"
        )
    return ""
