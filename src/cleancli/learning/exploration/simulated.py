"""Who gathers experience in the symbolic world: the explorer, each of whose episodes goes on with what those
before have shown, and who acts at random."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from cleancli.compiler.fluents import values_of
from cleancli.compiler.semantics import covering_rule, sample
from cleancli.compiler.task import GroundAction, GroundState
from cleancli.language.model import Domain, Problem, State
from cleancli.learning.experience import Transition
from cleancli.learning.exploration.explored import explored
from cleancli.learning.exploration.seeking import next_try
from cleancli.learning.exploration.worth import arguments_of
from cleancli.learning.method import Method
from cleancli.learning.variation import variation
from cleancli.planning.plan import Options, Plan
from cleancli.planning.planner import Plans
from cleancli.simulation.agent import Agent
from cleancli.simulation.batch import Batch, Round
from cleancli.simulation.episode import episode
from cleancli.simulation.symbolic_world import World, assignment_of, world_of

EXPLORE, RANDOM = "explore", "random"
"""The names of the strategies."""
PAIRS, STEPS, COVERED = 300, 12, 0.75
"""By how many pairs of a state and an action learned rules are judged; the actions of a walk through such
states; and how likely one at least is on objects that a rule covers. Chosen."""


class Explorer:
    """Does what the strategy `explore` does, by the rules that all teaches that it saw."""

    def __init__(self, setup: Batch, planner: Plans, known: int, method: Method) -> None:
        self.found = explored(setup.domain, (), None, method)
        self._setup, self._planner, self._known, self._method = setup, planner, known, method
        self._seen: list[Transition] = []

    def saw(self, before: State, action: GroundAction, after: State) -> None:
        """Learn from what an action has done."""
        states = values_of(before), values_of(after)
        self._seen.append(Transition(action.name, action.objects, self._setup.problem.objects, *states))
        self.found = explored(self._setup.domain, self._seen, self.found, self._method)

    def plan(self, facts: State, options: Options, horizon: int | None = None) -> tuple[Plan, float]:
        """The next try; where all is known that can be reached, what the planner says. Raises as `Agent`."""
        started = time.perf_counter()
        problem = replace(self._setup.problem, state=facts)
        asked = replace(options, previous=())
        chosen = next_try(self.found, problem, self._known, self._planner, asked)
        if chosen is None:
            agent = Agent(self._planner, self.found.domain, problem, self._setup.objective)
            plan, _ = agent.plan(facts, options, horizon)
        else:
            action = GroundAction(chosen.action, chosen.objects, None)
            plan = Plan(EXPLORE, (action,), chosen.worth, "hoped", 0, None, None, {})
        return plan, time.perf_counter() - started


class Judged(NamedTuple):
    """The same numbered episode by each planner, and how far what each then foretells is from what is true,
    as the total variation in the mean of `pairs`; empty where no rules are learned."""

    played: Round
    variations: tuple[float, ...]


def explorations(setup: Batch, known: int, method: Method, episodes: int) -> Iterator[Judged]:
    """So many episodes, of explorers that begin with the rules of the setup's domain, learn the probabilities
    of those that stay by a `method`, and know a rule when it has `known` examples. Raises as `rounds` of
    simulation/batch.py does."""
    world = world_of(setup.world, setup.problem, setup.timed)
    judged = pairs(world, setup.world, setup.problem, np.random.default_rng(setup.options.seed))
    explorers = [Explorer(setup, planner, known, method) for planner in setup.planners]
    for number in range(episodes):
        played = [episode(world, each, number, setup.options, setup.limits, each.saw) for each in explorers]
        off = (variation(each.found.domain, setup.world, judged) for each in explorers)
        yield Judged(tuple(played), tuple(off))


def pairs(world: World, domain: Domain, problem: Problem, rng: np.random.Generator) -> Sequence[Transition]:
    """Pairs of a state and an action, as transitions in which nothing happens: states of walks from the
    problem's, in each an action that is drawn uniformly, on objects that a rule covers or any."""
    task, found = world.task, list[Transition]()
    while len(found) < PAIRS:
        state = task.initial
        for _ in range(STEPS):
            chosen = drawn(world, domain, problem, state, rng)
            if chosen is None:
                return found
            values = values_of(world.facts(state))
            found.append(Transition(*chosen, problem.objects, values, values))
            number = world.numbers.get(chosen)
            if number is not None:
                _, state = sample(task, state, number, rng)
    return found[:PAIRS]


def drawn(
    world: World, domain: Domain, problem: Problem, state: GroundState, rng: np.random.Generator
) -> tuple[str, tuple[str, ...]] | None:
    """An action, each as likely as any other, and its objects: of those that a rule covers, with the
    probability COVERED if there are such, and else of all. None where there are no objects for any action."""
    actions = [each for each in domain.actions if arguments_of(domain, each, problem.objects, rng)]
    if not actions:
        return None
    action = actions[int(rng.integers(len(actions)))]
    own = ((key[1], number) for key, number in world.numbers.items() if key[0] == action.name)
    arguments = [objects for objects, number in own if covering_rule(world.task, state, number)]
    if not arguments or rng.random() >= COVERED:
        arguments = arguments_of(domain, action, problem.objects, rng)
    return action.name, arguments[int(rng.integers(len(arguments)))]


class Wanderer:
    """Does what chance says, by the seed of each plan, whatever comes of it."""

    def __init__(self, setup: Batch, world: World) -> None:
        self._setup, self._world = setup, world

    def plan(self, facts: State, options: Options, horizon: int | None = None) -> tuple[Plan, float]:
        """The next action; nothing where there are no objects for any action."""
        state, rng = assignment_of(self._world.task, facts), np.random.default_rng(options.seed)
        assert state is not None, "the facts are the world's"
        chosen = drawn(self._world, self._setup.world, self._setup.problem, state, rng)
        actions = () if chosen is None else (GroundAction(*chosen, None),)
        return Plan(RANDOM, actions, 0.0, "sampled", 0, None, None, {}), 0.0


def wanderings(setup: Batch, episodes: int) -> Iterator[Judged]:
    """So many episodes of random actions. Raises Refused."""
    world = world_of(setup.world, setup.problem, setup.timed)
    wanderer = Wanderer(setup, world)
    for number in range(episodes):
        yield Judged((episode(world, wanderer, number, setup.options, setup.limits),), ())
