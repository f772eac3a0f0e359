"""A converted PPDDL problem compared with what the file means: in every reachable state, every action."""

from __future__ import annotations

from collections.abc import Iterator, Set
from fractions import Fraction

from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import covering_rule, reaches_goal, successors
from cleancli.compiler.task import GroundState, Task
from cleancli.conversion.pddl.convert import Converted, Wishes, convert
from cleancli.conversion.pddl.read import read
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.load import load_domain, load_problem
from support.pddl_meaning import Called, Meaning, World

MOST_STATES = 300


def converted(text: str, path: str = "given.pddl") -> Converted:
    """The conversion of a text that holds a domain and a problem."""
    return convert([Source(path, text)], Wishes())


def task_of(made: Converted) -> Task:
    """The grounded task of a conversion with one problem."""
    domain = load_domain(Source("domain.nid", made.domain))
    (problem,) = made.problems.values()
    return ground(domain, load_problem(Source("problem.nid", problem), domain))


def meaning_of(text: str) -> Meaning:
    """What a text means by definition."""
    source = Source("given.pddl", text)
    domains, problems = read(source, Findings(source))
    return Meaning(domains[0], problems[0])


def disagreements(text: str, made: Converted, most: int = MOST_STATES) -> list[str]:
    """Where the task of a conversion is not what a text means, in so many states; empty where they agree.

    The goal ends what is earned (Younes et al. 2005, JAIR 24, "Plan Objectives"): there nothing is done any
    more, or nothing is earned by what is done."""
    meaning = meaning_of(text)
    task, asked = task_of(made), "goal" in "".join(made.problems.values())
    ways = _ways(task, {_key(each.name.text, ())[0] for each in meaning.domain.actions})
    found = []
    known = {(v.symbol.lower(), *v.objects) for v in task.variables}
    for world in meaning.reachable(most):
        here = state_of(task, world)
        wanted = meaning.problem.goal is not None and meaning.holds(meaning.problem.goal, world, {})
        if (reaches_goal(task, here) if asked else meaning.problem.goal is not None) != wanted:
            found.append(f"the goal holds ({wanted}) in {sorted(world)}")
        for called, action, binding in meaning.actions():
            after = meaning.successors(world, action, binding)
            if len(set().union(*after, world) - frozenset.intersection(world, *after)) and any(
                _renamed(atom) not in known for w in after for atom in w ^ world
            ):
                found.append(f"{called} changes what is no variable")
            expected: dict[GroundState, float] = {}
            for each, chance in after.items():
                state = state_of(task, each)
                expected[state] = expected.get(state, 0.0) + float(chance)
            covering = [n for n in ways.get(_key(*called), ()) if covering_rule(task, here, n) is not None]
            if wanted and meaning.earns and not covering:
                continue
            if len(covering) > 1:
                found.append(f"{called} is several actions in {sorted(world)}")
            actual = {here: 1.0}
            for number in covering:
                actual = {s: p for p, s in successors(task, here, number)}
                results = meaning.results(world, action, binding)
                paid: _Paid = {}
                for (after_it, cost), p in results.items():
                    key = state_of(task, after_it), cost
                    paid[key] = paid.get(key, Fraction(0)) + p
                found += _otherwise_paid(task, here, number, paid)
                if wanted and meaning.earns and any(cost < 0 for _, cost in paid):
                    found.append(f"{called} earns something after the goal in {sorted(world)}")
            states = expected.keys() | actual.keys()
            if any(abs(expected.get(s, 0.0) - actual.get(s, 0.0)) > 1e-12 for s in states):
                found.append(f"{called} in {sorted(world)}: {expected} and not {actual}")
    return found


_Paid = dict[tuple[GroundState, Fraction], Fraction]
"""How likely each state is to follow, with what is paid for it."""


def _otherwise_paid(task: Task, here: GroundState, number: int, wanted: _Paid) -> Iterator[str]:
    """Where a result of an action costs something else than what it should."""
    rule, action = covering_rule(task, here, number), task.actions[number]
    assert rule is not None
    paid: _Paid = {}
    for outcome in rule.outcomes:
        effects = dict(outcome.effects)
        after = tuple(effects.get(place, value) for place, value in enumerate(here))
        key = after, action.declared_cost + outcome.cost
        paid[key] = paid.get(key, Fraction(0)) + outcome.probability
    if paid != wanted:
        yield f"{action} in {here} costs {paid} and not {wanted}"


def _ways(task: Task, names: Set[str]) -> dict[Called, list[int]]:
    """The actions that each action of PDDL has become, by its name: one, or several that begin with it."""
    found: dict[Called, list[int]] = {}
    for number, action in enumerate(task.actions):
        name, objects = _key(action.name, action.objects)
        of = max((each for each in names if f"{name}_".startswith(f"{each}_")), key=len, default=name)
        found.setdefault((of, objects), []).append(number)
    return found


def _key(name: str, objects: tuple[str, ...]) -> Called:
    return name.replace("-", "_").lower(), tuple(each.replace("-", "_").lower() for each in objects)


def _renamed(atom: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(word.replace("-", "_") for word in atom)


def state_of(task: Task, world: World) -> GroundState:
    """The state of the task that is a world."""
    atoms = {_renamed(atom) for atom in world}
    return tuple(
        int((v.symbol.lower(), *(each.lower() for each in v.objects)) in atoms) for v in task.variables
    )
