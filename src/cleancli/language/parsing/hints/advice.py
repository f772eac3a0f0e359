"""What someone meant who writes PDDL, PPDDL, RDDL or Python into a .nid file: advice for a misplaced token.

Guaranteed by the parser: the token cannot stand where it does. Advice is given only where the text around it
shows the habit; an empty string says nothing.
"""

from __future__ import annotations

from collections.abc import Callable

from cleancli.language.parsing.hints.conditions import (
    compared_variable,
    denied_equality,
    group,
    one_of,
    quantifier,
    step,
    two_functions,
    value_first,
)
from cleancli.language.parsing.hints.misplaced import Misplaced
from cleancli.language.parsing.hints.missing import missing, near_keyword, unclosed
from cleancli.language.parsing.hints.pddl import habit_word, list_of_pddl, term_of_list
from cleancli.language.parsing.hints.sections import (
    declaration,
    function_or_count,
    header,
    noted,
    part_of_rule,
    setting,
)
from cleancli.language.parsing.hints.signs import braces, name_or_number, relation, separator, sign


def for_token(at: Misplaced) -> str:
    """The first advice that fits."""
    for advice in _ADVICE:
        found = advice(at)
        if found:
            return found
    return ""


_ADVICE: tuple[Callable[[Misplaced], str], ...] = (
    name_or_number,
    function_or_count,
    habit_word,
    setting,
    noted,
    braces,
    denied_equality,
    group,
    one_of,
    two_functions,
    value_first,
    step,
    unclosed,
    quantifier,
    header,
    list_of_pddl,
    relation,
    compared_variable,
    sign,
    separator,
    term_of_list,
    part_of_rule,
    declaration,
    near_keyword,
    missing,
)
"""The nearer to what is certain, the earlier."""
