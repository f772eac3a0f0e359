"""Episodes of one problem in the symbolic world, many side by side, as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cleancli.array_types import Bools, Floats, Ints
from cleancli.compiler.ground import ground
from cleancli.compiler.lowering.state_tables import lower_process
from cleancli.compiler.task import GroundCondition, StateVariable, Task, asked, held
from cleancli.language.find import find, find_beside
from cleancli.language.load import domain_named, load_domain, load_problem, read_source
from cleancli.planning.kernels.batch import any_holds_each, begin, covered_each, step_each

Masks = NDArray[np.int8]


@dataclass(frozen=True, slots=True)
class Opened:
    """A grounded problem. `ends`: the conditions of which one holds where an episode is over or, where
    `ends_if_none`, none does; None where nothing ends it."""

    task: Task
    ends: tuple[GroundCondition, ...] | None
    ends_if_none: bool


def opened(problem: str, domain: str | None) -> Opened:
    """A problem under `domain` or else the one that it names, which is sought beside it before it is sought
    among the shipped ones.

    Raises `Refused` for files with mistakes, and ValueError where an episode would be over before it begins.
    """
    path = find(problem, "problems")
    source = read_source(path)
    if domain is None:
        rules = find_beside(path, domain_named(source).text, "domains")
    else:
        rules = find(domain, "domains")
    model = load_domain(read_source(rules))
    facts = load_problem(source, model)
    task = ground(model, facts)
    ends = task.goal if facts.goal else task.counted
    if not (task.actions and task.variables):
        raise ValueError(f"no action can change anything in `{facts.name}`: there is nothing to learn")
    if ends is not None and bool(held(ends, task.initial)) is bool(facts.goal):
        raise ValueError(f"nothing is left to do in `{facts.name}` from the beginning")
    if ends is not None and () in ends:  # something is counted that no action can change
        ends = None
    return Opened(task, ends, not facts.goal)


def fact_name(variable: StateVariable) -> str:
    """How a fact is written in a problem: `dirt(a1)`."""
    return f"{variable.symbol}({', '.join(variable.objects)})"


class Batch:
    """States of one task, each in an episode of its own.

    `states` (N, V): value indices; `steps` (N,): actions since the episode began; `rewards`, `terminated`,
    `truncated`, `succeeded` (N,) and `masks` (N, A): what the last step came to, and which actions a rule
    covers now. All are overwritten by the next step.

    An episode has succeeded where the goal holds, or without one nothing is left of the count that the reward
    wants decreased. It is over then, or where no rule covers any action any more; it is cut off after `most`
    actions. What the state would be paid for the actions that are left then is paid at once, so that the
    rewards of an episode add up to the plain return of `cleancli simulate`.
    """

    def __init__(self, problem: Opened, number: int, most: int) -> None:
        task = problem.task
        self._process, self._most = lower_process(task), most
        self._initial: Ints = np.array(task.initial, np.int32)
        places = {each.condition: place for place, each in enumerate(asked(task), start=len(task.rules))}
        self._ends: Ints = np.array([places[each] for each in problem.ends or ()], np.int32)
        self._is_endless, self._ends_if_none = problem.ends is None, problem.ends_if_none
        self.states: Ints = np.tile(self._initial, (number, 1))
        self.steps = np.zeros(number, np.int64)
        self.rewards: Floats = np.zeros(number)
        self.terminated: Bools = np.zeros(number, np.bool_)
        self.truncated: Bools = np.zeros(number, np.bool_)
        self.succeeded: Bools = np.zeros(number, np.bool_)
        self.masks: Masks = np.zeros((number, len(task.actions)), np.int8)
        self._streams = np.zeros(number, np.uint64)
        self._standing: Floats = np.zeros(number)
        self._first_masks: Masks = np.zeros((1, len(task.actions)), np.int8)
        covered_each(self._process, self.states[:1], self._first_masks)

    def seed(self, seeds: Mapping[int, int]) -> None:
        """Draw what comes of the actions of these episodes from these seeds on: the same draws for the same
        seed, whatever the others do."""
        for place, seed in seeds.items():
            begin(self._streams[place : place + 1], np.array([seed % 2**64], np.uint64))

    def restart(self, which: Bools) -> None:
        """Begin these episodes anew, (N,), which have not succeeded; the draws go on. What the last step came
        to stays otherwise."""
        self.states[which], self.steps[which], self.masks[which] = self._initial, 0, self._first_masks
        self.succeeded[which] = False

    def step(self, actions: Ints, anew: Bools) -> None:
        """Carry out an action of each episode, (N,), each a number of the task's actions; one that no rule
        covers changes nothing. Where `anew` is true the episode begins anew instead, and nothing is paid."""
        acting = (self._streams, self.rewards, self._standing)
        step_each(self._process, self.states, actions, anew, self._initial, *acting)
        self.steps += 1
        self.steps[anew] = 0
        covered_each(self._process, self.states, self.masks)
        any_holds_each(self._process, self.states, self._ends, self.succeeded)
        if self._is_endless:
            self.succeeded[:] = False
        elif self._ends_if_none:
            np.logical_not(self.succeeded, out=self.succeeded)
        self.succeeded &= ~anew
        np.logical_or(self.succeeded, ~self.masks.any(axis=1) & ~anew, out=self.terminated)
        np.logical_and(~self.terminated, self.steps >= self._most, out=self.truncated)
        self.rewards += self.terminated * self._standing * (self._most - self.steps)
