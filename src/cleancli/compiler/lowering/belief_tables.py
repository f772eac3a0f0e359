"""Lowering for beliefs: a task becomes the flat arrays with which a belief is updated and valued.

Guaranteed by `ground`: everything is sorted, and the rules of one action stand together and exclude each
other (unless the task was grounded as libPRADA does, which `Tables.independent` is for). Lists of lists are
stored as ragged.py says.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cleancli.array_types import Bools, Floats, Indices, Ints, Longs
from cleancli.compiler.collector import paused_collector
from cleancli.compiler.lowering.belief_numbers import Conditions, Numbers
from cleancli.compiler.lowering.belief_updates import losses, shifts
from cleancli.compiler.lowering.rule_columns import RuleColumns, Touched, rule_columns
from cleancli.compiler.ragged import floats, spans
from cleancli.compiler.semantics import payment
from cleancli.compiler.task import Task, advances, asked


class Tables(NamedTuple):
    """Arrays of a task with V variables, A actions, R rules and C conditions that the reward or the goal
    asks.

    A belief is N numbers: S slots, one per value of each variable, then sums of slots, one per literal that
    allows several values, then the number 1. So a literal's probability is one of these numbers, and a
    condition's is the product of some. Slots and sums of one action or rule ascend. Rules that change nothing
    and cost nothing are left out, unless they are taken as independent or waiting is a choice. (A named tuple
    and no dataclass, because compiled code takes it as it is.)

    An update by a rule with probability p adds p · `shift` to slots, and takes p · `loss` · P(slot | given)
    from others.
    """

    slot_start: Indices  # (V + 1,) slots of each variable
    sum_start: Indices  # (N - S,)
    sum_slot: Indices  # (n,) slots that each sum adds
    guard_start: Indices  # (A + 1,)
    guard: Indices  # (n,) numbers that all conditions of each action's rules multiply
    condition_start: Indices  # (R + C + 1,)
    condition: Indices  # (n,) numbers that each condition multiplies (a rule's: beside the guard)
    rule_start: Indices  # (A + 1,) rules of each action; rules are sorted by action
    useful: Bools  # (R,) whether an outcome of the rule changes something, or waiting is a choice
    rule_cost: Floats  # (R,) what the reward of a step loses on average by which outcome of the rule happens
    shift_start: Indices  # (R + 1,)
    shift_slot: Indices  # (n,)
    shift: Floats  # (n,)
    loss_start: Indices  # (R + 1,)
    loss_slot: Indices  # (n,)
    loss_given: Indices  # (n,) the number of the literal that the rule asks of the slot's variable
    loss: Floats  # (n,)
    touched_slot_start: Indices  # (A + 1,)
    touched_slot: Indices  # (n,) slots of variables that each action can set
    touched_sum_start: Indices  # (A + 1,)
    touched_sum: Indices  # (n,) sums (from 0) of those slots
    touched_reward_start: Indices  # (A + 1,)
    touched_reward: Indices  # (n,) reward conditions (from 0) that ask for those variables
    cost: Floats  # (A,) what the reward of a step loses by each action
    payment: Floats  # (A,) what the reward of a step by each action is multiplied by
    discount: Floats  # (A,) what all that comes after each action is multiplied by
    most: Floats  # (A,) what an action is paid at most for conditions that end, less its costs
    decrease: Floats  # (C,) what each reward condition pays when it ends
    state: Floats  # (C,) what each reward condition pays after a step in which it holds
    advance: Floats  # (C,) how much of a step's progress the end of each condition is
    constant: Floats  # (1,) what each step pays in any state
    independent: Bools  # (1,) whether the rules of an action are taken as independent, as libPRADA does


@paused_collector()
def lower(task: Task, *, independent: bool = False) -> Tables:
    """The arrays of a task, the same for each initial state; equal tasks give equal arrays.

    `independent`: for libPRADA's update, which takes whether rules of one action apply, and the values of
    variables, as independent of each other. Then rules may overlap.
    """
    everything = task.waiting or independent
    columns = rule_columns([rule for rule in task.rules if everything or rule.changes or rule.pays])
    wanted, actions = asked(task), len(task.actions)
    literals = [literal for each in wanted for literal in each.condition]
    numbers = Numbers(task.variables, [*columns.literals, *literals])
    conditions = Conditions(columns, numbers, actions, independent)
    wanted_start = np.cumsum([len(each.condition) for each in wanted], dtype=np.int64)
    happening = columns.possible()
    shift_start, shift_slot, shift = shifts(happening, conditions, numbers)
    loss_start, loss_slot, loss_given, loss = losses(happening, conditions, numbers)
    touched = Touched(happening, task)
    touched_slot_start, touched_slot = touched.ranges(numbers.first)
    of_variable = np.searchsorted(numbers.sum_variable, np.arange(len(task.variables) + 1))
    touched_sum_start, touched_sum = touched.ranges(of_variable)
    touched_reward_start, touched_reward = touched.asking(wanted)
    return Tables(
        slot_start=_indices(numbers.first),
        sum_start=_indices(numbers.sum_start),
        sum_slot=_indices(numbers.sum_slot),
        guard_start=_indices(conditions.guard_start),
        guard=_indices(conditions.guard),
        condition_start=_indices(np.concatenate([conditions.start, conditions.start[-1] + wanted_start])),
        condition=_indices(np.concatenate([conditions.entries, numbers.of(literals)])),
        rule_start=_indices(np.searchsorted(columns.action, np.arange(actions + 1))),
        useful=columns.changes | (task.waiting and not independent),
        rule_cost=columns.cost,
        shift_start=_indices(shift_start),
        shift_slot=_indices(shift_slot),
        shift=shift,
        loss_start=_indices(loss_start),
        loss_slot=_indices(loss_slot),
        loss_given=_indices(loss_given),
        loss=loss,
        touched_slot_start=_indices(touched_slot_start),
        touched_slot=_indices(touched_slot),
        touched_sum_start=_indices(touched_sum_start),
        touched_sum=_indices(touched_sum),
        touched_reward_start=_indices(touched_reward_start),
        touched_reward=_indices(touched_reward),
        cost=floats(action.cost for action in task.actions),
        payment=floats(payment(task, action) for action in range(actions)),
        discount=floats(task.discounts),
        most=_most(task, happening, numbers),
        decrease=floats(each.decrease for each in wanted),
        state=floats(each.state for each in wanted),
        advance=floats(advances(task)),
        constant=floats([task.constant_reward]),
        independent=np.array([independent]),
    )


def _indices(values: Longs | Ints) -> Indices:
    return values.astype(np.uint32)


def _most(task: Task, columns: RuleColumns, numbers: Numbers) -> Floats:
    """Per action what it is paid at most for the conditions that may end or begin, less what it costs.

    A rule as likely as p changes a literal's probability by at most p times that of the outcomes that change
    it, and a product of probabilities by at most the sum of what its factors change.
    """
    pays: list[list[tuple[int, float]]] = [[] for _ in range(numbers.slots)]
    for index, reward in enumerate(task.rewards):
        for variable, allowed in reward.condition:
            for value in range(len(task.variables[variable].values)):
                if (reward.decrease < 0) == (value in allowed):
                    pays[numbers.first[variable] + value].append((index, abs(float(reward.decrease))))
    payers = np.array([payer for each in pays for payer in each], dtype=np.float64).reshape(-1, 2)
    length: Longs = np.array([len(each) for each in pays], dtype=np.int64)
    slot = numbers.first[columns.effect_variable] + columns.effect_value
    effect, payer = spans((np.cumsum(length) - length)[slot], length[slot])
    rule = columns.effect_rule[effect]
    order = np.lexsort((effect, payers[payer, 0], columns.effect_variable[effect], rule))
    paid = (columns.effect_probability[effect] * payers[payer, 1])[order]
    by_rule = np.bincount(rule[order], paid, minlength=len(columns.action)) - columns.cost
    best = np.zeros(len(task.actions))
    np.maximum.at(best, columns.action, by_rule)
    return best - floats(action.cost for action in task.actions)
