"""libPRADA's three files to the texts of a domain and a problem, which the checker has looked at."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from cleancli.conversion.check import check, constants_of, misfits, rule_atoms
from cleancli.conversion.exclusive import groups_of
from cleancli.conversion.names import OBJECT, fresh, names_for
from cleancli.conversion.read import read, read_reward
from cleancli.conversion.records import Kind, Library
from cleancli.conversion.rules import Translated, default_of, rules_of
from cleancli.conversion.symbols import Vocabulary, facts, parameters, vocabulary
from cleancli.conversion.text import Remarks, domain_text, problem_text
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import checked_domain, checked_problem, load_domain
from cleancli.language.model import (
    Action,
    Condition,
    Count,
    Domain,
    Horizon,
    Literal,
    Object,
    Problem,
    RewardKind,
    RewardTerm,
    Type,
    Variable,
)
from cleancli.language.printing.printer import print_domain

DIRT = "dirt"
"""The predicate whose objects the reward wants fewer of, where there is one (eq. 2)."""

_LONGEST = 1000
"""The longest horizon that a problem may have."""


@dataclass(frozen=True, slots=True)
class Wishes:
    """What libPRADA's files leave open: the domain's name, the reward's text (None: a guess), the horizon
    (None: a guess) and the discount; and whether all `predicates` stay, though rules may overlap then."""

    name: str = "domain"
    reward: str | None = None
    horizon: int | None = None
    discount: float = 0.95
    predicates: bool = False


@dataclass(frozen=True, slots=True)
class Converted:
    """The texts, what has to be told about them, and what the checker says of them (`sources` has the texts).

    `functions` has the predicates that each new function stands for; `library` is what the files say, and
    `words` say it in the domain's, which has these `actions`.
    """

    domain: str
    problem: str
    functions: Mapping[str, tuple[str, ...]]
    notes: tuple[str, ...]
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]
    library: Library
    words: Vocabulary
    actions: tuple[str, ...]


def convert(
    rules: Source,
    state: Source,
    symbols: Source,
    wishes: Wishes,
    paths: tuple[str, str],
    reward: Source | None = None,
) -> Converted:
    """The texts of a domain and a problem; `paths` are what their mistakes go by. What a `reward` pays for is
    the goal.

    Raises Refused (E911 to E914) where the files, or the wishes, cannot be converted.
    """
    library = read(rules, state, symbols)
    check(library)
    groups = () if wishes.predicates else groups_of(library, constants_of(library))
    names = names_for(library, groups)
    words = vocabulary(library, names)
    translated = rules_of(library, words, whole=wishes.predicates)
    goal = () if reward is None else _goal(reward, library, words)
    domain = _with_reward(_domain(library, words, translated, wishes.name), wishes, goal)
    problem = replace(_problem(library, words, domain, wishes), goal=goal)
    functions = {function.name: function for function in names.functions.values()}
    members = {name: tuple(function.value_of) for name, function in functions.items()}
    notes = (*_left_out(library, words, translated), *_guessed(domain, problem, wishes))
    remarks = Remarks(rules, state, symbols, members, translated, notes)
    texts = domain_text(domain, remarks), problem_text(problem, domain, remarks)
    sources = (Source(paths[0], texts[0]), Source(paths[1], texts[1]))
    mistakes = _mistakes(*sources, wishes.predicates)
    actions = tuple(action.name for action in domain.actions)
    return Converted(*texts, members, notes, mistakes, sources, library, words, actions)


def _domain(library: Library, words: Vocabulary, translated: tuple[Translated, ...], name: str) -> Domain:
    rules = tuple(each.rule for each in translated if each.rule is not None)
    acting = {rule.action for rule in rules}
    actions = [
        Action(words.names.symbols[symbol.name], parameters(symbol.arity))
        for symbol in library.symbols
        if symbol.kind is Kind.ACTION and words.names.symbols[symbol.name] in acting
    ]
    heads = [rule.action for rule in library.rules]
    counted = [atom for symbol in library.symbols for atom in symbol.condition]
    mentioned = {term for atom in (*rule_atoms(library), *heads, *counted) for term in atom.terms}
    constants = [words.names.objects[c] for c in constants_of(library) if c in mentioned]
    return Domain(
        name,
        (Type(OBJECT),),
        tuple(Object(constant, OBJECT) for constant in constants),
        tuple(words.symbols.values()),
        _counts(library, words),
        tuple(actions),
        rules,
        default_of(library),
        (),
    )


def _counts(library: Library, words: Vocabulary) -> tuple[Count, ...]:
    """The declared counts, and one of what is dirty."""
    counts = []
    for symbol in library.symbols:
        taken = {name: Variable(name.lower(), OBJECT) for name in symbol.variables}
        condition = words.conjunction(symbol.condition, taken)
        if condition:
            counts.append(Count(words.names.symbols[symbol.name], tuple(taken.values()), condition))
    dirt = words.symbols.get(DIRT)
    if dirt is not None and dirt.is_predicate and dirt.parameters:
        name = fresh("dirty", (*words.symbols, *(count.name for count in counts)))
        asked = Literal(DIRT, dirt.parameters, frozenset({True}))
        counts.append(Count(name, dirt.parameters, (asked,)))
    return tuple(counts)


def _goal(source: Source, library: Library, words: Vocabulary) -> tuple[Literal, ...]:
    """What has to hold for a reward. Raises Refused (E911 to E913)."""
    atoms = read_reward(source)
    wrong = list(misfits([atoms], library))
    for atom in atoms:
        unknown = [term for term in atom.terms if term not in words.names.objects]
        if not wrong and unknown:
            message = f"neither rules nor state have an object `{unknown[0]}`"
            wrong.append(Diagnostic("E912", message, atom.span))
        elif not wrong and not words.has(atom):
            message = f"no rule mentions `{atom.symbol}`: it is as it is"
            wrong.append(Diagnostic("E913", message, atom.span))
    goal = None if wrong else words.conjunction(atoms, {})
    if goal is None and not wrong:
        wrong.append(Diagnostic("E913", "these literals never hold together", atoms[0].span))
    if goal is None:
        raise Refused(wrong, [source])
    return goal


def _with_reward(domain: Domain, wishes: Wishes, goal: Condition) -> Domain:
    """The domain with the wished reward, or one for the goal, or else with eq. 2's for dirt, or else more of
    the first count."""
    if wishes.reward is not None:
        return replace(domain, reward=_read_reward(wishes.reward, domain))
    if goal:
        return replace(domain, reward=(RewardTerm(Fraction(1), RewardKind.GOAL),))
    if not domain.counts:
        raise Refused(
            [
                Diagnostic(
                    "E913",
                    f"the files have no reward, and none can be guessed: there is no `{DIRT}` and no count",
                    None,
                    help="say one, like `--reward cost`",
                )
            ]
        )
    first, last = domain.counts[0], domain.counts[-1]
    falls = any(isinstance(part, Literal) and part.symbol == DIRT for part in last.condition)
    term = RewardTerm(Fraction(1), RewardKind.DECREASE, last.name)
    return replace(domain, reward=(term if falls else RewardTerm(-term.weight, term.kind, first.name),))


def _read_reward(text: str, domain: Domain) -> tuple[RewardTerm, ...]:
    """The reward that a text means beside the domain's counts; raises Refused with its mistakes."""
    price = RewardTerm(Fraction(1), RewardKind.COST)
    without = print_domain(replace(domain, rules=(), reward=(price,)))
    place = without.rindex("    cost\n")
    return load_domain(Source("--reward", f"{without[:place]}    {text}\n  }}\n}}\n")).reward


