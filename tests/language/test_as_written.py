"""Conditions are quoted as their author wrote them, wherever the program tells them (docs/language.md)."""

from __future__ import annotations

import pytest

import cleancli
from cleancli.compiler.unreached import unreached
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Domain, Literal
from cleancli.language.printing.printer import print_condition, print_domain, print_literal, symbols_of

TANKS = """domain tanks {{
  types      {{ pump }}
  predicates {{ full(?p - pump)  beside(?p ?q - pump) [symmetric] }}
  functions  {{ fuel(): 0..5  level(?p - pump): low < mid < high }}
  derived    {{ fulls := count ?p - pump: full(?p)  ready(?p - pump) := {condition} }}
  actions    {{ fill(?p - pump) }}
  rule fill_it: fill(?p) {{
    when not full(?p), {condition}
    then 1: full(?p)
  }}
  reward {{ fulls }}
}}
"""

COMPARISONS = [
    *(f"fuel() {sign} {value}" for sign in ("=", "!=") for value in (0, 1, 5)),
    *(f"fuel() {sign} {value}" for sign in ("<", ">=") for value in (1, 2, 5)),
    *(f"fuel() {sign} {value}" for sign in ("<=", ">") for value in (0, 1, 4)),
    *(f"level(?p) {comparison}" for comparison in ("< mid", "<= mid", "> mid", ">= mid", "!= low")),
]

CONDITIONS = [
    *COMPARISONS,
    "(fuel() >= 1 or level(?p) < high)",
    "exists ?q - pump: (beside(?p, ?q), level(?q) > low)",
    "not exists ?q - pump: level(?q) != low",
    "forall ?q - pump: level(?q) > low",
    "forall ?q - pump: not beside(?q, ?p)",
    "forall ?q - pump: beside(?p, ?q) => level(?q) > low",
    "forall ?q - pump: (beside(?p, ?q), fuel() >= 1) => ?q != ?p",
]


def _tanks(condition: str) -> Domain:
    return load_domain(Source("tanks", TANKS.format(condition=condition)))


@pytest.mark.parametrize("condition", CONDITIONS)
def test_a_condition_is_printed_as_it_was_written(condition: str) -> None:
    domain = _tanks(condition)
    assert print_condition(domain.rules[0].condition[1:], symbols_of(domain)) == condition
    text = print_domain(domain)
    again = load_domain(Source("printed", text))
    assert again == domain
    assert print_domain(again) == text


@pytest.mark.parametrize("condition", COMPARISONS)
def test_the_opposite_of_a_comparison_has_the_opposite_sign(condition: str) -> None:
    domain = _tanks(condition)
    symbols, literal = symbols_of(domain), domain.rules[0].condition[1]
    assert isinstance(literal, Literal)
    symbol = symbols[literal.symbol]
    opposite = literal.opposite(symbol)
    assert opposite.values == set(symbol.values) - literal.values
    signs = {"=": "!=", "!=": "=", "<": ">=", ">=": "<", "<=": ">", ">": "<="}
    applied, sign, value = condition.rsplit(" ", 2)
    assert print_literal(opposite, symbols) == f"{applied} {signs[sign]} {value}"
    assert opposite.opposite(symbol) == literal


def test_how_a_comparison_was_written_makes_no_other_condition() -> None:
    assert _tanks("fuel() >= 1") == _tanks("fuel() != 0") == _tanks("fuel() > 0")


@pytest.mark.parametrize("condition", ["fuel() >= 1", "fuel() > 0", "forall ?q - pump: level(?q) > low"])
def test_explain_and_show_quote_what_was_written(condition: str) -> None:
    problem = (
        "problem p { domain = tanks  objects { a - pump }  init { fuel() = 0  level(a) = low } horizon = 2 }"
    )
    text = TANKS.format(condition=condition)
    explained = cleancli.explain(text, problem, "fill(a)")
    assert [each.literal for each in explained.other_rules[0].failing] == [condition]
    assert f"  {condition}  fails: " in str(explained)


def test_a_goal_that_cannot_hold_is_quoted_as_it_was_written() -> None:
    domain = _tanks("fuel() >= 1")
    text = (
        "problem p { domain = tanks  objects { a - pump }  init { fuel() = 0  level(a) = low }"
        "  goal { fuel() >= 1 } horizon = 2 }"
    )
    problem = load_problem(Source("p", text), domain)
    assert [each.never for each in unreached(domain, problem)] == [("fuel() >= 1",)]
