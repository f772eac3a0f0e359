"""The check that the rules of one action exclude each other, and that each can apply at all (§3.3.2).

Guaranteed before: rules are well formed. Pairs whose literals differ on one fact are never looked at; of the
others, literals decide first (`overlap`), and quantifiers, references and derived predicates where they have
to (`satisfiable`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import combinations

from cleancli.language.checking.conditions import Scope
from cleancli.language.checking.declarations import Declarations
from cleancli.language.checking.first_order import Reading
from cleancli.language.checking.literals import (
    Witness,
    can_hold,
    negated,
    renamed,
    separating,
    with_terms,
    witness,
)
from cleancli.language.checking.satisfiability import TooHard, satisfy
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.model import Literal, Quantified, Rule, Term, Value, Variable
from cleancli.language.printing.printer import print_condition, print_literal, print_term

_Fact = tuple[str, tuple[int | str, ...]]
_Asked = Mapping[_Fact, frozenset[Value]]

_FEW = 8
"""Rules that are compared each with each, without dividing them further."""
_MOST_REPORTED = 50
_MOST_SHOWN = 6


def refuse_unsatisfiable(rule: Rule, place: Span, scope: Scope) -> None:
    """E305 for a rule that no state of no problem lets apply."""
    if not can_apply(rule, scope.declared):
        scope.findings.error(
            "E305", f"the rule `{rule.name}` can never apply", place, "these literals contradict each other"
        )


def can_apply(rule: Rule, declared: Declarations) -> bool:
    """Whether a state of some problem may let a rule apply; true where that is too hard to find out."""
    possible = can_hold([rule.condition], declared)
    if not possible or _is_plain(rule, declared):
        return possible
    reading = Reading(declared, rule.variables)
    try:
        return satisfy(reading.rule(rule), reading, declared) is not None
    except TooHard:
        return True


def refuse_overlaps(rules: Iterable[Rule], scope: Scope) -> None:
    """E307 for two rules of one action that one state lets apply; W307 where that is not sure."""
    by_action: dict[str, list[Rule]] = {}
    for rule in rules:
        by_action.setdefault(rule.action, []).append(rule)
    reported = 0
    for group in by_action.values():
        if len(group) == 1:
            continue
        asked = [_asked(rule, scope.declared) for rule in group]
        for one, other in sorted(close_pairs(asked)):
            if reported < _MOST_REPORTED:
                reported += _refuse_overlap(group[one], group[other], scope)


def _is_plain(rule: Rule, declared: Declarations) -> bool:
    return not rule.references and not any(
        isinstance(part, Quantified) or (isinstance(part, Literal) and part.symbol in declared.derived)
        for part in rule.condition
    )


# ---- which pairs are worth a look


def _asked(rule: Rule, declared: Declarations) -> _Asked:
    """The values that the rule's literals want of facts, whose terms are positions of the action."""
    positions = {variable: number for number, variable in enumerate(rule.variables)}
    asked: dict[_Fact, frozenset[Value]] = {}
    for literal in (part for part in rule.condition if isinstance(part, Literal)):
        named = [positions[t] if isinstance(t, Variable) else t.name for t in literal.terms]
        symmetric = declared.symbols[literal.symbol].symmetric
        fact = literal.symbol, tuple(sorted(named, key=str) if symmetric else named)
        asked[fact] = asked.get(fact, literal.values) & literal.values
    return asked


def close_pairs(asked: Sequence[_Asked]) -> set[tuple[int, int]]:
    """The pairs (lower index first) that no single fact keeps apart, and perhaps others.

    Rules are divided by the fact that most of them ask for, again and again, as long as this separates them.
    """
    pairs: set[tuple[int, int]] = set()
    groups: list[tuple[tuple[int, ...], frozenset[_Fact]]] = [(tuple(range(len(asked))), frozenset())]
    while groups:
        group, used = groups.pop()
        fact = None if len(group) <= _FEW else _dividing(group, asked, used)
        if fact is None:
            pairs.update(combinations(group, 2))
        else:
            groups += [(part, used | {fact}) for part in _parts(group, asked, fact)]
    return pairs


