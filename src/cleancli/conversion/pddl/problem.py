"""What a problem asks for, and where it starts from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import repeat

from cleancli.conversion.pddl.define import Definitions
from cleancli.conversion.pddl.formula import ALWAYS, NEVER, Formula
from cleancli.conversion.pddl.naming import Naming
from cleancli.conversion.pddl.read_conditions import Reader
from cleancli.conversion.pddl.resolve import Scope, Words
from cleancli.conversion.pddl.syntax import (
    AtomNode,
    DomainNode,
    FactsNode,
    Name,
    PayNode,
    ProblemNode,
    SetNode,
    all_within,
)
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import Condition, Fact, Object, RewardKind, RewardTerm

_GOAL_WORDS = frozenset({"total-time", "goal-probability", "goal-achieved"})
"""What a metric may name that is no function: the goal, and how many actions it takes, count anyway."""


_USUAL_FUNCTIONS = ("total-cost", "reward")
"""What nobody has to declare."""


@dataclass(frozen=True, slots=True)
class Metric:
    """What counts in all problems: the numeric functions that are to be small (1) or great (-1), what
    reaching the goal pays, and whether that and the functions are to be earned within a horizon. Otherwise
    the goal is to be reached, however long it takes."""

    counted: Mapping[str, int]
    goal_reward: Fraction
    earned: bool

    def reward(self, costs: bool, goals: bool) -> tuple[RewardTerm, ...]:
        """The reward of the .nid domain; `costs` and `goals` tell whether there are any."""
        paid = [RewardTerm(self.goal_reward, RewardKind.GOAL)] if goals and self.goal_reward else []
        price = RewardTerm(Fraction(-1), RewardKind.COST)
        return (*paid, *([price] if costs or not paid else []))


def metric_of(domain: DomainNode, problems: Sequence[ProblemNode], findings: Findings) -> Metric:
    """The metric that all problems have; E917 where they have different ones."""
    found = [_metric(problem, domain, findings) for problem in problems] or [_usual(domain)]
    for problem, metric in zip(problems[1:], found[1:], strict=False):
        if metric != found[0]:
            message = f"`{problem.name.text}` wants something else than `{problems[0].name.text}`"
            findings.error("E917", message, problem.name.span, help="convert one problem at a time")
    return found[0]


def _usual(domain: DomainNode) -> Metric:
    """Without a problem: rewards count where there are some, otherwise costs."""
    names = {function.name.text for function in domain.functions}
    if "reward" in names or _rewards(domain):
        return Metric({"reward": -1}, Fraction(1), True)
    return Metric({"total-cost": 1}, Fraction(1), False)


def _rewards(domain: DomainNode) -> bool:
    """Whether actions change the reward, which is to be great where no metric says what is (Younes et al.
    2005, JAIR 24, "Plan Objectives")."""
    return any(
        isinstance(each, PayNode) and each.function.symbol.text == "reward"
        for action in domain.actions
        for each in all_within(action.effect)
    )


def _metric(problem: ProblemNode, domain: DomainNode, findings: Findings) -> Metric:
    node, paid = problem.metric, problem.goal_reward
    counted: dict[str, int] = {}
    if node is None:
        counted = {} if paid is None and not _rewards(domain) else {"reward": -1}
    elif node.function is None:
        findings.error("E917", "a metric is one function here", node.span)
    elif node.function.text not in _GOAL_WORDS:
        _look_at(node.function, [each.name.text for each in domain.functions], findings)
        counted[node.function.text] = -1 if node.greatest else 1
    earned = bool(counted) and (-1 in counted.values() or problem.goal is None)
    usual = Fraction(0) if earned else Fraction(1)
    return Metric(counted, usual if paid is None else paid, earned or problem.goal is None)


def _look_at(function: Name, declared: Sequence[str], findings: Findings) -> None:
    """E916 for a function of a metric that is nearly another's, W911 for one that is not declared."""
    if function.text in (*declared, *_USUAL_FUNCTIONS):
        return
    help = findings.meant(function.text, [*declared, *_USUAL_FUNCTIONS], "function")
    if help.startswith("did you mean"):
        findings.error("E916", f"unknown function `{function.text}`", function.span, help=help)
    else:
        message = f"the function `{function.text}` is not declared"
        findings.warning("W911", message, function.span, "taken as one")


@dataclass(frozen=True, slots=True)
class Start:
    """A problem: its name, its objects, the facts that hold at first, and its goal, which asks for a formula
    (one that always holds where there is none)."""

    node: ProblemNode
    objects: tuple[Object, ...]
    facts: frozenset[Fact]
    asked: Formula
    goal: Condition


