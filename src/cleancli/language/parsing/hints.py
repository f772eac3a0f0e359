"""What someone meant who writes PDDL, PPDDL, RDDL or Python into a .nid file: advice for a misplaced token.

Guaranteed by the parser: the token cannot stand where it does. Advice is given only where the text around it
shows the habit; an empty string says nothing.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable

from cleancli.language.parsing.lexemes import WORD
from cleancli.language.record import Record

_WORDS = {
    "and": "literals are joined by commas",
    "or": "there is no `or`: write two rules",
    "if": "a condition begins with `when`",
    "when": "a rule has one `when`, before its outcomes; its literals are joined by commas",
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
_LISTS = {
    "and": "literals are joined by commas, without `and` and parentheses",
    "or": "there is no `or`: write two rules",
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


_APPLICATION = rf"\b{WORD}\s*\([^()]*\)"
_TERM = rf"\??{WORD}"
_RELATION = r"<=|>=|!=|<|>|="
_CLOSERS = frozenset({"NUMBER", "RATIONAL", "REST", "THEN", "WITH", "WHEN", "RBRACE", "COLON"})
"""Terminals that stand behind literals and never within their parentheses."""


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


def for_token(at: Misplaced) -> str:
    """The first advice that fits."""
    for advice in _ADVICE:
        found = advice(at)
        if found:
            return found
    return ""


def _function_or_count(at: Misplaced) -> str:
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


def _braces(at: Misplaced) -> str:
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


def _negation_of_group(at: Misplaced) -> str:
    """`not (...)` and other parentheses around literals as they are written here."""
    denied = re.match(rf"\s*=\s*({_TERM})", at.after)
    if at.kind == "VARIABLE" and at.word_before == "not" and denied:
        return f"write `{at.token} != {denied[1]}`"
    if at.token != "(" or "LPAR" in at.accepted or "NAME" not in at.accepted:
        return ""
    if "REST" in at.accepted and re.match(r"\s*[\d.]", at.after):
        return "outcomes stand without parentheses: `then 0.8: wet(?a)  rest: nothing`"
    is_denied = bool(re.search(r"\bnot$", at.before))
    equality = re.match(rf"\s*(\?\w+)\s*=\s*({_TERM})\s*\)", at.after)
    if not is_denied and re.match(rf"\s*\?\w+\s*!?=\s*{_TERM}\s*\)", at.after):
        return "the parts of a condition are joined by commas, without parentheses around them"
    if is_denied and equality:
        return f"write `{equality[1]} != {equality[2]}`"
    literal = re.match(rf"\s*(?:not\s+)?({_APPLICATION})", at.after)
    if literal is None or literal[1].partition("(")[0].strip() in _LISTS:
        return ""
    if not is_denied:
        return "the parts of a condition are joined by commas, without parentheses around them"
    if re.match(r"\s*\)", at.after[literal.end() :]):
        return f"leave the outer parentheses out: `not {literal[1]}`"
    if "FORALL" not in at.accepted and "EXISTS" not in at.accepted:
        return "`not` stands before each effect: `not p(?a), not q(?a)`"
    return (
        "`not` denies one literal: where several are denied together, define a predicate in `derived`"
        " that holds where they all do, and deny that"
    )


def _two_functions(at: Misplaced) -> str:
    """A function where a value stands: the language compares and sets with values only."""
    if at.accepted == {"NUMBER"} and at.kind == "NAME" and at.before.endswith(("+=", "-=")):
        return "what is added or taken away is a number: `f(?a) += 1`"
    sides = re.search(rf"({_APPLICATION})\s*({_RELATION}|:=)\s*(\w+)$", at.before)
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


def _value_first(at: Misplaced) -> str:
    """`3 <= load(?a)`, and `small < size(?a)`, where the parser stops at the sign."""
    value, behind = at.token, at.after
    if at.kind != "NUMBER":
        value, behind = at.word_before, f"{at.token}{at.after}"
    match = re.match(rf"\s*({_RELATION})\s*({_APPLICATION})", behind)
    if match is None or not ({"NAME", "EQUAL"} & at.accepted) or not value.isalnum():
        return ""
    turned = match[1].translate(str.maketrans("<>", "><"))
    return f"the function stands on the left: `{match[2]} {turned} {value}`"


def _step(at: Misplaced) -> str:
    """`load(?a)++`, `++load(?a)` and `load(?a) + 1` as effects."""
    if at.token not in ("+", "-", "*", "/"):
        return ""
    before = re.search(rf"({_APPLICATION})$", at.before)
    if before and "RISE" in at.accepted:
        amount = re.match(r"\s*(\d+)", at.after)
        is_doubled = at.after.startswith(at.token)
        if at.token in "+-" and (amount or is_doubled):
            return f"write `{before[1]} {at.token}= {amount[1] if amount else 1}`"
    after = re.match(rf"[+-]\s*({_APPLICATION})", at.after)
    if after and at.after.startswith(at.token):
        return f"write `{after[1]} {at.token}= 1`"
    if before and "RISE" in at.accepted:
        return "an effect sets a number, or adds one to it: `f(?a) := 3`, `f(?a) += 1`"
    if before and {"LESS", "EQUAL"} <= at.accepted and not at.after.startswith(">"):
        return "nothing is calculated in a condition: a function is compared with a value"
    return ""


def _unclosed(at: Misplaced) -> str:
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


def _quantifier(at: Misplaced) -> str:
    """Quantifiers without type or colon."""
    head = re.search(r"\b(exists|forall|count|with)\s+((?:\?\w+[\s,]*)+)$", at.before)
    if head and at.token == ":" and "MINUS" in at.accepted:
        return f"the type of the variables is missing: `{head[1]} {head[2].strip()} - type: ...`"
    typed = re.search(r"\b(exists|forall|count|with)\s+((?:\?\w+[\s,]*)+-\s*\w+)\s*,?$", at.before)
    if typed and (at.token in ("(", ".") or (at.kind in ("NAME", "NOT") and "NAME" not in at.accepted)):
        return f"a colon stands behind the variables: `{typed[1]} {typed[2]}: ...`"
    if at.token == "=>" and re.search(r"\bforall\b[^{}]*:[^{}()]*\([^()]*\)\s*,", at.before):
        return (
            "several literals before `=>` stand in parentheses: `forall ?a - type: (p(?a), q(?a)) => r(?a)`"
        )
    return ""


def _list_of_pddl(at: Misplaced) -> str:
    if at.token == ":" and "LPAR" in at.accepted:
        return "what it takes stands in parentheses behind the name: `push(?a - area)`"
    if at.token == "(" and at.accepted == {"COLON"}:
        return "a rule has a name of its own: `rule NAME: push(?a) { ... }`"
    if at.token != "(" or "LPAR" in at.accepted:
        return ""
    if at.word_before in ("exists", "forall", "count"):
        return f"variables stand without parentheses: `{at.word_before} ?m - area: wet(?m)`"
    match = re.match(r"\s*(:?[\w-]+|[<>]?=|[<>])", at.after)
    word = match[1] if match else ""
    if word.startswith(":"):
        return "a block is a word and braces: `types { ... }`"
    if word in _LISTS:
        return _LISTS[word]
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
    # Behind a probability `not` denies an effect: what is missing is the colon.
    return "" if at.token == "not" and "COLON" in at.accepted else _WORDS.get(at.token, "")


def _setting(at: Misplaced) -> str:
    """Settings of a problem that other languages build otherwise."""
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
        return "a horizon is a number, a count or their sum: `horizon = 1 + dirty_areas`"
    return ""


def _sign(at: Misplaced) -> str:
    last = at.before[-1:]
    if at.token == "=" and last == "=" and at.is_glued:
        return "equality is one `=`"
    if f"{at.token}{at.after}".startswith("<>") or (at.token == ">" and last == "<" and at.is_glued):
        return "write `!=`"
    if at.accepted == {"EQUAL", "UNEQUAL"} and at.kind in ("LESS", "OPERATOR"):
        return (
            f"a variable stands for an object: compare a function of it, `f({at.word_before}) {at.token} ...`"
        )
    if at.kind == "NUMBER" and (term := re.search(r"(\?\w+)\s*!?=$", at.before)):
        return f"a variable stands for an object: compare a function of it, `f({term[1]}) = {at.token}`"
    if at.token == "-" and at.after.startswith(">"):
        return "write `=>`" if "IMPLIES" in at.accepted else "`=>` stands within `forall` only"
    if at.token == "=" and "ASSIGN" in at.accepted <= {"ASSIGN", "LPAR"}:
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
    if at.token == ":" and at.word_before in ("when", "then", "with", "rest") and "COLON" not in at.accepted:
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
    _function_or_count,
    _habit_word,
    _setting,
    _braces,
    _negation_of_group,
    _two_functions,
    _value_first,
    _step,
    _unclosed,
    _quantifier,
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