def _problem(library: Library, words: Vocabulary, domain: Domain, wishes: Wishes) -> Problem:
    constants = {constant.name for constant in domain.constants}
    objects = [words.names.objects[constant] for constant in constants_of(library)]
    return Problem(
        "converted",
        domain.name,
        tuple(Object(name, OBJECT) for name in objects if name not in constants),
        facts(library, words, objects),
        _horizon(domain, len(objects), wishes),
        wishes.discount,
    )


def _horizon(domain: Domain, objects: int, wishes: Wishes) -> Horizon:
    """One step more than there is to decrease (§4.2.2), or than there are objects where that is not known."""
    if wishes.horizon is not None:
        return Horizon(wishes.horizon)
    for term in domain.reward:
        if term.kind is RewardKind.DECREASE and term.weight > 0:
            return Horizon(1, term.count)
    return Horizon(min(1 + objects, _LONGEST))


def _left_out(library: Library, words: Vocabulary, translated: tuple[Translated, ...]) -> tuple[str, ...]:
    """What has not been converted, and why."""
    acting = {rule.action.symbol for rule in library.rules}
    lines = [str(each.line) for each in translated if each.rule is None]
    idle = [name for name in _declared(library, Kind.ACTION) if name not in acting]
    single = [name for name in _declared(library, Kind.PRIMITIVE) if name not in words.names.functions]
    unused = [name for name in single if words.names.symbols[name] not in words.symbols]
    parts = (
        ("actions without a rule", idle),
        ("symbols that no rule mentions", unused),
        ("symbols that follow from others", _declared(library, Kind.OTHER)),
        ("rules whose context can never hold, at line", lines),
    )
    return tuple(f"left out: {what}: {', '.join(names)}" for what, names in parts if names)


def _declared(library: Library, kind: Kind) -> list[str]:
    return [symbol.name for symbol in library.symbols if symbol.kind is kind]


def _guessed(domain: Domain, problem: Problem, wishes: Wishes) -> tuple[str, ...]:
    """Which of what the files leave open was guessed, and what the answer is good for."""
    guesses = ["rules may overlap: plan with `--compat libprada`"] if wishes.predicates else []
    if problem.goal:
        guesses.append("the goal is paid for once: libPRADA pays in each state in which it holds")
    elif wishes.reward is None:
        (term,) = domain.reward
        direction = "fewer" if term.weight > 0 else "more"
        guesses.append(f"the reward is a guess: {direction} of the count `{term.count}`")
    if wishes.horizon is None and isinstance(problem.horizon, Horizon) and problem.horizon.count is None:
        guesses.append("the horizon is a guess: 1 and the number of objects")
    return tuple(guesses)


def _mistakes(domain: Source, problem: Source, compat: bool) -> tuple[Diagnostic, ...]:
    """What the checker finds in the texts, perhaps but for rules that overlap."""
    checked = checked_domain(domain, compat=compat)
    if checked.model is None:
        return checked.diagnostics
    return (*checked.diagnostics, *checked_problem(problem, checked.model).diagnostics)