def starts_of(problems: Sequence[ProblemNode], words: Words, definitions: Definitions) -> tuple[Start, ...]:
    """The problems; E916 and E917 for what can't be said."""
    found = []
    for problem, objects in zip(problems, words.objects, strict=True):
        facts, asked = _facts(problem, words, objects), _asked(problem, words, objects)
        goal = () if asked == ALWAYS else definitions.condition(asked)
        found.append(Start(problem, tuple(objects.values()), facts, asked, goal))
    return tuple(found)


def _asked(problem: ProblemNode, words: Words, objects: Mapping[str, Object]) -> Formula:
    if problem.goal is None:
        return ALWAYS
    goal = words.formula(problem.goal, Scope(objects))
    if goal == NEVER:
        words.findings.error("E917", "this goal can never hold", problem.goal.span)
        return ALWAYS
    return goal


def _facts(problem: ProblemNode, words: Words, objects: Mapping[str, Object]) -> frozenset[Fact]:
    """The facts that hold at first. Where all are declared and fit, they are taken as they are; otherwise it
    is looked up what is wrong with each, and where."""
    together = [node for node in problem.init if isinstance(node, FactsNode)]
    rows = [names for node in together for names in node.names]
    found = _Fitting(words, objects).facts(rows)
    atoms = [(node.atom, node.value) for node in problem.init if isinstance(node, SetNode)]
    if len(found) < len(rows):
        found, reader = set(), Reader(problem.span.path, words.findings)
        atoms += [(reader.atom(group), True) for node in together for group in node.groups]
    resolved = [(atom, holds, _resolved(atom, words, objects)) for atom, holds in atoms]
    for atom, holds, fact in resolved:
        if fact is None or not holds:
            continue
        if fact in found:
            message = f"`{atom.symbol.text}` holds twice of the same"
            words.findings.warning("W911", message, atom.span, "passed over")
        found.add(fact)
    for atom, holds, fact in resolved:
        if not holds and fact in found:
            message = f"`{atom.symbol.text}` holds, and does not hold, of the same"
            words.findings.warning("W911", message, atom.span, "taken to hold")
    return frozenset(found)


def _resolved(node: AtomNode, words: Words, objects: Mapping[str, Object]) -> Fact | None:
    """The fact that an atom is; None after a mistake. What another problem declares is no object of this."""
    atom = words.atom(node, Scope(objects))
    if atom is None:
        return None
    for name in node.terms:
        if name.text not in objects and name.text not in words.constants:
            known = (*words.constants, *objects)
            words.findings.unknown("E916", "object", name.text, name.span, known)
    return Fact(atom[0], tuple(term.name for term in atom[1]))


class _Fitting:
    """Which objects may stand where in the facts of a problem: their names in .nid files by those in PDDL."""

    def __init__(self, words: Words, objects: Mapping[str, Object]) -> None:
        self._words = words
        self._own: dict[str, dict[str, str]] = {}
        for name, thing in (*words.constants.items(), *objects.items()):
            self._own.setdefault(thing.type, {})[name] = thing.name
        self._of_type: dict[str, dict[str, str]] = {}

    def facts(self, rows: Sequence[tuple[str, ...]]) -> set[Fact]:
        """The facts that rows of names say; none of a predicate that is not declared, or of which some row
        does not fit."""
        grouped: dict[str, list[tuple[str, ...]]] = {}
        for row in rows:
            grouped.setdefault(row[0], []).append(row)
        return {fact for symbol, each in grouped.items() for fact in self._of(symbol, each)}

    def _of(self, symbol: str, rows: Sequence[tuple[str, ...]]) -> Iterator[Fact]:
        predicate = self._words.predicates.get(symbol)
        if predicate is None or set(map(len, rows)) != {1 + len(predicate.types)}:
            return iter(())
        if not predicate.types:
            return iter((Fact(predicate.name, ()),))
        _, *terms = zip(*rows, strict=True)
        columns = zip(map(self._fitting, predicate.types), terms, strict=True)
        try:
            named = [[titles[name] for name in names] for titles, names in columns]
        except KeyError:
            return iter(())
        return map(Fact, repeat(predicate.name), zip(*named, strict=True))

    def _fitting(self, kind: str) -> dict[str, str]:
        """The objects of a type, and of those below it."""
        if kind not in self._of_type:
            below = (own for name, own in self._own.items() if self._words.types.is_a(name, kind))
            self._of_type[kind] = {name: title for own in below for name, title in own.items()}
        return self._of_type[kind]


def names_of(problems: Sequence[ProblemNode], domain: str, naming: Naming) -> tuple[str, ...]:
    """What the problems are called; none is called as the domain is, since each has a file of its own."""
    naming.fresh(domain)
    return tuple(naming.fresh(naming.written(problem.name), "p") for problem in problems)