def _dividing(group: tuple[int, ...], asked: Sequence[_Asked], used: frozenset[_Fact]) -> _Fact | None:
    counts = Counter(fact for rule in group for fact in asked[rule] if fact not in used)
    for fact, _ in counts.most_common(4):
        if sum(len(part) ** 2 for part in _parts(group, asked, fact)) < len(group) ** 2:
            return fact
    return None


def _parts(group: tuple[int, ...], asked: Sequence[_Asked], fact: _Fact) -> Iterator[tuple[int, ...]]:
    """The rules that each value of the fact lets apply; a rule that does not ask for it is in every part."""
    values = dict.fromkeys(v for rule in group for v in sorted(asked[rule].get(fact, ()), key=str))
    for value in values:
        yield tuple(rule for rule in group if fact not in asked[rule] or value in asked[rule][fact])


# ---- one pair


def _refuse_overlap(one: Rule, other: Rule, scope: Scope) -> bool:
    """Report the pair if it overlaps."""
    declared = scope.declared
    state = witness([one.condition, renamed(other, one.variables)], declared)
    if state is None:
        return False
    sure = True
    plain = _is_plain(one, declared) and _is_plain(other, declared)
    if not plain:
        reading = Reading(declared, one.variables)
        try:
            state = satisfy((*reading.rule(one), *reading.rule(other)), reading, declared)
        except TooHard:
            sure = False
        sure = sure and reading.exact
    if state is not None:
        mend = _mend(one, other, scope) or _mend_guards(one, other, scope)
        if plain and not mend:
            mend = "their conditions are the same: make them one rule"
        _report(one, other, state, sure, mend, scope)
    return state is not None


def _report(one: Rule, other: Rule, state: Witness, sure: bool, mend: str, scope: Scope) -> None:
    assert one.span is not None
    assert other.span is not None
    pair = f"the rules `{one.name}` ({scope.findings.line(one.span)}) and `{other.name}` of `{one.action}`"
    holds = _shown(state, one.variables, scope)
    label = f"both apply where {holds}" if holds else "both always apply"
    if sure:
        help = mend or "let one of them ask for the opposite of something that the other asks for"
        scope.findings.error("E307", f"{pair} overlap", other.span, label, help)
    else:
        scope.findings.warning(
            "W307",
            f"{pair} may overlap",
            other.span,
            label,
            "closures and deep definitions are not followed here: the problem's objects will decide",
        )


def _shown(state: Witness, named: tuple[Variable, ...], scope: Scope) -> str:
    """The state as literals; of what is the same, only the rule's own variables are told."""
    symbols = scope.declared.symbols
    parts = [f"{print_term(a)} = {print_term(b)}" for a, b in state.equal if a in named]
    for literal in state.allowed:
        values = [v for v in symbols[literal.symbol].values if v in literal.values]
        parts.append(print_literal(Literal(literal.symbol, literal.terms, frozenset(values[-1:])), symbols))
    more = [] if len(parts) <= _MOST_SHOWN else ["..."]
    return ", ".join([*parts[:_MOST_SHOWN], *more])


def _mend(one: Rule, other: Rule, scope: Scope) -> str:
    """The missing pair: a literal that one rule has, and its opposite for the other."""
    declared = scope.declared
    for first, second in ((one, other), (other, one)):
        part = separating(renamed(first, second.variables), second.condition, declared)
        if part is not None:
            opposite = print_literal(negated(part, declared), declared.symbols)
            return f"add `{opposite}` to `{second.name}`, since `{first.name}` asks for the opposite"
    return ""


def _mend_guards(one: Rule, other: Rule, scope: Scope) -> str:
    """The missing pair where no literal makes one: a quantified part that one rule has, and its opposite for
    the other."""
    for first, second in ((one, other), (other, one)):
        names: dict[Term, Term] = dict(zip(first.variables, second.variables, strict=True))
        for part in first.condition:
            if not isinstance(part, Quantified) or set(part.variables) & set(names.values()):
                continue
            inner = tuple(with_terms(each, names) for each in part.condition)
            opposite = Quantified(not part.exists, part.variables, inner)
            if Quantified(part.exists, part.variables, inner) not in second.condition:
                text = print_condition((opposite,), scope.declared.symbols)
                return f"add `{text}` to `{second.name}`, since `{first.name}` asks for the opposite"
    return ""
