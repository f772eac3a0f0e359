"""Advice on the words and lists of PDDL and PPDDL, and on words of Python."""

from __future__ import annotations

import re

from cleancli.language.parsing.hints.misplaced import Misplaced

_WORDS = {
    "and": "literals are joined by commas",
    "or": "of several literals one holds: `(p(?a) or q(?a))`",
    "if": "a condition begins with `when`",
    "when": "a rule has one `when`, before `with` and `then`; its literals are joined by commas",
    "else": "write a second rule for the other case",
    "not": "facts that are not listed are false: leave it out",
    "action": "an action is declared in `actions`, and what it does is said by a `rule NAME: push(?a)`",
    "precondition": "a condition begins with `when`",
    "effect": "outcomes begin with `then`: `then 0.8: wet(?a)  rest: nothing`",
    "requirements": "leave it out: nothing has to be required",
    "metric": "what is worth doing is said by the domain's `reward`",
    "include": "only a domain includes files, and between its sections",
    "probabilistic": "an outcome is its probability, a colon and what changes: `0.8: wet(?a)`",
    "maximize": "a reward is a sum of terms, and planners maximise it: leave the word out",
    "minimize": "a reward is a sum of terms, and planners maximise it: write `-` before what should fall",
}


_TAKEN_FOR_NAMES = frozenset({"probabilistic", "maximize", "minimize"})
"""Those of them that may stand where a name can, so that only the next token is misplaced."""


LISTS = {
    "and": "literals are joined by commas, without `and` and parentheses",
    "or": "of several literals one holds: `(p(?a) or q(?a))`",
    "not": "write `not p(?a)`",
    "either": "a type is one name: declare a type above both",
    "=": "write `f(?a) = value`",
    "<": "write `f(?a) < value`",
    ">": "write `f(?a) > value`",
    "<=": "write `f(?a) <= value`",
    ">=": "write `f(?a) >= value`",
    "increase": "write `f(?a) += 1`",
    "decrease": "write `f(?a) -= 1`",
    "assign": "an effect gives a function one of its values: `f(?a) := value`",
}
"""What the lists of PDDL are here, by their first word."""


def habit_word(at: Misplaced) -> str:
    words = _WORDS if at.is_behind_name else _TAKEN_FOR_NAMES
    if "NAME" not in at.accepted and at.word_before in words:
        return _WORDS[at.word_before]
    # Behind a probability `not` denies an effect: what is missing is the colon.
    return "" if at.token == "not" and "COLON" in at.accepted else _WORDS.get(at.token, "")


def list_of_pddl(at: Misplaced) -> str:
    if at.token != "(" or at.is_behind_name:
        return ""
    if at.word_before in ("exists", "forall", "count"):
        return f"variables stand without parentheses: `{at.word_before} ?m - area: wet(?m)`"
    match = re.match(r"\s*(:?[\w-]+|[<>]?=|[<>])", at.after)
    word = match[1] if match else ""
    if word.startswith(":"):
        return "a block is a word and braces: `types { ... }`"
    if word in LISTS:
        return LISTS[word]
    inside = re.search(r"(\w+)\s*\([^()]*$", at.before)
    if inside:
        return LISTS.get(inside[1], "terms are variables and objects: nothing else stands within parentheses")
    return "" if at.is_glued or not word else f"the name stands before the parenthesis: `{word}(...)`"


def term_of_list(at: Misplaced) -> str:
    inside = re.search(r"(\w+)\s*\([^()]*$", at.before)
    if inside is None:
        return ""
    if at.kind == "NUMBER":
        return LISTS.get(inside[1], "terms are variables and objects, not numbers")
    if at.token == "-" and at.accepted == {"RPAR", "COMMA"}:
        return "types stand in the declarations only: here write the variables, with commas"
    return ""
